// SPDX-License-Identifier: MIT
// The page's boot (page/boot.ts) as a script within index.html: it saves the way to the host and back that a file of its own takes.
import { build, type Plugin, type Rollup } from 'vite';

const VIEW = 'page/view/model_view.ts';
/// The boot stands before styles, for which scripts wait.
const PLACE = '<script type="module"';

function chunksOf(bundle: Rollup.OutputBundle): Rollup.OutputChunk[] {
  return Object.values(bundle).filter((part) => part.type === 'chunk');
}

/// Returns the files that the view's code is in: its chunk, those that it imports, and their styles; not those of the page's own script.
export function viewFiles(bundle: Rollup.OutputBundle): string[] {
  const chunks = chunksOf(bundle);
  const view = chunks.find(({ moduleIds }) => moduleIds.some((id) => id.endsWith(VIEW)));
  if (view === undefined) throw new Error(`${VIEW} is no chunk of its own: what does the boot ask for?`);
  const own = new Set(chunks.filter(({ isEntry }) => isEntry).flatMap(({ fileName, imports }) => [fileName, ...imports]));
  const files = [view.fileName, ...view.imports].filter((file) => !own.has(file));
  return files.flatMap((file) => [file, ...((bundle[file] as Rollup.OutputChunk).viteMetadata?.importedCss ?? [])]);
}

async function bootScript(files: readonly string[]): Promise<string> {
  const built = await build({
    configFile: false,
    logLevel: 'error',
    define: { VIEW_FILES: JSON.stringify(files.map((file) => `./${file}`)) },
    build: { write: false, target: 'es2022', modulePreload: false, rollupOptions: { input: 'page/boot.ts', output: { format: 'iife' } } },
  });
  const { output } = Array.isArray(built) ? built[0] : (built as Rollup.RollupOutput);
  return output[0].code.trim().replace(/<\/script/g, '<\\/script');
}

export function inlineBoot(): Plugin {
  return {
    name: 'inline-boot',
    apply: 'build',
    transformIndexHtml: {
      order: 'post', // all files have their names
      handler: async (html, { bundle }) => (bundle === undefined ? html : html.replace(PLACE, `<script>${await bootScript(viewFiles(bundle))}</script>\n    ${PLACE}`)),
    },
  };
}
