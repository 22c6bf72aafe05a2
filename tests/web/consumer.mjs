// Checks the library of viewer/ as `npm pack` packs it, in a project that uses it: its types resolve, its subpaths can be imported, and Vite
// builds what uses it. Tells how large what each part loads at once is, packed by gzip and without three.
//
//   node consumer.mjs VIEWER
//
// VIEWER: the directory viewer/ after `npm ci` and `npm run build`; the project has its packages. Exit code 1: something is not as it should
// be; 2: wrong use.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { gzipSync } from 'node:zlib';

/// Kilobytes in gzip that each subpath may have: as viewer/README.md tells, and a fifth more.
const MOST_KILOBYTES = { '.': 60, './element': 64, './progressive': 7, './pair': 15, './tile_worker': 21, './plugins/measuring': 10, './plugins/occlusion': 2 };

const TYPES = `
import { PerspectiveCamera } from 'three';
import { HierarchyView, type Plugin, type Settings, type Shading, type Stage, type Stats } from 'meshhier-viewer';
import { defineViewer, MeshhierViewerElement } from 'meshhier-viewer/element';
import { Clipping } from 'meshhier-viewer/plugins/clipping';
import { Measuring } from 'meshhier-viewer/plugins/measuring';
import { ProgressiveMesh } from 'meshhier-viewer/progressive';

class Own implements Plugin {
  readonly name = 'own';
  readonly shading: Shading = { uniforms: {}, key: () => '', edit: () => undefined };
  enter({ surface }: Stage): void { surface.focus(); }
}

const view = new HierarchyView('https://example.org/david.hier', { settings: { threshold: 2 } });
const news: boolean = view.update(new PerspectiveCamera(), { width: 1, height: 1 }, 0);
const stats: Stats = view.stats();
const settings: Partial<Settings> = view.settings;
const element: MeshhierViewerElement | null = document.querySelector('meshhier-viewer');
// @ts-expect-error: a threshold is a number
view.setSettings({ threshold: 'fine' });
view.registerPlugin(new Own()).registerPlugin(new Clipping());
element?.registerPlugin(() => new Measuring());
defineViewer();
export { news, stats, settings, element, ProgressiveMesh };
`;

const USE = `
import TileWorker from 'meshhier-viewer/tile_worker?worker';
import { MeshhierViewerElement } from 'meshhier-viewer/element';
import { HierarchyView } from 'meshhier-viewer';
MeshhierViewerElement.createWorker = () => new TileWorker();
new HierarchyView('a.hier', { createWorker: () => new TileWorker() });
`;

/// The library's plug-ins, and what is in their scripts alone.
const PLUGINS = ['attributes', 'clipping', 'immersion', 'measuring', 'objects', 'occlusion', 'relief', 'stories'];
const OF_PLUGINS_ALONE = ['requestSession', 'GTAO', 'stencilWrite', 'meshhier-overlay'];

let problems = 0;

function line(what, good, text) {
  if (!good) ++problems;
  console.log(`${good ? 'ok' : 'NOT OK'}  package ${what}: ${text}`);
}

/// Returns what a program writes; a failure of it is a problem.
function run(what, cwd, program, ...parameters) {
  try {
    const said = execFileSync(program, parameters, { cwd, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
    line(what, true, 'works');
    return said;
  } catch (error) {
    line(what, false, `${error.stdout}${error.stderr}`.trim());
    return '';
  }
}

/// The package and what it needs, as in a project that has installed them.
function install(project, viewer) {
  const packed = JSON.parse(execFileSync('npm', ['pack', '--json', '--pack-destination', project], { cwd: viewer, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }))[0];
  const target = path.join(project, 'node_modules/meshhier-viewer');
  mkdirSync(target, { recursive: true });
  execFileSync('tar', ['-xzf', path.join(project, packed.filename), '-C', target, '--strip-components=1']);
  const { dependencies, peerDependencies } = JSON.parse(readFileSync(path.join(target, 'package.json'), 'utf8'));
  for (const name of [...Object.keys({ ...dependencies, ...peerDependencies }), '@types']) {
    const place = path.join(project, 'node_modules', name);
    mkdirSync(path.dirname(place), { recursive: true });
    symlinkSync(path.join(viewer, 'node_modules', name), place);
  }
  return packed.files.map((file) => file.path);
}

function checkFiles(files) {
  const others = files.filter((file) => !/^(dist\/(?!page).*\.(js|d\.ts)|package\.json|README\.md|LICENSE)$/.test(file));
  line('files', others.length === 0 && files.includes('LICENSE') && files.includes('dist/index.js'), others.join(', ') || `${files.length} files: modules, types, readme, licence`);
}

function checkTypes(project, viewer, resolution) {
  const options = { strict: true, noEmit: true, target: 'es2022', lib: ['es2022', 'dom'], types: [], skipLibCheck: true, ...resolution };
  writeFileSync(path.join(project, 'tsconfig.json'), JSON.stringify({ compilerOptions: options, files: ['types.ts'] }));
  run(`types by ${resolution.moduleResolution}`, project, process.execPath, path.join(viewer, 'node_modules/typescript/bin/tsc'), '-p', '.');
}

function checkImports(project) {
  const subpaths = ['meshhier-viewer', 'meshhier-viewer/element', 'meshhier-viewer/progressive', 'meshhier-viewer/pair', ...PLUGINS.map((name) => `meshhier-viewer/plugins/${name}`)];
  const code = `for (const one of ${JSON.stringify(subpaths)}) if (Object.keys(await import(one)).length === 0) throw new Error(one + ' exports nothing')`;
  run('imports in Node', project, process.execPath, '--input-type=module', '-e', code);
}

function build(project, viewer, what, config) {
  writeFileSync(path.join(project, 'vite.config.mjs'), `export default ${config}`);
  return run(what, project, process.execPath, path.join(viewer, 'node_modules/vite/bin/vite.js'), 'build', '--logLevel', 'error');
}

/// Bytes in gzip of what a build loads at once.
function packedBytes(folder) {
  if (!existsSync(folder)) return 0;
  return scriptsIn(folder).reduce((sum, script) => sum + gzipSync(script, { level: 9 }).length, 0);
}

function checkBuild(project, viewer) {
  writeFileSync(path.join(project, 'index.html'), '<!doctype html><meshhier-viewer></meshhier-viewer><script type="module" src="./use.js"></script>');
  writeFileSync(path.join(project, 'use.js'), USE);
  build(project, viewer, 'build by Vite', '{ build: { target: "es2022", chunkSizeWarningLimit: 2000 }, worker: { format: "es" } }');
  const scripts = readdirSync(path.join(project, 'dist/assets'));
  line('worker', scripts.some((file) => file.startsWith('tile_worker')), scripts.join(' '));
}

/// The script that a build begins with, and all that it imports; what comes later, by `import()`, is left out.
function scriptsIn(folder) {
  const scripts = new Map(readdirSync(folder, { recursive: true }).filter((file) => file.endsWith('.js')).map((file) => [path.basename(file), readFileSync(path.join(folder, file), 'utf8')]));
  const loaded = new Set([...scripts.keys()].filter((file) => /^size\b/.test(file)));
  for (const file of loaded)
    for (const [, imported] of scripts.get(file).matchAll(/(?:from|import) *["'`]\.\/([^"'`]+)["'`]/g)) if (scripts.has(imported)) loaded.add(imported);
  return [...loaded].map((file) => scripts.get(file));
}

function checkSize(project, viewer, subpath, most) {
  const name = path.posix.join('meshhier-viewer', subpath);
  writeFileSync(path.join(project, 'size.js'), subpath === './tile_worker' ? `import '${name}';` : `export * from '${name}';`);
  const out = path.join(project, `sized-${subpath.replace(/\W/g, '')}`);
  build(project, viewer, `build of ${name}`, `{ build: { target: "es2022", minify: "esbuild", outDir: ${JSON.stringify(out)}, emptyOutDir: true, rollupOptions: { input: "size.js", preserveEntrySignatures: "strict", external: (id) => id.split("/")[0] === "three" } } }`);
  const kilobytes = packedBytes(out) / 1000;
  if (!subpath.startsWith('./plugins') && subpath !== './pair') { // a pair cuts both models open
    const loaded = OF_PLUGINS_ALONE.filter((word) => scriptsIn(out).some((script) => script.includes(word)));
    line(`plug-ins in ${name}`, loaded.length === 0, loaded.join(', ') || 'only those that are registered');
  }
  line(`size of ${name}`, kilobytes > 0.5 && kilobytes <= most, `${kilobytes.toFixed(1)} kB in gzip, of ${most}`);
}

function check(viewer) {
  const project = mkdtempSync(path.join(tmpdir(), 'meshhier-consumer-'));
  try {
    writeFileSync(path.join(project, 'package.json'), '{ "name": "consumer", "private": true, "type": "module" }');
    checkFiles(install(project, viewer));
    writeFileSync(path.join(project, 'types.ts'), TYPES);
    checkTypes(project, viewer, { module: 'es2022', moduleResolution: 'bundler' });
    checkTypes(project, viewer, { module: 'node16', moduleResolution: 'node16' });
    checkImports(project);
    checkBuild(project, viewer);
    for (const [subpath, most] of Object.entries(MOST_KILOBYTES)) checkSize(project, viewer, subpath, most);
  } finally {
    rmSync(project, { recursive: true });
  }
}

if (process.argv.length !== 3) {
  console.log('usage: node consumer.mjs VIEWER');
  process.exit(2);
}
check(path.resolve(process.argv[2]));
process.exit(problems === 0 ? 0 : 1);
