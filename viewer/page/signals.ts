// SPDX-License-Identifier: MIT
// Work may be given up for more than one reason.

/// Aborts `ending` as soon as `signal` is, unless `ending` was before. As AbortSignal.any, which browsers have since 2024.
export function follow(ending: AbortController, signal: AbortSignal): void {
  if (signal.aborted) ending.abort(signal.reason);
  else signal.addEventListener('abort', () => { ending.abort(signal.reason); }, { signal: ending.signal });
}
