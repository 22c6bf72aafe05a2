// The page as `meshhier serve` sends it, in headless Chromium, with an inbox: a mesh that is put there appears with its progress, then as
// a model that opens; a broken one is told; what is there stays what it is.
//
//   node served.mjs MESHHIER PICTURES MODELS MESH
//
// MODELS: a directory with hierarchies; MESH: a PLY file of some size. Pictures go to the directory PICTURES. Exit code 2: wrong use;
// else see browser.mjs.
import { spawn } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { inChromium } from './browser.mjs';

const PATIENCE = 240_000; // milliseconds

/// A server of its own, once it says where it is.
function startServer(meshhier, models, inbox) {
  const server = spawn(meshhier, ['serve', models, '--port', '0', '--watch', inbox, '--settle', '0.5'], { stdio: ['ignore', 'pipe', 'pipe'] });
  const ended = new Promise((resolve) => server.on('exit', (code) => resolve(code)));
  const url = new Promise((resolve, reject) => {
    let text = '';
    const listen = (data) => {
      text += data;
      const found = /http:\/\/\S+/.exec(text);
      if (found) resolve(found[0]);
    };
    server.stdout.on('data', listen);
    server.stderr.on('data', listen);
    ended.then((code) => reject(new Error(`the server ended with ${code}: ${text}`)));
  });
  return { url, stop: () => (server.kill('SIGTERM'), ended) };
}

async function openPage(browser, url, complaints) {
  const page = await browser.newPage({ reducedMotion: 'reduce', viewport: { width: 1000, height: 700 } });
  page.setDefaultTimeout(PATIENCE);
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  await page.goto(url);
  return page;
}

/// What the gallery says while a mesh is built: every text of a job that was there, and the models in the end.
async function watchGallery(page, count, pictures) {
  const texts = new Set();
  for (const began = Date.now(); Date.now() - began < PATIENCE; ) {
    const jobs = await page.locator('.job').allInnerTexts();
    if (jobs.length > 0 && texts.size === 0) await page.screenshot({ path: path.join(pictures, 'served-jobs.png') });
    for (const job of jobs) texts.add(job.replace(/\s+/g, ' '));
    if ((await page.locator('a.cell').count()) === count) break;
    await page.waitForTimeout(200);
  }
  return { jobs: [...texts], models: await page.locator('a.cell').allInnerTexts() };
}

async function check(browser, report, { meshhier, pictures, models, mesh, work }) {
  const inbox = path.join(work, 'inbox');
  mkdirSync(inbox);
  const server = startServer(meshhier, models, inbox);
  const url = await server.url;
  const complaints = [];
  const page = await openPage(browser, url, complaints);
  await page.locator('a.cell').first().waitFor();
  const before = await page.locator('a.cell').count();
  report.line('served gallery', before > 0, `${before} models at ${url}`);
  writeFileSync(path.join(inbox, 'broken.ply'), readFileSync(mesh).subarray(0, 100_000));
  copyFileSync(mesh, path.join(inbox, 'dropped.ply'));
  const { jobs, models: found } = await watchGallery(page, before + 1, pictures);
  const broken = jobs.some((job) => job.includes('broken.ply') && /expected|ends|truncated|fail/i.test(job));
  report.line('served inbox', found.length === before + 1 && jobs.some((job) => job.includes('dropped.ply')) && broken, jobs.slice(0, 4).join(' | '));
  await page.locator('a.cell', { hasText: 'dropped' }).click();
  await page.waitForFunction(() => window.meshhier.settled());
  const stats = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, 'served-dropped.png') });
  report.line('served model', stats.fetchedFiles > 0 && stats.failed === 0, `${stats.triangles} triangles of ${stats.fetchedFiles} tiles`);
  const packed = await page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('.js')).every(({ encodedBodySize, decodedBodySize }) => encodedBodySize < decodedBodySize));
  report.line('served scripts', packed, 'packed on their way');
  await page.close();
  const code = await server.stop();
  report.line('served end', code === 0 && complaints.length === 0, `exit code ${code}; ${complaints.join('; ') || 'no complaints'}`);
}

const [meshhier, pictures, given, mesh] = process.argv.slice(2);
if (mesh === undefined) {
  console.log('usage: node served.mjs MESHHIER PICTURES MODELS MESH');
  process.exit(2);
}
const work = mkdtempSync(path.join(tmpdir(), 'meshhier-served-'));
process.exitCode = await inChromium(pictures, (browser, report) => check(browser, report, { meshhier, pictures, models: given, mesh, work }));
rmSync(work, { recursive: true });
