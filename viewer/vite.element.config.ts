// SPDX-License-Identifier: MIT
import { defineConfig } from 'vite';
import { packedCopies } from './vite.config.js';

/// dist/page/meshhier-viewer.js, beside the page.
export default defineConfig({
  plugins: [packedCopies()],
  build: {
    outDir: 'dist/page',
    emptyOutDir: false,
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    modulePreload: false,
    rollupOptions: { input: 'page/element.ts', output: { entryFileNames: 'meshhier-viewer.js', inlineDynamicImports: true } },
  },
  worker: { format: 'es' },
});
