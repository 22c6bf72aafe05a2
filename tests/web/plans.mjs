// Checks drawings of viewer/'s page in headless Chromium: parallel projection, a plan at a scale as a picture, and lines as SVG, DXF and GeoJSON.
//
//   node plans.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The hierarchy must be closed and say its unit. Pictures go to the
// directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { copyFileSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { inChromium, readHierarchy, until } from './browser.mjs';
import { withSite } from './site.mjs';

const WIDE = { viewport: { width: 800, height: 600 } };
const NARROW = { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const LEAST_TARGET = 40; // CSS pixels
const CAP = [0xd9, 0x82, 0x5b]; // src/tools/caps.ts
const MARGIN = 12; // millimetres, src/tools/paper.ts

class Visitor {
  constructor(browser, origin, report, { name, pictures, source }) {
    Object.assign(this, { browser, origin, report, name, pictures, source });
  }

  async open(link = '', options = WIDE) {
    const page = await this.browser.newPage({ reducedMotion: 'reduce', ...options });
    page.complaints = [];
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
    });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    await page.goto(`${this.origin}/index.html#models/${this.name}.hier${link}`);
    await settle(page);
    return page;
  }

  async close(page, what) {
    this.check(`${what} console`, page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
    await page.close();
  }

  check(what, good, text) {
    this.report.line(`plans ${what}`, good, text);
  }
}

function settle(page) {
  return page.waitForFunction(() => window.meshhier?.settled());
}

/// r, g, b, a of a picture.
function pixelsOf(page, bytes) {
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return { width: bitmap.width, height: bitmap.height, pixels: Array.from(pixels) };
  }, bytes.toString('base64'));
}

/// Of all pixels within the frame that `holds` takes: their ends.
function boundsOf({ width, height, pixels }, holds) {
  const bounds = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity };
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const at = 4 * (y * width + x);
      if (!holds([pixels[at], pixels[at + 1], pixels[at + 2]], x, y)) continue;
      bounds.left = Math.min(bounds.left, x);
      bounds.right = Math.max(bounds.right, x + 1);
      bounds.top = Math.min(bounds.top, y);
      bounds.bottom = Math.max(bounds.bottom, y + 1);
    }
  return bounds;
}

async function checkParallel(visitor) {
  const page = await visitor.open();
  const before = await page.locator('.surface').screenshot();
  await page.keyboard.press('q');
  await settle(page);
  const parallel = await page.locator('.surface').screenshot();
  visitor.check('parallel is another picture', !before.equals(parallel), 'Q');
  await until(page, () => page.url().includes('projection=parallel'));
  const again = await visitor.open('&projection=parallel');
  const linked = await again.locator('.surface').screenshot();
  visitor.check('links keep the projection', linked.equals(parallel), page.url().split('&').slice(1).join('&'));
  await visitor.close(again, 'link');
  await page.keyboard.press('q');
  await settle(page);
  visitor.check('back in perspective', before.equals(await page.locator('.surface').screenshot()), 'the same picture');
  await visitor.close(page, 'parallel');
}

async function save(page, button) {
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: button, exact: true }).click()]);
  return { path: await file.path(), name: file.suggestedFilename() };
}

async function fill(page, label, value) {
  await page.getByLabel(label).fill(String(value));
  await page.getByLabel(label).press('Tab');
}

/// Pixels of a millimetre, as the file itself says.
function densityOf(bytes) {
  const at = bytes.indexOf('pHYs');
  return at < 0 ? 0 : bytes.readUInt32BE(at + 4) / 1000;
}

async function checkPicture(visitor, page, scale) {
  const { path: file, name } = await save(page, 'Save the picture');
  copyFileSync(file, path.join(visitor.pictures, `plans-${name}`));
  const bytes = readFileSync(file);
  const perMm = densityOf(bytes);
  visitor.check('dpi in the file', Math.abs(perMm * 25.4 - 150) < 0.05, `${(perMm * 25.4).toFixed(3)} dpi`);
  const picture = await pixelsOf(page, bytes);
  const [left, right] = [MARGIN * perMm + 3, picture.width - MARGIN * perMm - 3];
  const seen = boundsOf(picture, ([r, g, b], x, y) => x > left && x < right && y > left && y < picture.height - 30 * perMm && Math.abs(r - b) > 2);
  const { min, max } = visitor.source.bounds;
  const wanted = [max[0] - min[0], max[2] - min[2]].map((length) => (length * perMm) / scale); // y is up, units are millimetres
  const got = [seen.right - seen.left, seen.bottom - seen.top];
  visitor.check('scale of the picture', got.every((length, axis) => Math.abs(length - wanted[axis]) <= 2), `${got} pixels, wanted ${wanted.map((length) => length.toFixed(2))}`);
}

async function checkLines(visitor, page) {
  await page.getByLabel('Cut', { exact: true }).check();
  await settle(page);
  const cut = await pixelsOf(page, await page.locator('.surface').screenshot());
  const caps = boundsOf(cut, (colour) => CAP.every((value, k) => Math.abs(value - colour[k]) <= 3));
  visitor.check('cut with caps', caps.right > caps.left, JSON.stringify(caps));
  await page.getByLabel('Lines from the original').check();
  const dxf = readFileSync((await save(page, 'Lines as DXF')).path, 'latin1').split('\n').map((line) => line.trim());
  const svg = readFileSync((await save(page, 'Lines as SVG')).path, 'utf8');
  const closed = [...svg.matchAll(/<path data-height="[^"]*" d="M[^"]*Z"/g)].length;
  const lines = dxf.filter((line, i) => line === 'SECTION' && dxf[i - 1] === '8').length;
  const unit = dxf[dxf.indexOf('$INSUNITS') + 2];
  visitor.check('lines of the original', closed > 0 && closed === lines && unit === '4' && dxf.includes('LWPOLYLINE'), `${closed} closed lines, unit ${unit}`);
  await page.getByLabel('Contour lines', { exact: true }).check();
  await settle(page);
  const { features } = JSON.parse(readFileSync((await save(page, 'Contours as GeoJSON')).path, 'utf8'));
  const heights = new Set(features.map(({ properties: { elevation } }) => elevation));
  visitor.check('contours', heights.size > 3 && features.every(({ properties: { closed: is } }) => is), `${features.length} lines, ${heights.size} heights`);
  await page.screenshot({ path: path.join(visitor.pictures, 'plans-tool.png') });
}

async function checkPlan(visitor) {
  const page = await visitor.open();
  await page.keyboard.press('d');
  await page.locator('.tool-card', { hasText: 'Plans and sections' }).waitFor();
  await settle(page);
  const { min, max } = visitor.source.bounds;
  const scale = Number(((max[0] - min[0]) / 100).toPrecision(2)); // 10 cm wide
  await fill(page, 'Scale 1:', scale);
  await page.getByLabel('dpi').selectOption('150');
  await checkPicture(visitor, page, scale);
  await fill(page, 'Scale 1:', scale / 1000);
  const told = await page.locator('.tool-card .tool-note').first().innerText();
  visitor.check('too many pixels are refused', told.includes('too many'), told);
  await fill(page, 'Scale 1:', scale);
  await checkLines(visitor, page);
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'The model is cut open' }).click();
  await settle(page);
  const after = await pixelsOf(page, await page.locator('.surface').screenshot());
  visitor.check('the sign ends the cut', boundsOf(after, (colour) => CAP.every((value, k) => Math.abs(value - colour[k]) <= 3)).right < 0, 'no caps');
  await visitor.close(page, 'plan');
}

async function checkNarrow(visitor) {
  const page = await visitor.open('', NARROW);
  await page.getByRole('button', { name: 'Tools', exact: true }).tap();
  await page.getByRole('button', { name: 'Plans and sections', exact: true }).tap();
  await page.locator('.tool-card').waitFor();
  await page.locator('.tool-grow').tap();
  await settle(page);
  const small = await page.evaluate((least) => [...document.querySelectorAll('.tool-card button, .tool-card label.check, .tool-card select, .tool-card input[type=number]')]
    .filter((one) => one.checkVisibility() && !one.closest('[hidden]'))
    .filter((one) => { const { width, height } = one.getBoundingClientRect(); return width < least || height < least; })
    .map((one) => one.getAttribute('aria-label') ?? one.textContent), LEAST_TARGET);
  const wide = await page.evaluate(() => document.querySelector('.tool-card').scrollWidth - document.querySelector('.tool-card').clientWidth);
  visitor.check('by touch', small.length === 0 && wide <= 0, small.join(', ') || `targets of 40 pixels, ${wide} too wide`);
  await page.screenshot({ path: path.join(visitor.pictures, 'plans-narrow.png') });
  await visitor.close(page, 'narrow');
}

async function serveAndCheck(browser, report, [pictures, page, directory]) {
  const hierarchy = readHierarchy(directory);
  const { source } = JSON.parse(readFileSync(path.join(directory, 'hierarchy.json'), 'utf8'));
  await withSite(page, [hierarchy], async (origin) => {
    const visitor = new Visitor(browser, origin, report, { name: hierarchy.name, pictures, source });
    for (const check of [checkParallel, checkPlan, checkNarrow]) await check(visitor);
  });
}

const [pictures, ...others] = process.argv.slice(2);
if (others.length !== 2) {
  console.log('usage: node plans.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => serveAndCheck(browser, report, [pictures, ...others])));
