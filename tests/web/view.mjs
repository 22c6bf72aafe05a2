// Shows hierarchies in the viewers of others, in headless Chromium, from a plain static server.
//
//   node view.mjs PICTURES HIERARCHY=MESH...
//
// MESH: the PLY file that the hierarchy was made from. Pictures go to the directory PICTURES.
// Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { call, inChromium, readHierarchy, SIZE, withPage } from './browser.mjs';

// Pixels that an error of a tile may have; and what the pictures may then differ by: of the outline,
// pixels in parts of what is covered; of depth, in parts of the model's radius, the 99th percentile.
const COARSE = { errorTarget: 4, outline: 0.04, depth: 0.05 };
const FINE = { errorTarget: 1, outline: 0.01, depth: 0.01 };
const EXACT = { errorTarget: 1e-6, outline: 0.002, depth: 1e-4 };

const THREE_VIEWS = [
  { name: 'whole', pose: { direction: [1, -2, 1], distance: 3 }, limits: COARSE },
  { name: 'mixed', pose: { direction: [2, 1, 0.4], distance: 1.6 }, limits: FINE },
  { name: 'close', pose: { direction: [1, -2, 1], distance: 0.1, close: true }, limits: EXACT, partitions: true },
];
const CESIUM_VIEWS = [
  { name: 'whole', pose: { direction: [1, -2, 1], distance: 3 }, limits: COARSE },
  { name: 'close', pose: { direction: [1, -2, 1], distance: 1.2 }, limits: EXACT, partitions: true },
];

/// Levels of tiles by their paths.
function levelsOf(visible) {
  return visible.map((file) => Number(/tiles\/(\d+)\//.exec(file)[1]));
}

function judge(report, what, view, state, difference, lastLevel) {
  const levels = levelsOf(state.visible);
  const { limits } = view;
  const depth = difference.depth?.most ?? 0;
  const good =
    state.failures.length === 0 &&
    levels.length > 0 &&
    difference.covered > 0.02 * SIZE * SIZE &&
    difference.holes === 0 &&
    difference.outline <= limits.outline &&
    depth <= limits.depth &&
    (!view.partitions || Math.max(...levels) === lastLevel);
  report.line(
    what,
    good,
    `${levels.length} tiles of levels ${Math.min(...levels)} to ${Math.max(...levels)} of ${lastLevel}, ` +
      `${difference.holes} holes, outline ${(100 * difference.outline).toFixed(2)} % (limit ${100 * limits.outline}), ` +
      `depth ${depth.toExponential(1)} (limit ${limits.depth})${state.failures.map((f) => `; ${f}`).join('')}`,
  );
}

async function showInThree(page, hierarchy, pictures, report) {
  const mesh = `/mesh/${path.basename(hierarchy.mesh)}`;
  await call(page, 'load', { tileset: '/hierarchy/tileset.json', mesh, up: hierarchy.up });
  for (const view of THREE_VIEWS) {
    const pixels = view.limits.errorTarget;
    await call(page, 'look', view.pose);
    const state = await call(page, 'settle', pixels);
    const difference = await call(page, 'compare', pixels);
    judge(report, `${hierarchy.name} three ${view.name}`, view, state, difference, hierarchy.lastLevel);
    const name = path.join(pictures, `${hierarchy.name}-three-${view.name}`);
    await call(page, 'settle', pixels);
    await page.screenshot({ path: `${name}.png` });
    await call(page, 'showOriginal');
    await page.screenshot({ path: `${name}-original.png` });
  }
}

async function showInCesium(page, hierarchy, pictures, report) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json' });
  for (const view of CESIUM_VIEWS) {
    await call(page, 'look', view.pose);
    const state = await call(page, 'settle', view.limits.errorTarget);
    await call(page, 'keepOutline');
    await page.screenshot({ path: path.join(pictures, `${hierarchy.name}-cesium-${view.name}.png`) });
    await call(page, 'settle', EXACT.errorTarget);
    await call(page, 'keepOutline');
    const difference = await call(page, 'compare', view.limits.errorTarget);
    judge(report, `${hierarchy.name} cesium ${view.name}`, view, state, difference, hierarchy.lastLevel);
  }
}

async function showAll(browser, report, pictures, pairs) {
  for (const [directory, mesh] of pairs) {
    const hierarchy = { ...readHierarchy(directory), mesh: path.resolve(mesh) };
    const directories = { '/hierarchy': hierarchy.directory, '/mesh': path.dirname(hierarchy.mesh) };
    for (const [viewer, show] of [['three', showInThree], ['cesium', showInCesium]]) {
      await withPage(browser, report, { viewer, name: hierarchy.name, directories }, (page) =>
        show(page, hierarchy, pictures, report));
    }
  }
}

const [pictures, ...pairs] = process.argv.slice(2).map((argument, i) => (i > 0 ? argument.split('=') : argument));
if (pairs.length === 0 || pairs.some(({ length }) => length !== 2)) {
  console.log('usage: node view.mjs PICTURES HIERARCHY=MESH...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => showAll(browser, report, pictures, pairs)));
