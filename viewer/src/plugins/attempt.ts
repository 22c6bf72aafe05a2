// SPDX-License-Identifier: MIT
// Calls code of plug-ins: one that throws takes nothing else with it.

/// Errors of plug-ins are told as those that nobody has caught.
function tellError(error: unknown): void {
  const report = globalThis.reportError as typeof globalThis.reportError | undefined; // not outside browsers
  if (report === undefined) console.error(error);
  else report(error);
}

/// Returns what `work` does; where it throws, tells the error and returns what `failed` does.
export function attempt<T>(work: () => T, failed: () => T): T {
  try {
    return work();
  } catch (error) {
    tellError(error);
    return failed();
  }
}
