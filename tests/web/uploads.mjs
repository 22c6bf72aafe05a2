// The page as `meshhier serve --inbox` sends it, in headless Chromium: a mesh that is dropped onto the gallery becomes a model, and so
// does an OBJ with its MTL and picture; a name that is taken is told; an upload can be cancelled; a server that asks for a token gets it.
//
//   node uploads.mjs MESHHIER PICTURES MESH
//
// MESH: a PLY file of more than a MB. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, inChromium, steady, until } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

const SLOWLY = 100_000; // bytes a second
const TOKEN = '0123456789abcdef';
const HERE = path.dirname(fileURLToPath(import.meta.url));

async function openPage(browser, url, complaints) {
  const page = await browser.newPage({ reducedMotion: 'reduce', viewport: { width: 1000, height: 700 } });
  collectComplaints(page, complaints, ['error', 'warning']);
  await page.goto(url);
  await page.locator('.upload').waitFor();
  return page;
}

/// Files of this process, dropped as from a desktop.
async function drop(page, files) {
  const contents = files.map((file) => ({ name: path.basename(file), data: readFileSync(file).toString('base64') }));
  const transfer = await page.evaluateHandle(async (given) => {
    const transfer = new DataTransfer();
    for (const { name, data } of given) {
      const blob = await (await fetch(`data:application/octet-stream;base64,${data}`)).blob();
      transfer.items.add(new File([blob], name));
    }
    return transfer;
  }, contents);
  for (const event of ['dragover', 'drop']) await page.dispatchEvent('body', event, { dataTransfer: transfer });
}

async function checkMesh(page, report, { inbox, mesh }) {
  await drop(page, [mesh]);
  await page.locator('a.cell', { hasText: 'mesh' }).waitFor();
  const same = readFileSync(path.join(inbox, 'mesh.ply')).equals(readFileSync(mesh));
  report.line('uploads mesh', same, 'it is in the inbox as it was, and is a model');
  await drop(page, [mesh]);
  await page.locator('.problem', { hasText: 'mesh.ply is in the inbox already' }).waitFor();
  report.line('uploads taken', true, await page.locator('.problem-text').innerText());
}

async function checkFolder(page, report, { inbox, work, pictures }) {
  await drop(page, ['obj', 'mtl', 'png'].map((ending) => path.join(work, `textured.${ending}`)));
  await page.locator('a.cell', { hasText: 'textured' }).waitFor();
  const files = readdirSync(path.join(inbox, 'textured')).sort().join(' ');
  report.line('uploads folder', files === 'textured.mtl textured.obj textured.png', files);
  report.line('uploads problems', (await page.locator('.problem').count()) === 0, 'that of an earlier try is gone');
  await page.locator('a.cell', { hasText: 'textured' }).click();
  await page.waitForFunction(() => window.meshhier.settled());
  const { failed, tiles } = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, 'uploads-textured.png') });
  const { source } = await page.evaluate(async () => (await fetch('models/textured.hier/hierarchy.json')).json());
  report.line('uploads picture', failed === 0 && source.textures !== undefined, `${tiles} tiles with pictures`);
  await page.evaluate(() => window.meshhier.close());
}

async function checkCancel(page, report, { inbox, work, pictures, mesh }) {
  const slow = path.join(work, 'slow.ply');
  writeFileSync(slow, readFileSync(mesh));
  const outline = () => page.locator('.cell-stage', { hasNotText: /./ }).first().screenshot();
  const before = await steady(page, outline);
  const session = await page.context().newCDPSession(page);
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: SLOWLY });
  await page.setInputFiles('.upload input:not([webkitdirectory])', slow);
  const row = page.locator('.upload-row', { hasText: 'slow.ply' });
  await row.filter({ hasText: /\/s, .* left/ }).waitFor();
  report.line('uploads progress', true, (await row.innerText()).replace(/\s+/g, ' '));
  report.line('uploads outlines', await until(page, async () => (await outline()).equals(before)), 'they go along when the models move down');
  await page.screenshot({ path: path.join(pictures, 'uploads-row.png') });
  await row.getByRole('button').click();
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: -1 });
  const isClean = () => readdirSync(inbox).every((name) => !name.startsWith('.') && name !== 'slow.ply');
  report.line('uploads cancel', (await until(page, isClean)) && (await until(page, async () => (await row.count()) === 0)), 'nothing is left of it');
}

async function checkToken(browser, report, { meshhier, models, inbox, work, complaints }) {
  writeFileSync(path.join(work, 'token'), `${TOKEN}\n`);
  const server = startServer(meshhier, models, '--inbox', inbox, '--upload-token-file', path.join(work, 'token'));
  try {
    const page = await openPage(browser, await server.url, complaints);
    await page.setInputFiles('.upload input:not([webkitdirectory])', { name: 'small.off', mimeType: '', buffer: Buffer.from('OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n') });
    for (const [word, status] of [['a wrong one', 401], [TOKEN, 201]]) {
      await page.locator('dialog input').fill(word);
      const answered = page.waitForResponse((response) => response.url().endsWith('/inbox/small.off') && response.status() === status);
      await page.locator('dialog input').press('Enter');
      await answered;
    }
    await page.locator('a.cell', { hasText: 'small' }).waitFor();
    report.line('uploads token', true, 'asked for until it is right');
    await page.close();
  } finally {
    await server.stop();
  }
}

async function check(browser, report, given) {
  const { meshhier, work } = given;
  const [models, inbox] = ['models', 'inbox'].map((name) => path.join(work, name));
  for (const folder of [models, inbox]) mkdirSync(folder);
  execFileSync(process.execPath, [path.join(HERE, 'textured_square.mjs'), work]);
  const mesh = path.join(work, 'mesh.ply');
  writeFileSync(mesh, readFileSync(given.mesh));
  const complaints = [];
  const server = startServer(meshhier, models, '--inbox', inbox);
  try {
    const page = await openPage(browser, await server.url, complaints);
    const about = { ...given, mesh, inbox };
    await checkMesh(page, report, about);
    await checkFolder(page, report, about);
    await checkCancel(page, report, about);
    await page.close();
  } finally {
    const code = await server.stop();
    report.line('uploads end', code === 0, `exit code ${code}`);
  }
  await checkToken(browser, report, { meshhier, models, inbox, work, complaints });
  const unexpected = complaints.filter((text) => !/status of (401|409)/.test(text));
  report.line('uploads console', unexpected.length === 0, unexpected.join('; ') || 'no complaints');
}

const [meshhier, pictures, mesh] = process.argv.slice(2);
if (mesh === undefined) {
  console.log('usage: node uploads.mjs MESHHIER PICTURES MESH');
  process.exit(2);
}
const work = mkdtempSync(path.join(tmpdir(), 'meshhier-uploads-'));
try {
  process.exitCode = await inChromium(pictures, (browser, report) => check(browser, report, { meshhier, pictures, mesh, work }));
} finally {
  rmSync(work, { recursive: true });
}
