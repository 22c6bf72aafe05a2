// SPDX-License-Identifier: MIT
// The clipboard, which pages that are not secure do not have.

/// Resolves with whether the clipboard has the text now.
export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
