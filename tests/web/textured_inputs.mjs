// Draws hierarchies beside the textured files they were made from, which three.js reads with its own loaders: both without light, in
// headless Chromium.
//
//   node textured_inputs.mjs PICTURES HIERARCHY=INPUT[=DECIBELS]...
//
// INPUT: OBJ or glTF; its folder has its pictures. DECIBELS: the least at full resolution, if not 32. Pictures go
// to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { call, inChromium, readHierarchy, SIZE, withPage } from './browser.mjs';

const DIRECTIONS = [['front', [0.3, -1, 0.25]], ['back', [-0.5, 1, 0.6]]];
/// Pixels of error that tiles may have, and how many decibels fewer than the partitions they may then have. Partitions differ from
/// the input by what JPEG loses and by how a picture cut anew is filtered.
const LEVELS = [
  { name: 'exact', errorTarget: 1e-6, fewer: 0, outline: 0.002 },
  { name: 'coarse', errorTarget: 1, fewer: 6, outline: 0.02 },
];
const LEAST = 32;

async function show(page, { name, up, input, decibels }, pictures, report) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json', mesh: `/input/${encodeURIComponent(path.basename(input))}`, up });
  for (const [side, direction] of DIRECTIONS) {
    await call(page, 'look', { direction, distance: 2.8 });
    for (const { name: level, errorTarget, fewer, outline } of LEVELS) {
      const least = decibels - fewer;
      const { visible, failures } = await call(page, 'settle', errorTarget);
      const found = await call(page, 'comparePictures');
      report.line(
        `${name} ${side} ${level}`,
        failures.length === 0 && visible.length > 0 && found.covered > 0.02 * SIZE * SIZE && found.decibels >= least && found.outline <= outline,
        `${visible.length} tiles, ${found.decibels.toFixed(1)} dB (least ${least}), outline ${(100 * found.outline).toFixed(2)} % (limit ${100 * outline})${failures.map((f) => `; ${f}`).join('')}`,
      );
      const file = path.join(pictures, `${name}-${side}-${level}`);
      await call(page, 'settle', errorTarget);
      await page.screenshot({ path: `${file}.png` });
      await call(page, 'showOriginal');
      await page.screenshot({ path: `${file}-input.png` });
    }
  }
}

async function showAll(browser, report, pictures, given) {
  for (const [directory, input, decibels = LEAST] of given) {
    const hierarchy = { ...readHierarchy(directory), input: path.resolve(input), decibels: Number(decibels) };
    const directories = { '/hierarchy': path.resolve(directory), '/input': path.dirname(hierarchy.input) };
    await withPage(browser, report, { viewer: 'three', name: hierarchy.name, directories }, (page) => show(page, hierarchy, pictures, report));
  }
}

const [pictures, ...given] = process.argv.slice(2).map((argument, i) => (i > 0 ? argument.split('=') : argument));
if (given.length === 0 || given.some(({ length }) => length < 2)) {
  console.log('usage: node textured_inputs.mjs PICTURES HIERARCHY=INPUT[=DECIBELS]...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => showAll(browser, report, pictures, given)));
