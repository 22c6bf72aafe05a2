// Checks what python/ shows in a cell of a notebook, in headless Chromium: with the kernel, without it, on another machine, and, where jupyter's
// nbconvert is, in a notebook that Jupyter ran.
//
//   node notebook.mjs PICTURES HIERARCHY.hier HIERARCHY.3tz KTX2.hier
//
// HIERARCHY: has tiles that a cell has no room for. KTX2: its pictures are in that format. PYTHON: the interpreter, /usr/bin/python3 if not given.
// Pictures go to the directory PICTURES. Exit code 2: wrong use; 77: numpy is not there; else see browser.mjs.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { collectComplaints, decodePicture, frames, inChromium } from './browser.mjs';

const SHAPE = { width: 800, height: 600 };
const PACKAGE = fileURLToPath(new URL('../../python', import.meta.url));
const PYTHON = process.env.PYTHON ?? '/usr/bin/python3';
const ENVIRONMENT = { ...process.env, PYTHONPATH: PACKAGE, PYTHONDONTWRITEBYTECODE: '1' };

/// Writes a page with a cell, says so, and is a kernel until its input ends.
const KERNEL = `
import sys, meshhier
with meshhier.open(sys.argv[1]) as hierarchy:
    cell = hierarchy.show(size=int(sys.argv[2]))
open(sys.argv[3], "w").write("<!doctype html><title>notebook</title>" + cell.html)
print("ready", flush=True)
sys.stdin.read()
`;

async function startKernel(hierarchy, size, file) {
  const kernel = spawn(PYTHON, ['-c', KERNEL, hierarchy, size, file], { env: ENVIRONMENT, stdio: ['pipe', 'pipe', 'inherit'] });
  await new Promise((done, fail) => {
    kernel.stdout.once('data', done);
    kernel.once('exit', () => { fail(new Error(`${hierarchy}: Python shows nothing`)); });
  });
  return async () => {
    const ended = new Promise((done) => { kernel.once('exit', done); });
    kernel.stdin.end();
    await ended;
  };
}

/// What a frame shows once nothing more comes: its text, the view, and the part of its picture that is not the ground.
async function shownIn(page, frame) {
  await frame.waitForFunction(() => document.querySelector('meshhier-viewer')?.view?.stats().settled);
  const text = await frame.locator('body > p').innerText();
  const problem = await frame.locator('meshhier-viewer p[role=alert]').isVisible();
  const finest = await frame.evaluate(() => document.querySelector('meshhier-viewer').view.stats().finestLevel);
  const picture = await frame.locator('meshhier-viewer').screenshot();
  const pixels = await decodePicture(page, picture);
  const ground = pixels.subarray(0, 3);
  let drawn = 0;
  for (let i = 0; i < pixels.length; i += 4) drawn += Number([0, 1, 2].some((c) => Math.abs(pixels[i + c] - ground[c]) > 20));
  return { text, problem, finest, picture, drawn: (4 * drawn) / pixels.length };
}

async function open(browser, address, content) {
  const context = await browser.newContext({ viewport: SHAPE, reducedMotion: 'reduce' });
  const page = await context.newPage();
  const [asked, complaints] = [new Set(), []];
  collectComplaints(page, complaints);
  page.on('request', (request) => { asked.add(new URL(request.url()).origin); });
  if (content !== undefined) await page.route(`${address}**`, (route) => route.fulfill({ contentType: 'text/html', body: content }));
  await page.goto(address);
  return { context, page, asked, complaints };
}

/// Comes so near that the finest tiles that can be had are shown.
async function approach(frame) {
  await frame.evaluate(() => {
    const viewer = document.querySelector('meshhier-viewer');
    const [position, target] = [viewer.camera.split(',').slice(0, 3).map(Number), viewer.camera.split(',').slice(3).map(Number)];
    viewer.camera = [...position.map((value, k) => target[k] + (value - target[k]) / 3), ...target].join();
  });
  await frames(frame);
}

/// Returns the finest level that is shown once the camera has come near.
async function checkCell(browser, report, pictures, { what, address, content, text, origins }) {
  const { context, page, asked, complaints } = await open(browser, address, content);
  const frame = page.frames()[1];
  const shown = await shownIn(page, frame);
  writeFileSync(path.join(pictures, `notebook ${what}.png`), shown.picture);
  report.line(`notebook ${what}`, shown.drawn > 0.05 && shown.drawn < 0.9 && !shown.problem && shown.text.includes(text), `${(100 * shown.drawn).toFixed(0)} % of the cell are drawn: ${shown.text}`);
  await approach(frame);
  const { finest } = await shownIn(page, frame);
  report.line(`notebook ${what} workers`, page.workers().length > 0, `${page.workers().length} decode tiles`);
  const others = [...asked].filter((origin) => origin !== 'null' && !origins.some((one) => origin.startsWith(one)));
  report.line(`notebook ${what} hosts`, others.length === 0, others.join(' ') || 'nobody else is asked');
  const own = complaints.filter((one) => !one.includes('ERR_CONNECTION_REFUSED'));
  report.line(`notebook ${what} console`, own.length === 0, own.join('; ') || 'no errors');
  await context.close();
  return finest;
}

/// The kernel ends while it is asked for tiles: what the cell holds is shown, from where one was.
async function checkEnd(browser, report, what, { address }, end) {
  const { context, page } = await open(browser, address);
  const frame = page.frames()[1];
  await shownIn(page, frame);
  await end();
  const camera = await frame.evaluate(() => document.querySelector('meshhier-viewer').camera);
  await approach(frame);
  await frame.waitForFunction(() => document.querySelector('p').innerText.includes('are not in this notebook'));
  const { text, problem, drawn } = await shownIn(page, frame);
  const now = await frame.evaluate(() => document.querySelector('meshhier-viewer').camera);
  report.line(`notebook ${what}: the kernel's end`, !problem && drawn > 0.05 && now !== camera && text.endsWith('are not in this notebook'), text);
  await context.close();
}

/// One model, shown in three places, the kernel's end between them.
async function checkKernel(browser, report, pictures, work, hierarchy) {
  const name = path.extname(hierarchy).slice(1);
  const file = path.join(work, `${name}.html`);
  const end = await startKernel(hierarchy, 1_200_000, file);
  const content = readFileSync(file, 'utf8');
  const own = { address: pathToFileURL(file).href, origins: ['file:', 'http://127.0.0.1:'] };
  const fine = await checkCell(browser, report, pictures, { what: name, ...own, text: 'finer ones come from the kernel' });
  const elsewhere = { address: 'https://notebooks.example/', content, origins: ['https://notebooks.example'] };
  const coarse = await checkCell(browser, report, pictures, { what: `${name} elsewhere`, ...elsewhere, text: 'finer ones are not in this notebook' });
  await checkEnd(browser, report, name, own, end);
  const kept = await checkCell(browser, report, pictures, { what: `${name} kept`, ...own, text: 'finer ones are not in this notebook' });
  report.line(`notebook ${name} detail`, kept === coarse && coarse < fine, `level ${fine} from the kernel, ${coarse} elsewhere, ${kept} without it`);
}

async function checkPictures(browser, report, pictures, work, hierarchy) {
  const file = path.join(work, 'ktx2.html');
  await (await startKernel(hierarchy, 50_000_000, file))();
  await checkCell(browser, report, pictures, { what: 'KTX2', address: pathToFileURL(file).href, text: 'all of it', origins: ['file:'] });
}

function hasNbconvert() {
  try {
    execFileSync(PYTHON, ['-c', 'import nbconvert, ipykernel, matplotlib'], { stdio: 'ignore' });
    return true;
  } catch {
    return false;
  }
}

async function checkJupyter(browser, report, pictures, work, hierarchy) {
  if (!hasNbconvert()) {
    console.log('skipped  a notebook that Jupyter ran: python3-nbconvert, python3-ipykernel or python3-matplotlib is not there');
    return;
  }
  const notebook = path.join(PACKAGE, 'examples', 'cut.ipynb');
  const home = { HOME: work, JUPYTER_PLATFORM_DIRS: '1', HIERARCHY: path.resolve(hierarchy) };
  execFileSync(PYTHON, ['-m', 'nbconvert', '--to', 'html', '--execute', notebook, '--output-dir', work, '--log-level', 'ERROR'], { env: { ...ENVIRONMENT, ...home }, stdio: 'inherit' });
  const { context, page } = await open(browser, pathToFileURL(path.join(work, 'cut.html')).href);
  const frames = page.frames().filter((frame) => frame !== page.mainFrame());
  report.line('notebook of Jupyter', frames.length === 2, `${frames.length} of 2 frames`);
  for (const [i, frame] of frames.entries()) {
    await (await frame.frameElement()).scrollIntoViewIfNeeded();
    const { text, drawn, picture } = await shownIn(page, frame);
    writeFileSync(path.join(pictures, `notebook Jupyter ${i}.png`), picture);
    report.line(`notebook of Jupyter ${i}`, drawn > 0.05, `${(100 * drawn).toFixed(0)} % of the cell are drawn: ${text}`);
  }
  await context.close();
}

const [pictures, ...hierarchies] = process.argv.slice(2);
if (hierarchies.length !== 3) {
  console.log('usage: node notebook.mjs PICTURES HIERARCHY.hier HIERARCHY.3tz KTX2.hier');
  process.exit(2);
}
try {
  execFileSync(PYTHON, ['-c', 'import numpy'], { stdio: 'ignore' });
} catch {
  console.log('numpy is not there');
  process.exit(77);
}
const work = mkdtempSync(path.join(tmpdir(), 'meshhier-notebook-'));
process.exitCode = await inChromium(pictures, async (browser, report) => {
  for (const hierarchy of hierarchies.slice(0, 2)) await checkKernel(browser, report, pictures, work, hierarchy);
  await checkPictures(browser, report, pictures, work, hierarchies[2]);
  await checkJupyter(browser, report, pictures, work, hierarchies[0]);
});
rmSync(work, { recursive: true });
