// SPDX-License-Identifier: MIT
// Opens tiles beside the page: {id, bytes, wanted, transcoder} in, {id, opened} out; {id, what} where the file is wrong, {id, defect} where anything else is.
import { setTranscoderUrl } from './basis.js';
import { HierarchyProblem } from './problem.js';
import { openTile, type TileWanted } from './stored_tile.js';
import { partsOf } from './tile.js';

interface Task {
  id: number;
  bytes: Uint8Array<ArrayBuffer>;
  wanted: TileWanted;
  transcoder?: string;
}

addEventListener('message', (event: MessageEvent<Task>) => {
  const { id, bytes, wanted, transcoder } = event.data;
  setTranscoderUrl(transcoder);
  const began = performance.now();
  openTile(bytes, wanted).then(
    (opened) => {
      postMessage({ id, opened, milliseconds: performance.now() - began }, { transfer: partsOf(opened.tile) });
    },
    (problem: unknown) => {
      postMessage(problem instanceof HierarchyProblem ? { id, what: problem.what } : { id, defect: String(problem) });
    },
  );
});
