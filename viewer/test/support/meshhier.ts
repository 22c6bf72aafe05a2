// SPDX-License-Identifier: MIT
// Hierarchies that the program makes for these tests, and files instead of a host.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Fetch } from '../../src/hierarchy/bytes.js';

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

  /// The hierarchy of a mesh that `meshgen` makes; the one of that name if it was made already.
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
    writeFileSync(json, JSON.stringify({ input: mesh, output, ...config }));
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

/// Answers for files below a directory as a host does; knows ranges.
export function fetchFrom(directory: string, asked: string[] = []): Fetch {
  return (url, init) => {
    asked.push(url);
    const file = path.join(directory, url);
    if (!existsSync(file)) return Promise.resolve(new Response(null, { status: 404 }));
    const bytes = new Uint8Array(readFileSync(file));
    const range = /^bytes=(\d+)-(\d+)$/.exec(new Headers(init?.headers).get('Range') ?? '');
    if (!range) return Promise.resolve(new Response(bytes));
    return Promise.resolve(new Response(bytes.subarray(Number(range[1]), Number(range[2]) + 1), { status: 206 }));
  };
}
