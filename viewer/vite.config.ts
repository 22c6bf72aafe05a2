// SPDX-License-Identifier: MIT
import { readFileSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import path from 'node:path';
import { gzipSync } from 'node:zlib';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';
import { inlineBoot } from './lean/boot.js';
import { contentPolicy } from './lean/policy.js';
import { leanThree } from './lean/three.js';

/// Beside each script and style a copy in gzip, for hosts that send those.
export function packedCopies(): Plugin {
  return {
    name: 'packed-copies',
    writeBundle({ dir }, bundle) {
      for (const name of Object.keys(bundle).filter((each) => /\.(js|css)$/.test(each))) {
        const file = path.join(dir ?? '', name);
        writeFileSync(`${file}.gz`, gzipSync(readFileSync(file), { level: 9 }));
      }
    },
  };
}

/// In a script that does not transcode KTX2 itself.
export function withoutTranscoder(): Plugin {
  return {
    name: 'without-transcoder',
    enforce: 'pre',
    resolveId: (source) => (source.endsWith('/basis_transcoder.js') ? path.resolve('page/no_transcoder.ts') : null),
  };
}

export default defineConfig({
  root: 'page',
  base: './',
  plugins: [leanThree(), inlineBoot(), contentPolicy(), packedCopies()],
  build: { outDir: '../dist/page', emptyOutDir: true, target: 'es2022', chunkSizeWarningLimit: 1000 },
  worker: { format: 'es' },
  test: { root: '.', include: ['test/**/*.test.ts'], pool: 'threads', poolOptions: { threads: { minThreads: availableParallelism(), maxThreads: availableParallelism() } }, isolate: false, testTimeout: 120_000 }, // time decides no test
});
