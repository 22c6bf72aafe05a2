// The page in Firefox as it is installed: one HTML file from the disk, an archive on a plain host of another origin, and served with headers.
//
//   node firefox.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz
//
// Both of the same mesh. Firefox draws on a display that nobody sees (Xvfb), by software. Exit code 2: wrong use; 77: Firefox, Xvfb or the
// driver is not installed; else as browser.mjs.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { PATIENCE, Report } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';

const FIREFOX = ['/usr/bin/firefox-esr', '/usr/bin/firefox'].find((file) => existsSync(file));
const XVFB = '/usr/bin/Xvfb';

async function loadDriver() {
  try {
    return (await import('puppeteer-core')).default;
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    return null;
  }
}

/// Resolves to {name, close}: ":7" of a free display.
function startDisplay() {
  const server = spawn(XVFB, ['-displayfd', '3', '-screen', '0', '1280x1024x24', '-nolisten', 'tcp'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe'] });
  return new Promise((resolve, reject) => {
    server.once('exit', (code) => reject(new Error(`Xvfb ended with ${code}`)));
    server.stdio[3].once('data', (number) => resolve({ name: `:${number.toString().trim()}`, close: () => server.kill() }));
  });
}

/// A page at rest: what it shows and complained about.
async function open(browser, url) {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE);
  await page.setViewport({ width: 800, height: 600 });
  const complaints = [];
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  await page.goto(url);
  await page.waitForFunction(() => window.meshhier?.settled());
  return { page, complaints, stats: await page.evaluate(() => window.meshhier.stats()) };
}

/// How many colours its picture has: a page that draws nothing has few.
async function coloursOf(page, file) {
  const picture = Buffer.from(await page.screenshot({ path: file })).toString('base64');
  return page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colours.size;
  }, picture);
}

async function checkShown(browser, report, what, url, file) {
  const { page, complaints, stats } = await open(browser, url);
  const colours = await coloursOf(page, file);
  report.line(`Firefox, ${what}`, stats.triangles > 1000 && stats.failed === 0 && colours > 50 && complaints.length === 0,
    `${stats.tiles} tiles, ${stats.triangles} triangles, ${colours} colours; ${complaints.join('; ') || 'no errors'}`);
  await page.close();
}

async function checkAll(browser, report, [meshhier, pictures, pageDirectory, directory, archive]) {
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-firefox-'));
  const alone = path.join(work, 'alone.html');
  execFileSync(meshhier, ['page', directory, '-o', alone], { stdio: 'ignore' });
  await checkShown(browser, report, 'a page from the disk', pathToFileURL(alone).href, path.join(pictures, 'firefox-file.png'));
  const page = await serve({ '': pageDirectory });
  const host = await serve({ '': path.dirname(archive) }, { ranges: true });
  const model = `${host.origin}/${path.basename(archive)}`;
  await checkShown(browser, report, 'an archive elsewhere', `${page.origin}/index.html?model=${encodeURIComponent(model)}`, path.join(pictures, 'firefox-archive.png'));
  host.close();
  page.close();
  const server = startServer(meshhier, path.dirname(directory), '--viewer', pageDirectory);
  await checkShown(browser, report, 'a served page, with its headers', `${await server.url}#models/${path.basename(directory)}`, path.join(pictures, 'firefox-served.png'));
  await server.stop();
  rmSync(work, { recursive: true });
}

const args = process.argv.slice(2);
if (args.length !== 5) {
  console.error('usage: node firefox.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz');
  process.exit(2);
}
const driver = await loadDriver();
if (driver === null || FIREFOX === undefined || !existsSync(XVFB)) {
  console.log('Firefox, Xvfb or the driver is not installed: run scripts/install_dependencies web');
  process.exit(77);
}
mkdirSync(args[1], { recursive: true });
const display = await startDisplay();
const report = new Report();
try {
  const browser = await driver.launch({ browser: 'firefox', executablePath: FIREFOX, headless: false, timeout: PATIENCE, protocolTimeout: PATIENCE, env: { ...process.env, DISPLAY: display.name } });
  await checkAll(browser, report, args);
  await browser.close();
} finally {
  display.close();
}
process.exit(report.problems === 0 ? 0 : 1);
