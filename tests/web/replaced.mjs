// A model that is replaced while the page of `meshhier serve` refines it, in headless Chromium: no picture has two builds, the page says
// that the model was replaced, and loads it anew with the camera where it was. The same of the element, and of a host that says nothing.
//
//   node replaced.mjs MESHHIER PICTURES
//
// Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { decodePicture, inChromium, until, withoutRestDetail } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

const WINDOW = { viewport: { width: 700, height: 500 }, reducedMotion: 'reduce' };
const SIDE = 150; // cells of the square
const FIRST_TILES = 45; // that come before the other build: of the page some of the finest; of the element, which is smaller, fewer do
const FIRST_OF_ELEMENT = 5;
const FEW = 40; // pixels: of a mark or an icon

/// A rough square of one colour, as PLY: fine tiles show.
function square(side, [red, green, blue]) {
  const numbers = Array.from({ length: (side + 1) ** 2 }, (_, i) => [(i % (side + 1)) / side, Math.floor(i / (side + 1)) / side]);
  const vertices = numbers.map(([x, z], i) => `${x} ${0.05 * Math.sin(9 * x) * Math.sin(7 * z) + ((i * 7919) % 13) / 600} ${z} ${red} ${green} ${blue}`);
  const faces = numbers.flatMap(([x, z], i) => (x === 1 || z === 1 ? [] : [`3 ${i} ${i + side + 1} ${i + 1}`, `3 ${i + 1} ${i + side + 1} ${i + side + 2}`]));
  const header = ['ply', 'format ascii 1.0', `element vertex ${vertices.length}`, ...['x', 'y', 'z'].map((axis) => `property float ${axis}`),
    ...['red', 'green', 'blue'].map((name) => `property uchar ${name}`), `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header'];
  return [...header, ...vertices, ...faces, ''].join('\n');
}

const MESHES = { red: square(SIDE, [220, 20, 20]), blue: square(SIDE, [20, 20, 220]), other: square(SIDE / 3, [20, 20, 220]) };

class Workshop {
  constructor(meshhier, work) {
    Object.assign(this, { meshhier, work, models: path.join(work, 'models') });
    mkdirSync(this.models);
    for (const [name, text] of Object.entries(MESHES)) writeFileSync(path.join(work, `${name}.ply`), text);
  }

  /// In the place of the model that is there.
  put(mesh, compression) {
    const output = path.join(this.models, 'square.hier');
    execFileSync(this.meshhier, ['build', path.join(this.work, `${mesh}.ply`), '-o', output, '--force', '--progress', 'none',
      '--set', 'partition.vertices=300', '--set', `storage.compression=${compression}`], { stdio: ['ignore', 'ignore', 'pipe'] });
  }
}

/// How many pixels are more red than blue, and the other way round.
async function coloursOf(decoder, page, region) {
  const pixels = await decodePicture(decoder, await region.screenshot());
  const counts = { red: 0, blue: 0 };
  for (let i = 0; i < pixels.length; i += 4) {
    if (pixels[i] > pixels[i + 2] + 60) ++counts.red;
    if (pixels[i + 2] > pixels[i] + 60) ++counts.blue;
  }
  return counts;
}

/// Holds back tiles behind the first ones, until `goOn` is called.
async function holdTiles(page, first) {
  let [goOn, asked] = [null, 0];
  const held = new Promise((resolve) => { goOn = resolve; });
  await page.route(/\/tiles\/(?!00\/)/, async (route) => {
    if (++asked > first) await held;
    await route.continue().catch(() => undefined);
  });
  return { goOn, isHolding: () => asked > first };
}

async function openSquare(browser, url) {
  const page = await browser.newPage(WINDOW);
  await page.addInitScript(withoutRestDetail);
  const tiles = await holdTiles(page, FIRST_TILES);
  await page.goto(`${url}#models/square.hier`);
  await until(page, tiles.isHolding);
  return { page, tiles };
}

async function checkPage(browser, report, { shop, url, pictures, decoder }, { what, next, compression }) {
  shop.put('red', compression);
  const { page, tiles } = await openSquare(browser, url);
  await page.waitForFunction(() => window.meshhier.camera() !== null && window.meshhier.view.manifest !== null);
  await page.evaluate(() => {
    const { position: [x, y, z], target } = window.meshhier.camera();
    window.meshhier.setCamera({ position: target.map((at, axis) => at + ([x, y, z][axis] - at) * 0.6), target });
  });
  const camera = await page.evaluate(() => window.meshhier.camera());
  shop.put(next, compression);
  tiles.goOn();
  const problem = page.getByRole('alert').locator('.problem', { hasText: 'was replaced' });
  await problem.waitFor();
  await page.waitForFunction(() => window.meshhier.settled());
  const surface = page.locator('.surface canvas');
  const mixed = await coloursOf(decoder, page, surface);
  await page.screenshot({ path: path.join(pictures, `replaced-${what}-told.png`) });
  report.line(`${what} told`, mixed.red > 10_000 && mixed.blue < FEW, `${mixed.red} red pixels, ${mixed.blue} blue: ${(await problem.innerText()).replace(/\s+/g, ' ')}`);
  await problem.getByRole('button', { name: 'Load it anew' }).click();
  await page.waitForFunction(() => window.meshhier.settled() && window.meshhier.view.manifest.source.fileName !== 'red.ply');
  await page.waitForFunction(() => window.meshhier.settled());
  const anew = await coloursOf(decoder, page, surface);
  const [after, stats, left] = [await page.evaluate(() => window.meshhier.camera()), await page.evaluate(() => window.meshhier.stats()), await problem.count()];
  await page.screenshot({ path: path.join(pictures, `replaced-${what}-anew.png`) });
  report.line(`${what} anew`, anew.blue > 10_000 && anew.red < FEW && left === 0 && stats.failed === 0 && stats.tiles > 1, `${anew.blue} blue pixels, ${anew.red} red, ${stats.tiles} tiles, ${stats.failed} failed`);
  report.line(`${what} camera`, JSON.stringify(after) === JSON.stringify(camera), JSON.stringify(after));
  await page.close();
}

/// An element in a page of somebody else.
async function checkElement(browser, report, { shop, url, decoder, element }) {
  shop.put('red', 'none');
  const page = await browser.newPage(WINDOW);
  const body = `<!doctype html><link rel="icon" href="data:,"><script type="module" src="${element}"></script><meshhier-viewer src="models/square.hier" style="height: 450px"></meshhier-viewer>`;
  await page.route('**/host.html', (route) => route.fulfill({ contentType: 'text/html', body }));
  const tiles = await holdTiles(page, FIRST_OF_ELEMENT);
  await page.goto(`${url}host.html`);
  await until(page, tiles.isHolding);
  const shown = page.locator('meshhier-viewer');
  await shown.evaluate((one) => { one.addEventListener('replaced', () => { window.isReplaced = true; }); });
  shop.put('blue', 'none');
  tiles.goOn();
  const button = shown.getByRole('button', { name: 'Load it anew' });
  await button.waitFor();
  const before = await coloursOf(decoder, page, shown);
  await button.click();
  await until(page, async () => (await coloursOf(decoder, page, shown)).red < FEW);
  const after = await coloursOf(decoder, page, shown);
  const isTold = await page.evaluate(() => window.isReplaced);
  report.line('element', isTold && before.red > 10_000 && before.blue < FEW && after.blue > 10_000 && !(await button.isVisible()), `${before.red} red pixels and ${before.blue} blue, then ${after.red} and ${after.blue}`);
  await page.close();
}

/// Tiles of which the host says nothing: told, and there by themselves when it is back.
async function checkSilence(browser, report, { shop, url }) {
  shop.put('red', 'none');
  const page = await browser.newPage(WINDOW);
  await page.addInitScript(withoutRestDetail);
  let isSilent = true;
  await page.route(/\/tiles\/(?!00\/)/, async (route) => { if (!isSilent) await route.continue(); });
  const began = Date.now();
  await page.goto(`${url}#models/square.hier`);
  const problem = page.getByRole('alert').locator('.problem', { hasText: 'missing' });
  await problem.waitFor();
  const told = Date.now() - began;
  const more = await problem.locator('.problem-more').textContent();
  isSilent = false;
  report.line('silent host', more.includes('has sent nothing for 20 seconds'), `after ${(told / 1000).toFixed(1)} s: ${more}`);
  await page.waitForFunction(() => window.meshhier.settled() && window.meshhier.stats().tiles > 1);
  report.line('silent host is back', await until(page, async () => (await problem.count()) === 0), `${((Date.now() - began) / 1000).toFixed(1)} s: all is there, nobody did anything`);
  await page.close();
}

async function check(browser, report, { meshhier, pictures, work }) {
  const shop = new Workshop(meshhier, work);
  shop.put('red', 'none');
  const server = startServer(meshhier, shop.models);
  try {
    const url = await server.url;
    const around = { shop, url, pictures, decoder: await browser.newPage() };
    await checkPage(browser, report, around, { what: 'recoloured', next: 'blue', compression: 'none' });
    await checkPage(browser, report, around, { what: 'recoloured-packed', next: 'blue', compression: 'meshopt_zlib' });
    await checkPage(browser, report, around, { what: 'other-mesh', next: 'other', compression: 'none' });
    const element = await elementOf(url);
    if (element !== null) await checkElement(browser, report, { ...around, element });
    await checkSilence(browser, report, around);
  } finally {
    await server.stop();
  }
}

/// The script of the element, beside the page.
async function elementOf(url) {
  const address = new URL('meshhier-viewer.js', url).href;
  return (await fetch(address)).ok ? address : null;
}

const [meshhier, pictures] = process.argv.slice(2);
if (pictures === undefined) {
  console.log('usage: node replaced.mjs MESHHIER PICTURES');
  process.exit(2);
}
const work = mkdtempSync(path.join(tmpdir(), 'meshhier-replaced-'));
try {
  process.exitCode = await inChromium(pictures, (browser, report) => check(browser, report, { meshhier, pictures, work }));
} finally {
  rmSync(work, { recursive: true });
}
