// The page as `meshhier serve` sends it, in headless Chromium, with an inbox: a mesh that is put there is told of while it grows and
// while it is built, then is a model that opens; a broken one is told; what is there stays what it is.
//
//   node served.mjs MESHHIER PICTURES MODELS MESH
//
// MODELS: a directory with hierarchies; MESH: a PLY file of more than 100,000 bytes. Pictures go to the directory PICTURES. Exit code 2: wrong use;
// else see browser.mjs.
import { appendFileSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { collectComplaints, inChromium, PATIENCE } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

/// High: only cells near the window are elements of the page, and they are counted.
const WINDOW = { width: 1000, height: 2000 };
const SETTLE = 5; // seconds: a file that was as it is for so long is whole

async function openPage(browser, url, complaints) {
  const page = await browser.newPage({ reducedMotion: 'reduce', viewport: WINDOW });
  collectComplaints(page, complaints, ['error', 'warning']);
  await page.goto(url);
  return page;
}

function textOf(file) {
  try {
    return readFileSync(file, 'utf8');
  } catch {
    return ''; // the process ended meanwhile
  }
}

/// The process that builds the mesh, stopped as soon as there is one: a fast machine would be done before the page looks.
async function holdBuild(server, name) {
  const children = () => readdirSync(`/proc/${server}/task`).flatMap((thread) => textOf(`/proc/${server}/task/${thread}/children`).trim().split(' ').filter(Boolean));
  for (const began = Date.now(); Date.now() - began < PATIENCE; ) {
    const build = children().find((pid) => textOf(`/proc/${pid}/cmdline`).includes(name));
    if (build !== undefined) {
      process.kill(Number(build), 'SIGSTOP');
      return { goOn: () => process.kill(Number(build), 'SIGCONT') };
    }
    await new Promise((resolve) => setTimeout(resolve, 2));
  }
  throw new Error(`nothing builds ${name}`);
}

/// Writes the mesh a byte at a time until the page has told of it, then the rest.
async function dropSlowly(file, bytes, told) {
  let written = 0;
  writeFileSync(file, '');
  const timer = setInterval(() => appendFileSync(file, bytes.subarray(written, ++written)), (1000 * SETTLE) / 25);
  try {
    return await told;
  } finally {
    clearInterval(timer);
    appendFileSync(file, bytes.subarray(written));
  }
}

/// A broken mesh and a good one, which is told of while it grows and while it is built.
async function checkInbox(page, report, { server, inbox, pictures, mesh }) {
  const bytes = readFileSync(mesh);
  const job = (name) => page.locator('.job', { hasText: name });
  const says = async (name, text) => (await job(name).filter({ hasText: text }).waitFor(), (await job(name).innerText()).replace(/\s+/g, ' '));
  writeFileSync(path.join(inbox, 'broken.ply'), bytes.subarray(0, 100_000));
  report.line('served broken', true, await says('broken.ply', /byte 100000: expected/));
  const held = holdBuild(server.pid, 'dropped.ply');
  report.line('served growing', true, await dropSlowly(path.join(inbox, 'dropped.ply'), bytes, says('dropped.ply', 'no longer changes')));
  const build = await held;
  try {
    report.line('served building', true, await says('dropped.ply', /^(?!.*wait)/));
    await page.screenshot({ path: path.join(pictures, 'served-jobs.png') });
  } finally {
    build.goOn();
  }
  await page.locator('a.cell', { hasText: 'dropped' }).waitFor();
  const left = await page.locator('.job').allInnerTexts();
  report.line('served inbox', left.length === 1 && left[0].startsWith('broken.ply'), 'the good one is a model, the broken one is told');
}

async function checkPage(browser, report, { server, inbox, pictures, mesh }) {
  const url = await server.url;
  const complaints = [];
  const page = await openPage(browser, url, complaints);
  await page.locator('a.cell').first().waitFor();
  const before = await page.locator('a.cell').count();
  report.line('served gallery', before > 0, `${before} models at ${url}`);
  await checkInbox(page, report, { server, inbox, pictures, mesh });
  report.line('served models', (await page.locator('a.cell').count()) === before + 1, 'one more');
  await page.locator('a.cell', { hasText: 'dropped' }).click();
  await page.waitForFunction(() => window.meshhier.settled());
  const stats = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, 'served-dropped.png') });
  report.line('served model', stats.fetchedFiles > 0 && stats.failed === 0, `${stats.triangles} triangles of ${stats.fetchedFiles} tiles`);
  const packed = await page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('.js')).every(({ encodedBodySize, decodedBodySize }) => encodedBodySize < decodedBodySize));
  report.line('served scripts', packed, 'packed on their way');
  await page.close();
  report.line('served console', complaints.length === 0, complaints.join('; ') || 'no complaints');
}

async function check(browser, report, { meshhier, pictures, models, mesh, work }) {
  const inbox = path.join(work, 'inbox');
  mkdirSync(inbox);
  const server = startServer(meshhier, models, '--watch', inbox, '--settle', String(SETTLE));
  let code;
  try {
    await checkPage(browser, report, { server, inbox, pictures, mesh });
  } finally {
    code = await server.stop();
  }
  report.line('served end', code === 0, `exit code ${code}`);
}

const [meshhier, pictures, given, mesh] = process.argv.slice(2);
if (mesh === undefined) {
  console.log('usage: node served.mjs MESHHIER PICTURES MODELS MESH');
  process.exit(2);
}
const work = mkdtempSync(path.join(tmpdir(), 'meshhier-served-'));
try {
  process.exitCode = await inChromium(pictures, (browser, report) => check(browser, report, { meshhier, pictures, models: given, mesh, work }));
} finally {
  rmSync(work, { recursive: true });
}
