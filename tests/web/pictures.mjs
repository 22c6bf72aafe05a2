// Makes the pictures of the README in headless Chromium: levels.png and cut.png.
//
//   node pictures.mjs PICTURES LEVELS_HIERARCHY CUT_HIERARCHY
//
// The first hierarchy is shown at four levels, the second as one cut that mixes levels; its tiles should be small. Their tiles must
// not be compressed. Exit code 2: wrong use; else see browser.mjs.
import { existsSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { call, inChromium, readHierarchy, withPage } from './browser.mjs';

const VIEWER = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../viewer');
/// Poses: distances in radii of the model; angles in degrees, threshold in pixels.
const LEVELS = { size: [290, 215], angle: 30, pose: { direction: [0.2, 0.2, 1], distance: 2.65, target: [0, -0.02, 0] } };
const CUT = { size: [800, 470], angle: 58, threshold: 1, pose: { direction: [-0.75, 0.5, 0.8], distance: 0.5, target: [-0.45, 0.3, 0.05] } };
/// How dark the wires of a level are: the finer, the lighter.
const wiresOf = (level) => 0.5 / (1 + 0.4 * level);
const LEAST_MIXED = 3; // levels in the picture of the cut

/// The tiles of a level, and what is written below its picture.
function describe({ directory, lastLevel }, level) {
  const files = readdirSync(path.join(directory, 'tiles', String(level).padStart(2, '0')));
  const tiles = files.map((file) => parseInt(file, 10)).sort((a, b) => a - b);
  const name = level === lastLevel ? `level ${level}, the input` : `level ${level}`;
  return { level, tiles, wires: level < lastLevel ? wiresOf(level) : 0, label: `${name}: ${tiles.length} tile${tiles.length === 1 ? '' : 's'}` };
}

/// The root, the last level, and two between them.
function someLevels(hierarchy) {
  const levels = [0, 2, 4, hierarchy.lastLevel];
  return levels.map((level) => describe(hierarchy, Math.min(level, hierarchy.lastLevel)));
}

async function shoot(page, figure, pictures) {
  const file = path.join(pictures, `${figure}.png`);
  await page.locator(`#${figure}`).screenshot({ path: file });
  return file;
}

function directoriesFor(hierarchy) {
  return {
    '/viewer': path.join(VIEWER, 'dist'),
    '/packages': path.join(VIEWER, 'node_modules'),
    '/hierarchy': hierarchy.directory,
  };
}

async function makePictures(browser, report, pictures, [whole, mixed]) {
  const show = (hierarchy, draw) =>
    withPage(browser, report, { viewer: 'pictures', name: hierarchy.name, directories: directoriesFor(hierarchy) }, async (page) => {
      await page.setViewportSize({ width: 1280, height: 800 });
      await draw(page);
    });
  await show(whole, async (page) => {
    await call(page, 'drawLevels', { url: '/hierarchy', levels: someLevels(whole), ...LEVELS });
    report.line('levels', true, await shoot(page, 'levels', pictures));
  });
  await show(mixed, async (page) => {
    const { counts, levels, triangles } = await call(page, 'drawCut', { url: '/hierarchy', ...CUT });
    report.line('cut', levels.length >= LEAST_MIXED,
      `${await shoot(page, 'cut', pictures)}: ${triangles} triangles; tiles by level ${JSON.stringify(counts)}`);
  });
}

const [pictures, ...directories] = process.argv.slice(2);
if (directories.length !== 2 || !directories.every((directory) => existsSync(path.join(directory, 'hierarchy.json')))) {
  console.log('usage: node pictures.mjs PICTURES LEVELS_HIERARCHY CUT_HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => makePictures(browser, report, pictures, directories.map(readHierarchy))));
