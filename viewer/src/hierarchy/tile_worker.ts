// Decodes tiles beside the page: {id, bytes, name, expected} in, {id, tile} or {id, problem} out.
import { buffersOf, readTile, type ExpectedCounts } from './tile.js';

interface Task {
  id: number;
  bytes: Uint8Array;
  name: string;
  expected: ExpectedCounts | null;
}

addEventListener('message', (event: MessageEvent<Task>) => {
  const { id, bytes, name, expected } = event.data;
  const began = performance.now();
  readTile(bytes, name, expected).then(
    (tile) => {
      postMessage({ id, tile, milliseconds: performance.now() - began }, { transfer: buffersOf(tile) });
    },
    (problem: unknown) => {
      postMessage({ id, problem: problem instanceof Error ? problem.message : String(problem) });
    },
  );
});
