// Decodes tiles beside the page: {id, bytes, name} in, {id, tile} or {id, problem} out.
import { buffersOf, readTile } from './tile.js';

interface Task {
  id: number;
  bytes: Uint8Array;
  name: string;
}

addEventListener('message', (event: MessageEvent<Task>) => {
  const { id, bytes, name } = event.data;
  const began = performance.now();
  readTile(bytes, name).then(
    (tile) => {
      postMessage({ id, tile, milliseconds: performance.now() - began }, { transfer: buffersOf(tile) });
    },
    (problem: unknown) => {
      postMessage({ id, problem: problem instanceof Error ? problem.message : String(problem) });
    },
  );
});
