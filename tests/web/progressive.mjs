// Loads progressive streams into the TypeScript client, in headless Chromium, from a plain static
// server, and holds each step against what `meshhier reconstruct` makes of it.
//
//   node progressive.mjs MESHHIER PICTURES STREAM...
//
// Pictures go to the directory PICTURES. Exit code 0: all is as it should be; 1: something is not;
// 2: wrong use; 77: Chromium is not installed.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { call, inChromium, withPage } from './browser.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
/// The least of 512 x 512 pixels: the model fills about a tenth of the picture.
const LEAST_PIXELS = 5000;

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

async function check(page, stream, meshhier, pictures, report) {
  const name = path.basename(stream).replace(/\.[^.]*$/, '');
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-'));
  const ply = path.join(work, 'step.ply');
  const files = await call(page, 'open', '/stream');
  for (let step = 0; step < files; ++step) {
    const state = await call(page, 'next');
    execFileSync(meshhier, ['reconstruct', stream, '--details', String(step), '-o', ply, '--force', '--progress', 'none']);
    const same = (await call(page, 'digest')) === digestOf(ply);
    const covered = await call(page, 'covered');
    await page.screenshot({ path: path.join(pictures, `${name}-progressive-${step}.png`) });
    report.line(
      `${name} ${state.file}`,
      same && covered > LEAST_PIXELS,
      `level ${state.level}, ${state.entries} entries, ${same ? 'the same mesh' : 'ANOTHER MESH'} as reconstruct's, ` +
        `${covered} pixels, ${state.milliseconds.toFixed(1)} ms, ` +
        `${((1e6 * state.milliseconds) / state.entries).toFixed(0)} ns an entry, shown after ${state.shownAfter.toFixed(1)} ms`,
    );
  }
  rmSync(work, { recursive: true });
}

const [meshhier, pictures, ...streams] = process.argv.slice(2);
if (streams.length === 0) {
  console.log('usage: node progressive.mjs MESHHIER PICTURES STREAM...');
  process.exit(2);
}
process.exit(
  await inChromium(pictures, async (browser, report) => {
    for (const stream of streams) {
      const directories = { '/viewer': path.join(HERE, '../../viewer/dist'), '/stream': path.resolve(stream) };
      const job = { viewer: 'progressive', name: path.basename(stream), directories };
      await withPage(browser, report, job, (page) => check(page, stream, meshhier, pictures, report));
    }
  }),
);
