// SPDX-License-Identifier: MIT
// Decodes tiles beside the page: {id, bytes, name, expected, transcoder} in, {id, tile} or {id, what} out, `what`: is wrong with the file; {id, defect} of anything else.
import { setTranscoderUrl } from './basis.js';
import { HierarchyProblem } from './problem.js';
import { partsOf, readTile } from './tile.js';
import type { ExpectedCounts } from './tile_counts.js';

interface Task {
  id: number;
  bytes: Uint8Array;
  name: string;
  expected: ExpectedCounts | null;
  transcoder?: string;
}

addEventListener('message', (event: MessageEvent<Task>) => {
  const { id, bytes, name, expected, transcoder } = event.data;
  setTranscoderUrl(transcoder);
  const began = performance.now();
  readTile(bytes, name, expected).then(
    (tile) => {
      postMessage({ id, tile, milliseconds: performance.now() - began }, { transfer: partsOf(tile) });
    },
    (problem: unknown) => {
      postMessage(problem instanceof HierarchyProblem ? { id, what: problem.what } : { id, defect: String(problem) });
    },
  );
});
