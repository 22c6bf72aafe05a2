// The scripts that show hierarchies share this: Chromium, its pages, and the account of the checks.
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { isDeepStrictEqual } from 'node:util';
import { serve } from './server.mjs';

export const SIZE = 512;

/// 1.6 Mbit/s with 150 ms, as Network.emulateNetworkConditions takes it.
export const SLOW_LINE = { offline: false, latency: 150, downloadThroughput: 1.6e6 / 8, uploadThroughput: 0.75e6 / 8 };

const HERE = path.dirname(fileURLToPath(import.meta.url));
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find((file) => existsSync(file));

async function loadPlaywright() {
  try {
    return (await import('playwright-core')).chromium;
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    return null;
  }
}

export class Report {
  problems = 0;
  line(what, good, text) {
    if (!good) ++this.problems;
    console.log(`${good ? 'ok' : 'NOT OK'}  ${what}: ${text}`);
  }
}

const TURNS = 8; // as in scripts/side_by_side.sh
const SHARE = process.env.MESHHIER_TEST_SHARE;

/// Those whose turn it is: an eighth with MESHHIER_TEST_SHARE="k/n", so that any eight shares in a row have all; all without it.
export function inTurn(all) {
  return SHARE ? all.filter((_, i) => i % TURNS === Number.parseInt(SHARE, 10) % TURNS) : all;
}

/// Milliseconds that anything is waited for, on all pages. It ends a check whose outcome is clear; a slow machine needs less.
export const PATIENCE = 240_000;

/// Whether it comes to that.
export async function until(page, holds) {
  for (const began = Date.now(); !(await holds()); ) {
    if (Date.now() - began > PATIENCE) return false;
    await page.waitForTimeout(20);
  }
  return true;
}

/// What `look` tells, as soon as it is twice the same with frames in between.
export async function steady(page, look) {
  let last = await look();
  await until(page, async () => {
    await frames(page);
    const before = last;
    last = await look();
    return isDeepStrictEqual(before, last);
  });
  return last;
}

/// Some frames are drawn.
export function frames(page, count = 3) {
  return page.evaluate((left) => new Promise((done) => {
    const next = () => (--left < 0 ? done() : requestAnimationFrame(next));
    next();
  }), count);
}

export function readHierarchy(directory) {
  const manifest = JSON.parse(readFileSync(path.join(directory, 'hierarchy.json'), 'utf8'));
  return {
    directory: path.resolve(directory),
    name: path.basename(directory).replace(/\.[^.]*$/, ''),
    up: manifest.up,
    vertices: manifest.source.vertices,
    triangles: manifest.source.triangles,
    bytes: manifest.total_bytes,
    isTextured: manifest.source.textures !== undefined,
    pictureFormat: manifest.storage.texture?.format,
    lastLevel: manifest.levels.length - 1,
  };
}

/// Adds to `complaints` what the page writes on its console of these types, and what it throws.
export function collectComplaints(page, complaints, types = ['error']) {
  page.on('console', (message) => types.includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
}

/// Adds styles to a page, also where its policy allows no inline ones. Returns a function that takes them away.
export async function addStyle(page, css) {
  const sheet = await page.evaluateHandle((text) => {
    const made = new CSSStyleSheet();
    made.replaceSync(text);
    document.adoptedStyleSheets.push(made);
    return made;
  }, css);
  return () => sheet.evaluate((made) => { document.adoptedStyleSheets = document.adoptedStyleSheets.filter((one) => one !== made); });
}

async function openPage(browser, url, errors) {
  const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE } });
  collectComplaints(page, errors);
  const { origin } = new URL(url);
  page.on('request', (request) => {
    const asked = new URL(request.url());
    if (asked.protocol.startsWith('http') && asked.origin !== origin) errors.push(`${asked} is not on this machine`);
  });
  page.on('requestfailed', (request) => {
    const reason = request.failure()?.errorText;
    if (reason !== 'net::ERR_ABORTED') errors.push(`${request.url()}: ${reason}`); // that is the page's own wish
  });
  await page.goto(url);
  await page.waitForFunction(() => window.view !== undefined).catch((error) => {
    throw new Error(`${url} does not start: ${errors.join('; ') || error.message}`);
  });
  return page;
}

/// Calls window.view's function `name` in the page.
export function call(page, name, argument) {
  return page.evaluate(([f, x]) => window.view[f](x), [name, argument]);
}

/// To run in a page of viewer/ before its scripts: a view at rest becomes no finer than a moving one, which takes a second each time.
export function withoutRestDetail() {
  if (localStorage.getItem('meshhier') === null) localStorage.setItem('meshhier', '{"settings": {"restDetail": 1}}');
}

/// The page of viewer/ loses its graphics device, and gets it back with nothing on it.
export function loseDevice(page) {
  return page.evaluate(async () => {
    const canvas = document.querySelector('.surface canvas');
    const loss = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
    const told = (what) => new Promise((done) => { canvas.addEventListener(what, () => setTimeout(done), { once: true }); });
    const [lost, restored] = [told('webglcontextlost'), told('webglcontextrestored')];
    loss.loseContext();
    await lost;
    loss.restoreContext();
    await restored;
  });
}

/// RGBA of a picture, decoded by a page: the uppermost row first. As text it comes quickly; Playwright looks at each element of an array.
export async function decodePicture(decoder, picture) {
  const text = await decoder.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const pixels = context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    const piece = 0x8000;
    let bytes = '';
    for (let i = 0; i < pixels.length; i += piece) bytes += String.fromCharCode(...pixels.subarray(i, i + piece));
    return btoa(bytes);
  }, picture.toString('base64'));
  return Buffer.from(text, 'base64');
}

/// One page of a viewer: `show(page)` works with it, with `directories` below its server; an error on
/// its console is a problem.
export async function withPage(browser, report, { viewer, name, directories }, show) {
  const server = await serve({
    '/pages': HERE,
    '/modules': path.join(HERE, 'node_modules'),
    ...directories,
  });
  const errors = [];
  const page = await openPage(browser, `${server.origin}/pages/${viewer}.html`, errors);
  await show(page);
  report.line(`${name} ${viewer} console`, errors.length === 0, errors.join('; ') || 'no errors');
  await page.close();
  server.close();
}

/// Its pages wait so long for whatever they are asked.
function withPatience(browser) {
  const make = browser.newContext.bind(browser);
  browser.newContext = async (options) => {
    const context = await make(options);
    context.setDefaultTimeout(PATIENCE);
    return context;
  };
  return browser;
}

/// Runs `checks(browser, report)`. The exit code: 0: all is as it should be; 1: something is not;
/// 77: the viewers or Chromium are not installed.
export async function inChromium(pictures, checks) {
  const chromium = await loadPlaywright();
  if (chromium === null || CHROMIUM === undefined) {
    console.log('the viewers or Chromium are not installed: run scripts/install_dependencies web');
    return 77;
  }
  mkdirSync(pictures, { recursive: true });
  const browser = withPatience(await chromium.launch({
    executablePath: CHROMIUM,
    timeout: PATIENCE,
    args: ['--no-sandbox', '--js-flags=--expose-gc', '--enable-precise-memory-info', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  }));
  const report = new Report();
  await checks(browser, report);
  await browser.close();
  return report.problems === 0 ? 0 : 1;
}

/// Two screenshots, of channels of 255: how far they are apart at the most, and on average where neither is white; and parts of all pixels that the
/// other has darker, or lighter.
export function comparePictures(page, one, other) {
  return page.evaluate(async (pictures) => {
    const [a, b] = await Promise.all(pictures.map(async (data) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    }));
    if (a.length !== b.length) return { most: 255, mean: 255, covered: 0, darker: 1, lighter: 1 };
    const sums = { most: 0, apart: 0, covered: 0, darker: 0, lighter: 0 };
    for (let i = 0; i < a.length; i += 4) {
      const by = [0, 1, 2].map((c) => b[i + c] - a[i + c]);
      const all = by[0] + by[1] + by[2];
      sums.most = Math.max(sums.most, ...by.map(Math.abs));
      if (all < -15) ++sums.darker;
      if (all > 6) ++sums.lighter;
      if (Math.max(a[i] + a[i + 1] + a[i + 2], b[i] + b[i + 1] + b[i + 2]) === 765) continue;
      sums.apart += Math.abs(by[0]) + Math.abs(by[1]) + Math.abs(by[2]);
      ++sums.covered;
    }
    const pixels = a.length / 4;
    return { most: sums.most, mean: sums.apart / (3 * sums.covered), covered: sums.covered / pixels, darker: sums.darker / pixels, lighter: sums.lighter / pixels };
  }, [one.toString('base64'), other.toString('base64')]);
}
