// SPDX-License-Identifier: MIT
import { defineConfig } from 'vite';
import { leanThree } from './lean/three.js';
import { packedCopies, withoutTranscoder } from './vite.config.js';

/// dist/page/meshhier-viewer.js, beside the page. The transcoder of KTX2 is a script beside it, for pages with such pictures alone.
export default defineConfig({
  plugins: [leanThree(), withoutTranscoder(), packedCopies()],
  build: {
    outDir: 'dist/page',
    emptyOutDir: false,
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    modulePreload: false,
    rollupOptions: { input: 'page/element.ts', output: { entryFileNames: 'meshhier-viewer.js', inlineDynamicImports: true } },
  },
  worker: { format: 'iife', plugins: () => [withoutTranscoder()], rollupOptions: { output: { inlineDynamicImports: true } } }, // in a sandboxed frame Chromium starts no modules as workers
});
