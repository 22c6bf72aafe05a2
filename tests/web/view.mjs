// Shows hierarchies in the viewers of others, in headless Chromium, from a plain static server.
//
//   node view.mjs PICTURES HIERARCHY=MESH...
//
// MESH: the PLY file that the hierarchy was made from. Pictures go to the directory PICTURES.
// Exit code 0: all is as it should be; 1: something is not; 2: wrong use; 77: the viewers or
// Chromium are not installed.
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { serve } from './server.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find((file) => existsSync(file));
const SIZE = 512;

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

async function loadPlaywright() {
  try {
    return (await import('playwright-core')).chromium;
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    return null;
  }
}

function readHierarchy(argument) {
  const [directory, mesh] = argument.split('=');
  const manifest = JSON.parse(readFileSync(path.join(directory, 'hierarchy.json'), 'utf8'));
  return {
    directory: path.resolve(directory),
    mesh: path.resolve(mesh),
    name: path.basename(directory).replace(/\.[^.]*$/, ''),
    up: manifest.up,
    lastLevel: manifest.levels.length - 1,
  };
}

class Report {
  problems = 0;
  line(what, good, text) {
    if (!good) ++this.problems;
    console.log(`${good ? 'ok' : 'NOT OK'}  ${what}: ${text}`);
  }
}

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

async function openPage(browser, url, errors) {
  const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE } });
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('requestfailed', (request) => errors.push(`${request.url()}: ${request.failure()?.errorText}`));
  await page.goto(url);
  await page.waitForFunction(() => window.view !== undefined, null, { timeout: 120_000 }).catch((error) => {
    throw new Error(`${url} does not start: ${errors.join('; ') || error.message}`);
  });
  return page;
}

async function showInThree(page, hierarchy, pictures, report) {
  await page.evaluate((job) => window.view.load(job), {
    tileset: '/hierarchy/tileset.json',
    mesh: `/mesh/${path.basename(hierarchy.mesh)}`,
    up: hierarchy.up,
  });
  for (const view of THREE_VIEWS) {
    await page.evaluate((pose) => window.view.look(pose), view.pose);
    const state = await page.evaluate((pixels) => window.view.settle(pixels), view.limits.errorTarget);
    const difference = await page.evaluate((pixels) => window.view.compare(pixels), view.limits.errorTarget);
    judge(report, `${hierarchy.name} three ${view.name}`, view, state, difference, hierarchy.lastLevel);
    const name = path.join(pictures, `${hierarchy.name}-three-${view.name}`);
    await page.evaluate((pixels) => window.view.settle(pixels), view.limits.errorTarget);
    await page.screenshot({ path: `${name}.png` });
    await page.evaluate(() => window.view.showOriginal());
    await page.screenshot({ path: `${name}-original.png` });
  }
}

async function showInCesium(page, hierarchy, pictures, report) {
  await page.evaluate((job) => window.view.load(job), { tileset: '/hierarchy/tileset.json' });
  for (const view of CESIUM_VIEWS) {
    await page.evaluate((pose) => window.view.look(pose), view.pose);
    const state = await page.evaluate((pixels) => window.view.settle(pixels), view.limits.errorTarget);
    await page.evaluate(() => window.view.keepOutline());
    await page.screenshot({ path: path.join(pictures, `${hierarchy.name}-cesium-${view.name}.png`) });
    await page.evaluate((pixels) => window.view.settle(pixels), EXACT.errorTarget);
    await page.evaluate(() => window.view.keepOutline());
    const difference = await page.evaluate((pixels) => window.view.compare(pixels), view.limits.errorTarget);
    judge(report, `${hierarchy.name} cesium ${view.name}`, view, state, difference, hierarchy.lastLevel);
  }
}

async function main(pictures, hierarchies) {
  if (pictures === undefined || hierarchies.length === 0 || hierarchies.some((h) => !h.includes('='))) {
    console.log('usage: node view.mjs PICTURES HIERARCHY=MESH...');
    return 2;
  }
  const chromium = await loadPlaywright();
  if (chromium === null || CHROMIUM === undefined) {
    console.log('the viewers or Chromium are not installed: run scripts/install_dependencies web');
    return 77;
  }
  mkdirSync(pictures, { recursive: true });
  const browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  const report = new Report();
  for (const hierarchy of hierarchies.map(readHierarchy)) {
    const server = await serve({
      '/pages': HERE,
      '/modules': path.join(HERE, 'node_modules'),
      '/hierarchy': hierarchy.directory,
      '/mesh': path.dirname(hierarchy.mesh),
    });
    for (const [viewer, show] of [['three', showInThree], ['cesium', showInCesium]]) {
      const errors = [];
      const page = await openPage(browser, `${server.origin}/pages/${viewer}.html`, errors);
      await show(page, hierarchy, pictures, report);
      report.line(`${hierarchy.name} ${viewer} console`, errors.length === 0, errors.join('; ') || 'no errors');
      await page.close();
    }
    server.close();
  }
  await browser.close();
  return report.problems === 0 ? 0 : 1;
}

const [pictures, ...hierarchies] = process.argv.slice(2);
process.exit(await main(pictures, hierarchies));
