// Whether Babylon.js loads single tiles as they are stored: all counts, the same bounds for one mesh
// however it is stored, and a picture that shows something.
//
//   node single_tiles.mjs PICTURES HIERARCHY...
//
// The hierarchies are of one mesh; one with a lattice of `positions.bits` may differ from the first by
// its steps. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { readGlb } from '../gltf/glb.mjs';
import { call, inChromium, readHierarchy, withPage } from './browser.mjs';

// A lattice of the tests' 14 bits and a viewer's floats may move bounds by this, in parts of their size.
const LATTICE = 1e-3;
const tileOf = (level) => `tiles/${String(level).padStart(2, '0')}/000000.glb`;

/// Returns what the tile's JSON says that is in it.
function countsOf(file) {
  const bytes = readGlb(file);
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  const { accessors, meshes, extensionsUsed } = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  const primitives = meshes.flatMap((mesh) => mesh.primitives);
  const sum = (accessor) => primitives.reduce((total, primitive) => total + accessors[accessor(primitive)].count, 0);
  return {
    vertices: sum(({ attributes }) => attributes.POSITION),
    indices: sum(({ indices }) => indices),
    extensions: extensionsUsed.join(', '),
  };
}

/// The largest difference of two boxes' coordinates, in parts of the first one's size.
function boundsApart(a, b) {
  const size = Math.max(...a[1].map((high, i) => high - a[0][i]));
  return Math.max(...a.flat().map((x, i) => Math.abs(x - b.flat()[i]))) / size;
}

function judge(report, what, stored, shown, apart) {
  report.line(
    what,
    shown.vertices === stored.vertices && shown.indices === stored.indices && apart <= LATTICE && shown.covered > 0.02,
    `${shown.vertices} of ${stored.vertices} vertices, ${shown.indices} of ${stored.indices} indices, ` +
      `bounds differ by ${apart.toExponential(1)}, ${(100 * shown.covered).toFixed(1)} % covered (${stored.extensions})`,
  );
}

async function showAll(browser, report, pictures, hierarchies) {
  const first = new Map();
  for (const { directory, name, lastLevel } of hierarchies.map(readHierarchy)) {
    await withPage(browser, report, { viewer: 'babylon', name, directories: { '/hierarchy': directory } }, async (page) => {
      for (const level of [0, lastLevel]) {
        const stored = countsOf(path.join(directory, tileOf(level)));
        const shown = await call(page, 'load', `/hierarchy/${tileOf(level)}`);
        if (!first.has(level)) first.set(level, shown);
        judge(report, `${name} babylon level ${level}`, stored, shown, boundsApart(first.get(level).bounds, shown.bounds));
        await page.screenshot({ path: path.join(pictures, `${name}-babylon-${level}.png`) });
      }
    });
  }
}

const [pictures, ...hierarchies] = process.argv.slice(2);
if (hierarchies.length === 0) {
  console.log('usage: node single_tiles.mjs PICTURES HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => showAll(browser, report, pictures, hierarchies)));
