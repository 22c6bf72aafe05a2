// SPDX-License-Identifier: MIT
// Writes the triangles of a cut, as seams.js draws them: nine little-endian floats each, relative to the origin.
//
//   node examples/cut.mjs HIERARCHY ERROR OUT
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { Tree, nameOf, pathOf, readIndex, readTile, resolveSeam } from './seams.js';

const [folder, largest, out] = process.argv.slice(2);
const read = (name) => Uint8Array.from(readFileSync(path.join(folder, name))).buffer;
const manifest = JSON.parse(readFileSync(path.join(folder, 'hierarchy.json'), 'utf8'));
const [tree, index, cut] = [new Tree(manifest.partitions), readIndex(read('tiles.bin')), new Map()];

function choose(node) {
  const children = tree.children(node);
  if (children.length > 0 && index.get(nameOf(node)).error > Number(largest)) children.forEach(choose);
  else cut.set(nameOf(node), readTile(read(pathOf(node)), node, tree, manifest.storage.positions));
}

choose([0, 0]);
const corners = [...cut.values()].flatMap((tile) => {
  const border = resolveSeam(tile, cut); // moves the ghosts
  return [...tile.interior, ...border].flatMap((vertex) => [...tile.positions.subarray(3 * vertex, 3 * vertex + 3)]);
});
writeFileSync(out, new Uint8Array(Float32Array.from(corners).buffer));
console.log(`${cut.size} tiles, ${corners.length / 9} triangles`);
