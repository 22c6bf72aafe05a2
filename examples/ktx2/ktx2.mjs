// SPDX-License-Identifier: MIT
// Copies a textured hierarchy for 3D Tiles viewers: its pictures become KTX2 (KHR_texture_basisu), which graphics devices keep compressed, in a
// quarter of the memory or an eighth.
//
//   node ktx2.mjs HIERARCHY OUTPUT [--etc1s]
//
// HIERARCHY: a directory, as `meshhier build` makes it. OUTPUT: a new directory of tilesets and tiles; other viewers show it, meshhier reads the
// hierarchy alone. Pictures are UASTC, which nobody sees; with --etc1s they are several times smaller, and somewhat worse. All processors work.
// Exit code 2: wrong use; 1: it failed, and nothing is left.
import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { isMainThread, parentPort, Worker, workerData } from 'node:worker_threads';
import { convertTile } from './tile.mjs';

const SELF = fileURLToPath(import.meta.url);

function convertFile(file, { source, target, isEtc1s }) {
  const write = (bytes) => {
    const place = path.join(target, file);
    mkdirSync(path.dirname(place), { recursive: true });
    writeFileSync(place, bytes);
  };
  return convertTile(readFileSync(path.join(source, file)), isEtc1s).then(write);
}

/// Tilesets and tiles, which viewers ask for.
function filesOf(source) {
  const all = readdirSync(source, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => path.relative(source, path.join(entry.parentPath ?? entry.path, entry.name)))
    .sort();
  return {
    tiles: all.filter((file) => file.startsWith(`tiles${path.sep}`) && file.endsWith('.glb')),
    tilesets: all.filter((file) => /^(tileset\.json|tilesets[/\\].*\.json)$/.test(file)),
  };
}

/// Each worker asks for the next file when it is done with one.
function convertAll(files, task) {
  let next = 0;
  const told = process.stderr.isTTY ? (text) => process.stderr.write(text) : () => {};
  const run = () =>
    new Promise((resolve, reject) => {
      const worker = new Worker(SELF, { workerData: task, stdout: true });
      worker.stdout.resume(); // the encoder tells each slice
      const go = () => {
        told(`\r${next} of ${files.length} tiles`);
        worker.postMessage(next < files.length ? files[next++] : null);
      };
      worker.on('message', (failure) => (failure === null ? go() : reject(new Error(failure))));
      worker.on('error', reject);
      worker.on('exit', resolve);
      go();
    });
  const count = Math.min(availableParallelism(), files.length);
  return Promise.all(Array.from({ length: count }, run)).finally(() => told('\n'));
}

function work() {
  parentPort.on('message', (file) => {
    if (file === null) {
      parentPort.close();
      return;
    }
    convertFile(file, workerData).then(
      () => parentPort.postMessage(null),
      (error) => parentPort.postMessage(`${file}: ${error.message}`),
    );
  });
}

function fail(text, code) {
  console.error(`ktx2: ${text}`);
  process.exit(code);
}

async function main() {
  const options = process.argv.slice(2).filter((argument) => argument.startsWith('--'));
  const [source, given, ...more] = process.argv.slice(2).filter((argument) => !argument.startsWith('--'));
  if (given === undefined || more.length > 0 || options.some((option) => option !== '--etc1s')) fail('usage: node ktx2.mjs HIERARCHY OUTPUT [--etc1s]', 2);
  const missing = ['hierarchy.json', 'tileset.json'].find((name) => !existsSync(path.join(source, name)));
  if (missing !== undefined) fail(`${source} is no directory of a hierarchy: it has no ${missing}`, 2);
  if (JSON.parse(readFileSync(path.join(source, 'hierarchy.json'), 'utf8')).source.textures === undefined) fail(`${source} has no pictures`, 2);
  const output = path.resolve(given);
  if (existsSync(output)) fail(`${output} is there already: name a new directory`, 2);
  const target = `${output}.part`;
  const clean = () => rmSync(target, { recursive: true, force: true });
  clean();
  process.on('SIGINT', () => {
    clean();
    process.exit(130);
  });
  try {
    const { tiles, tilesets } = filesOf(source);
    await convertAll(tiles, { source, target, isEtc1s: options.length > 0 });
    for (const file of tilesets) {
      mkdirSync(path.dirname(path.join(target, file)), { recursive: true });
      writeFileSync(path.join(target, file), readFileSync(path.join(source, file)));
    }
    renameSync(target, output);
    console.log(`made ${output}: ${tiles.length} tiles`);
  } catch (error) {
    clean();
    fail(error.message, 1);
  }
}

if (isMainThread) await main();
else work();
