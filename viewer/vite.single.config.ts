// SPDX-License-Identifier: MIT
import type { Plugin } from 'vite';
import { defineConfig } from 'vite';
import { leanThree } from './lean/three.js';
import { withoutTranscoder } from './vite.config.js';

/// Workers as part of the script: a page that was opened from a disk may load none.
function inlineWorkers(): Plugin {
  return {
    name: 'inline-workers',
    enforce: 'pre',
    async resolveId(source, importer) {
      return source.endsWith('?worker') ? this.resolve(`${source}&inline`, importer, { skipSelf: true }) : null;
    },
  };
}

/// Of pictures the page shows its own alone, whatever it is told: it asks nobody for one.
const POLICY = '<meta http-equiv="Content-Security-Policy" content="img-src data: blob:">';

/// The page with its script and styles within it, as `single.html`; nothing else is written.
function singleFile(): Plugin {
  return {
    name: 'single-file',
    enforce: 'post',
    generateBundle: {
      order: 'post', // after Vite's own, which has yet to finish the imports
      handler(_, bundle) {
        let html = '';
        let script = '';
        let style = '';
        for (const [name, part] of Object.entries(bundle)) {
          if (part.type === 'chunk') script += part.code;
          else if (name.endsWith('.css')) style += part.source.toString();
          else if (name.endsWith('.html')) html = part.source.toString();
          Reflect.deleteProperty(bundle, name);
        }
        const own = html.replace(/<script type="module"[^>]*><\/script>/, '').replace(/<link rel="stylesheet"[^>]*>/, '');
        const code = script.replace(/<\/script/g, '<\\/script').replace(/<!--/g, '<\\!--');
        const source = own
          .replace('<head>', () => `<head>\n    ${POLICY}`)
          .replace('</head>', () => `<style>${style}</style>\n  </head>`)
          .replace('</body>', () => `  <!-- meshhier: hierarchy -->\n    <script type="module">${code}</script>\n  </body>`);
        this.emitFile({ type: 'asset', fileName: 'single.html', source });
      },
    },
  };
}

/// dist/page/single.html, which `meshhier page` puts a hierarchy into.
export default defineConfig({
  root: 'page',
  base: './',
  plugins: [leanThree(), inlineWorkers(), withoutTranscoder(), singleFile()], // the worker alone has it
  build: {
    outDir: '../dist/page',
    emptyOutDir: false,
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    cssCodeSplit: false,
    modulePreload: false,
    assetsInlineLimit: 2 ** 24,
    rollupOptions: { output: { inlineDynamicImports: true } },
  },
  worker: { format: 'iife', rollupOptions: { output: { inlineDynamicImports: true } } }, // from a disk Chromium loads no modules as workers
});
