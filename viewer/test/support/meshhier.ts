// SPDX-License-Identifier: MIT
// Hierarchies that the program makes for these tests, and files instead of a host.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Fetch } from '../../src/hierarchy/bytes.js';
import { checksum, digitsOf } from '../../src/hierarchy/checksum.js';
import { tilePath } from '../../src/hierarchy/tree.js';

const ROOT = fileURLToPath(new URL('../../..', import.meta.url));

function program(variable: string, name: string): string {
  return process.env[variable] ?? path.join(ROOT, 'build/release', name);
}

export const MESHHIER = program('MESHHIER', 'meshhier');
const MESHGEN = program('MESHGEN', 'meshgen');

export const hasProgram = existsSync(MESHHIER) && existsSync(MESHGEN);
if (!hasProgram) console.warn(`tests of real hierarchies are skipped: ${MESHHIER} or ${MESHGEN} is not there`);

/// A directory of its own, gone when the tests end.
export class Workshop {
  readonly directory = mkdtempSync(path.join(tmpdir(), 'meshhier-viewer-'));

  /// The hierarchy of a mesh that `meshgen` makes; the one of that name if it was made already. Without
  /// normal maps, which Node.js does not decode, unless the config wants them.
  build(name: string, meshgen: readonly string[], config: object): string {
    const mesh = path.join(this.directory, `${name}.ply`);
    if (!existsSync(mesh)) execFileSync(MESHGEN, [...meshgen, '-o', mesh]);
    return this.buildMesh(name, mesh, config);
  }

  /// The same of a mesh that `meshgen` makes and then splits.
  buildSplit(name: string, meshgen: readonly string[], by: string, config: object): string {
    const mesh = path.join(this.directory, `${name}.ply`);
    const whole = path.join(this.directory, `${name}_whole.ply`);
    if (!existsSync(mesh)) {
      execFileSync(MESHGEN, [...meshgen, '-o', whole]);
      execFileSync(MESHGEN, ['split', whole, '--by', by, '-o', mesh]);
    }
    return this.buildMesh(name, mesh, config);
  }

  buildMesh(name: string, mesh: string, config: object): string {
    return this.buildInto(`${name}.hier`, mesh, config);
  }

  /// The same as an archive.
  buildArchive(name: string, meshgen: readonly string[], config: object): string {
    this.build(name, meshgen, config);
    return this.buildInto(`${name}.3tz`, path.join(this.directory, `${name}.ply`), { ...config, storage: { container: '3tz' } });
  }

  private buildInto(file: string, mesh: string, config: object): string {
    const output = path.join(this.directory, file);
    if (existsSync(output)) return output;
    const json = path.join(this.directory, `${file}.json`);
    const { storage } = config as { storage?: object };
    writeFileSync(json, JSON.stringify({ input: mesh, output, ...config, storage: { normals: 'smooth', ...storage } }));
    execFileSync(MESHHIER, ['build', json, '--progress', 'none']);
    return output;
  }

  /// The mesh of a cut, as the program assembles it: binary PLY.
  exportCut(hierarchy: string, cut: readonly string[]): Uint8Array {
    const list = path.join(this.directory, 'cut.txt');
    const output = path.join(this.directory, 'cut.ply');
    rmSync(output, { force: true });
    writeFileSync(list, `${cut.join('\n')}\n`);
    execFileSync(MESHHIER, ['export', hierarchy, '--cut', list, '-o', output]);
    return readFileSync(output);
  }

  remove(): void {
    rmSync(this.directory, { recursive: true });
  }
}

/// As hosts of files take an address.
export function withoutQuery(url: string): string {
  return url.replace(/\?.*$/, '');
}

/// The same host, but its index and its manifest have sizes and checksums of what it sends.
export function resealed(known: Fetch): Fetch {
  let index: Promise<Uint8Array<ArrayBuffer>> | null = null;
  const bytesOf = async (url: string): Promise<Uint8Array<ArrayBuffer>> => new Uint8Array(await (await known(url)).arrayBuffer());
  const seal = async (base: string): Promise<Uint8Array<ArrayBuffer>> => {
    const bytes = await bytesOf(`${base}tiles.bin`);
    const view = new DataView(bytes.buffer);
    for (let at = 32; at < bytes.length; at += 120) {
      const tile = await bytesOf(base + tilePath({ level: view.getUint32(at, true), index: view.getUint32(at + 4, true) }));
      view.setBigUint64(at + 104, BigInt(tile.length), true);
      view.setBigUint64(at + 112, checksum(tile), true);
    }
    return bytes;
  };
  return async (address, init) => {
    const url = withoutQuery(address);
    const base = url.replace(/(tiles\.bin|hierarchy\.json)$/, '');
    if (base === url) return known(url, init);
    index ??= seal(base);
    const bytes = await index;
    const range = /^bytes=(\d+)-(\d+)$/.exec(new Headers(init?.headers).get('Range') ?? '');
    if (url.endsWith('tiles.bin')) return range === null ? new Response(bytes) : new Response(bytes.slice(Number(range[1]), Number(range[2]) + 1), { status: 206 });
    const manifest = JSON.parse(await (await known(url, init)).text()) as { index: object };
    return new Response(JSON.stringify({ ...manifest, index: { ...manifest.index, checksum: digitsOf(checksum(bytes)) } }));
  };
}

/// Answers for files below a directory as a host does; knows ranges.
export function fetchFrom(directory: string, asked: string[] = []): Fetch {
  return (address, init) => {
    const url = withoutQuery(address);
    asked.push(url);
    const file = path.join(directory, url);
    if (!existsSync(file)) return Promise.resolve(new Response(null, { status: 404 }));
    const bytes = new Uint8Array(readFileSync(file));
    const range = /^bytes=(\d+)-(\d+)$/.exec(new Headers(init?.headers).get('Range') ?? '');
    if (!range) return Promise.resolve(new Response(bytes));
    return Promise.resolve(new Response(bytes.subarray(Number(range[1]), Number(range[2]) + 1), { status: 206 }));
  };
}
