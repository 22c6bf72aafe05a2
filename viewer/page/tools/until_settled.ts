// SPDX-License-Identifier: MIT
// Pictures wait until the view is as fine as they ask for.
import type { PageStage } from '../view/page_stage.js';

const PATIENCE = 120_000; // milliseconds until a picture is taken of what is there
const POLL = 100; // milliseconds

export async function untilSettled(stage: PageStage, signal: AbortSignal): Promise<void> {
  const end = performance.now() + PATIENCE;
  do await new Promise((resolve) => setTimeout(resolve, POLL));
  while (!stage.isSettled && performance.now() < end && !signal.aborted);
}
