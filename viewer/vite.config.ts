import { defineConfig } from 'vitest/config';

export default defineConfig({
  root: 'page',
  base: './',
  build: { outDir: '../dist/page', emptyOutDir: true, target: 'es2022', chunkSizeWarningLimit: 1000 },
  worker: { format: 'es' },
  test: { root: '.', include: ['test/**/*.test.ts'] },
});
