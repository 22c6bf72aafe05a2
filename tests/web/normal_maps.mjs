// Whether viewers of others light a root with a normal map as they light the original: the root alone is nearer to the partitions
// with its map than without.
//
//   node normal_maps.mjs PICTURES WITHOUT.hier WITH.hier WHOLE.glb
//
// Both hierarchies and the GLB are of one mesh without pictures. Exit code 2: wrong use; else see browser.mjs.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { call, decodePicture, inChromium, readHierarchy, withPage } from './browser.mjs';

/// At the most this part of the difference that a root without a map has.
const MOST = 0.6;
const POSE = { direction: [1, -2, 1], distance: 2.2 };
const ROOT_ALONE = 8; // of a tileset that has less, CesiumJS shows nothing
const PARTITIONS = 1e-6;

/// Mean absolute difference of two pictures, RGBA, where either shows something, in steps of 255: not
/// what their first pixel does.
function difference(one, other) {
  let sum = 0;
  let count = 0;
  const isGround = (pixels, i) => [0, 1, 2].every((k) => pixels[i + k] === pixels[k]);
  for (let i = 0; i < one.length; i += 4) {
    if (isGround(one, i) && isGround(other, i)) continue;
    for (let k = 0; k < 3; ++k) sum += Math.abs(one[i + k] - other[i + k]) / 3;
    ++count;
  }
  return count === 0 ? Infinity : sum / count;
}

async function pictureOf(page, decoder, file) {
  const picture = await page.screenshot();
  writeFileSync(file, picture);
  return decodePicture(decoder, picture);
}

/// Root and partitions of a tileset.
async function fromTileset(page, decoder, file) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json' });
  await call(page, 'look', POSE);
  const shown = {};
  for (const [name, error] of [['root', ROOT_ALONE], ['original', PARTITIONS]]) {
    const { failures } = await call(page, 'settle', error);
    if (failures.length > 0) throw new Error(failures.join('; '));
    shown[name] = await pictureOf(page, decoder, file(name));
  }
  return shown;
}

/// The root's file, and that of the whole mesh.
async function fromFiles(page, decoder, file, whole) {
  await call(page, 'load', '/hierarchy/tiles/00/000000.glb');
  const root = await pictureOf(page, decoder, file('root'));
  await call(page, 'load', `/mesh/${path.basename(whole)}`);
  return { root, original: await pictureOf(page, decoder, file('original')) };
}

async function judge(browser, report, viewer, { pictures, without, withMaps, whole }) {
  const decoder = await browser.newPage();
  const differences = [];
  for (const [kind, hierarchy] of [['without', without], ['with', withMaps]]) {
    const directories = { '/hierarchy': hierarchy.directory, '/mesh': path.dirname(path.resolve(whole)) };
    await withPage(browser, report, { viewer, name: hierarchy.name, directories }, async (page) => {
      const file = (name) => path.join(pictures, `normal-maps-${viewer}-${kind}-${name}.png`);
      const { root, original } = viewer === 'babylon' ? await fromFiles(page, decoder, file, whole) : await fromTileset(page, decoder, file);
      differences.push(difference(root, original));
    });
  }
  await decoder.close();
  const [bare, mapped] = differences;
  report.line(`normal maps ${viewer}`, mapped < MOST * bare, `the root differs from the original by ${mapped?.toFixed(2)} of 255 with its map, ${bare?.toFixed(2)} without`);
}

const [pictures, without, withMaps, whole] = process.argv.slice(2);
if (whole === undefined) {
  console.log('usage: node normal_maps.mjs PICTURES WITHOUT.hier WITH.hier WHOLE.glb');
  process.exit(2);
}
process.exit(await inChromium(pictures, async (browser, report) => {
  for (const viewer of ['three', 'cesium', 'babylon'])
    await judge(browser, report, viewer, { pictures, without: readHierarchy(without), withMaps: readHierarchy(withMaps), whole });
}));
