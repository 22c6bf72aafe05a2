// SPDX-License-Identifier: MIT
// Files that the page makes.

/// A name that every file system takes.
function fileName(name: string): string {
  return name.replace(/[^\p{L}\p{N}._-]+/gu, '_');
}

export function download(content: Blob, name: string): void {
  const url = URL.createObjectURL(content);
  const link = document.createElement('a');
  link.href = url;
  link.download = fileName(name);
  link.click();
  setTimeout(() => { URL.revokeObjectURL(url); }, 10_000); // once the browser has read it
}
