// Loads progressive streams into the TypeScript client, in headless Chromium, from a plain static
// server, and holds each step against what `meshhier reconstruct` makes of it.
//
//   node progressive.mjs MESHHIER PICTURES STREAM...
//
// Pictures go to the directory PICTURES. Exit code 0: all is as it should be; 1: something is not;
// 2: wrong use.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch, openPage } from './browser.mjs';
import { serve } from './server.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));

/// The corners' places of a binary PLY of floats, triangle by triangle, in SHA-256.
function digestOf(ply) {
  const bytes = readFileSync(ply);
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const head = bytes.toString('latin1', 0, end);
  const count = (element) => Number(new RegExp(`element ${element} (\\d+)`).exec(head)?.[1] ?? 0);
  const sizes = { float: 4, uchar: 1, ushort: 2 };
  const properties = [...head.matchAll(/property (float|uchar|ushort) \w+/g)];
  const stride = properties.reduce((sum, [, type]) => sum + sizes[type], 0);
  const faces = end + stride * count('vertex');
  const places = Buffer.alloc(36 * count('face'));
  for (let i = 0; i < count('face'); ++i) {
    for (let k = 0; k < 3; ++k) {
      const vertex = bytes.readUInt32LE(faces + 13 * i + 1 + 4 * k);
      bytes.copy(places, 36 * i + 12 * k, end + stride * vertex, end + stride * vertex + 12);
    }
  }
  return createHash('sha256').update(places).digest('hex');
}

async function check(page, stream, meshhier, pictures, work) {
  const name = path.basename(stream).replace(/\.[^.]*$/, '');
  const files = await page.evaluate((url) => window.stream.open(url), '/stream');
  let problems = 0;
  for (let step = 0; step < files; ++step) {
    const state = await page.evaluate(() => window.stream.next());
    const ply = path.join(work, 'step.ply');
    execFileSync(meshhier, ['reconstruct', stream, '--details', String(step), '-o', ply, '--progress', 'none']);
    const same = (await page.evaluate(() => window.stream.digest())) === digestOf(ply);
    const covered = await page.evaluate(() => window.stream.covered());
    const good = same && covered > 1000;
    problems += good ? 0 : 1;
    await page.screenshot({ path: path.join(pictures, `${name}-progressive-${step}.png`) });
    console.log(
      `${good ? 'ok' : 'NOT OK'}  ${name} ${state.file}: level ${state.level}, ${state.entries} entries, ` +
        `${same ? 'the same mesh' : 'ANOTHER MESH'} as reconstruct's, ${covered} pixels; ` +
        `${state.milliseconds.toFixed(1)} ms, ${((1e6 * state.milliseconds) / state.entries).toFixed(0)} ns an entry, ` +
        `shown after ${state.shownAfter.toFixed(1)} ms`,
    );
  }
  return problems;
}

async function main([meshhier, pictures, ...streams]) {
  if (streams.length === 0) {
    console.error('usage: node progressive.mjs MESHHIER PICTURES STREAM...');
    return 2;
  }
  mkdirSync(pictures, { recursive: true });
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-'));
  const browser = await launch();
  let problems = 0;
  try {
    for (const stream of streams) {
      const server = await serve({
        '/page': HERE,
        '/modules': path.join(HERE, 'node_modules'),
        '/viewer': path.join(HERE, '../../viewer/dist'),
        '/stream': path.resolve(stream),
      });
      const errors = [];
      const page = await openPage(browser, `${server.origin}/page/progressive.html`, 'stream', errors);
      problems += await check(page, path.resolve(stream), meshhier, pictures, work);
      for (const error of errors) console.log(`NOT OK  ${stream}: ${error}`);
      problems += errors.length;
      await page.close();
      server.close();
    }
  } finally {
    await browser.close();
    rmSync(work, { recursive: true });
  }
  return problems === 0 ? 0 : 1;
}

process.exitCode = await main(process.argv.slice(2));
