// SPDX-License-Identifier: MIT
// Pictures wait until the view is as fine as they ask for.
import type { HierarchyView } from '../../src/index.js';

const PATIENCE = 120_000; // milliseconds until a picture is taken of what is there
const POLL = 100; // milliseconds

export async function untilSettled(view: HierarchyView, signal: AbortSignal): Promise<void> {
  const end = performance.now() + PATIENCE;
  do await new Promise((resolve) => setTimeout(resolve, POLL));
  while (!view.stats().settled && performance.now() < end && !signal.aborted);
}
