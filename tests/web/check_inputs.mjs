// Compares what meshhier makes of mesh files with what other readers say of them: three.js's loaders (PLY, OBJ, STL), assimp, osgconv (OSGB),
// gdal (rasters of heights) and 3d-tiles-tools (tilesets).
//
//   node check_inputs.mjs MESHHIER REASONS ROOT=NAME...
//
// Builds each mesh below each ROOT, exports its last level, and compares area, volume, bounds and mean colour of its vertices. REASONS: a
// JSON file of known differences, {"NAME/path": {"reader": "why"}}. Each difference is printed; exit code 1 if one has no reason, or a
// reason no difference; 2: wrong use. INPUTS_SHARE=K/N in the environment checks every N-th file only.
import { execFile } from 'node:child_process';
import { mkdtemp, readdir, readFile, rm } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { promisify } from 'node:util';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';

const run = promisify(execFile);
const RASTERS = /\.(tiff?|cog|hgt|asc)$/i;
const OSGB = /\.osgb$/i;
const TILESET = /((^|\/)tileset\.json|\.3tz)$/;
const KINDS = /(\.(ply|obj|stl|off|gltf|glb|osgb|tiff?|cog|hgt|asc|3tz)|(^|\/)tileset\.json)$/i;
const ODM = /(^|\/)odm_texturing\/odm_textured_model_geo\.obj$/;
const SECONDS = 120;
const FLOAT = 2 ** -23; // a float's relative rounding, there and back
const PART = 1e-5; // of a measure: sums in another order, numbers written with few digits
const COLOUR = 0.004; // of mean light: bytes, rounded

const subtract = (a, b) => a.map((x, i) => x - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/// Measures triangles. Each of `soups` is an array of 3 n numbers, and perhaps as many of colours.
function measure(soups) {
  const found = { triangles: 0, area: 0, volume: 0, edges: 0, min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity], colour: null };
  const sum = [0, 0, 0];
  let coloured = 0;
  for (const { places } of soups) {
    for (let i = 0; i < places.length; ++i) {
      found.min[i % 3] = Math.min(found.min[i % 3], places[i]);
      found.max[i % 3] = Math.max(found.max[i % 3], places[i]);
    }
  }
  for (const { places, colours } of soups) {
    for (let i = 0; i + 9 <= places.length; i += 9) {
      const corners = [0, 3, 6].map((k) => subtract([places[i + k], places[i + k + 1], places[i + k + 2]], found.min));
      const normal = cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]));
      const area = Math.sqrt(dot(normal, normal)) / 2;
      found.triangles += 1;
      found.area += area;
      found.volume += dot(corners[0], cross(corners[1], corners[2])) / 6;
      found.edges += Math.hypot(...subtract(corners[1], corners[0])) + Math.hypot(...subtract(corners[2], corners[1])) + Math.hypot(...subtract(corners[0], corners[2]));
      if (!colours) continue;
      coloured += area;
      for (let c = 0; c < 9; ++c) sum[c % 3] += (area * colours[i + c]) / 3;
    }
  }
  if (coloured > 0) found.colour = sum.map((s) => s / coloured);
  return found;
}

/// Returns the triangles of a geometry of three.
function soupOf({ attributes: { position, color }, index }) {
  const corners = index ? index.count : position.count - (position.count % 3);
  const places = new Float64Array(3 * corners);
  const colours = color ? new Float64Array(3 * corners) : null;
  for (let i = 0; i < corners; ++i) {
    const v = index ? index.getX(i) : i;
    places.set([position.getX(v), position.getY(v), position.getZ(v)], 3 * i);
    colours?.set([color.getX(v), color.getY(v), color.getZ(v)], 3 * i);
  }
  return { places, colours };
}

const bytesOf = async (file) => {
  const bytes = await readFile(file);
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
};

/// Where faces have something of their own, three makes corners of vertices: no index then.
async function readPly(file) {
  const bytes = await bytesOf(file);
  const geometry = new PLYLoader().parse(bytes);
  const hasFaces = /element\s+face\s+[1-9]/.test(Buffer.from(bytes).toString('latin1', 0, 65536));
  return geometry.index || hasFaces ? [soupOf(geometry)] : [];
}

const READERS = {
  three: async (file) => {
    if (/\.ply$/i.test(file)) return readPly(file);
    if (/\.stl$/i.test(file)) return [soupOf(new STLLoader().parse(await bytesOf(file)))];
    if (!/\.obj$/i.test(file)) return null;
    const soups = [];
    new OBJLoader().parse(await readFile(file, 'utf8')).traverse((part) => {
      if (part.isMesh) soups.push(soupOf(part.geometry));
    });
    return soups;
  },
  assimp: async (file, work) => {
    if (RASTERS.test(file) || OSGB.test(file) || TILESET.test(file)) return null;
    const stl = path.join(work, 'assimp.stl');
    await rm(stl, { force: true });
    await run('assimp', ['export', file, stl, '-fstlb', '-ptv'], { timeout: 1000 * SECONDS });
    const view = new DataView(await bytesOf(stl));
    const count = view.getUint32(80, true);
    const places = new Float64Array(9 * count);
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 9; ++k) places[9 * i + k] = view.getFloat32(84 + 50 * i + 12 + 4 * k, true);
    }
    return [{ places, colours: null }];
  },
  osgconv: async (file, work) => {
    if (!OSGB.test(file)) return null;
    const obj = path.join(work, 'osgconv.obj');
    await rm(obj, { force: true });
    await run('osgconv', [file, obj], { timeout: 1000 * SECONDS });
    return READERS.three(obj);
  },
};

// ---- rasters: the judge tells heights, and of a square both ways to cut it

const MOST_CELLS = 4e6;

/// Returns the cells of a raster as gdal reads them; null where they are no heights.
async function cellsOf(file, work) {
  const info = JSON.parse((await run('gdalinfo', ['-json', file], { timeout: 1000 * SECONDS })).stdout);
  const [columns, rows] = info.size;
  const [band] = info.bands;
  if (info.bands.length > 1 || columns * rows > MOST_CELLS || /^(C|Byte)/.test(band.type)) return null;
  const raw = path.join(work, 'gdal.raw');
  await run('gdal_translate', ['-q', '-ot', 'Float64', '-unscale', '-of', 'ENVI', file, raw], { timeout: 1000 * SECONDS });
  const heights = new Float64Array(await bytesOf(raw));
  const asStored = band.type === 'Float32' ? Math.fround : (value) => value;
  const nodata = band.noDataValue === undefined ? NaN : asStored(Number(band.noDataValue)) * (band.scale ?? 1) + (band.offset ?? 0);
  const onGlobe = /^(GEOGCRS|GEODCRS|BOUNDCRS\[\s*SOURCECRS\[\s*GEOGCRS)/.test(info.coordinateSystem?.wkt ?? '');
  return { heights: heights.map((h) => (h === nodata || !Number.isFinite(h) ? NaN : h)), columns, rows, to: info.geoTransform ?? [0, 1, 0, 0, 0, 1], onGlobe };
}

/// Measures the surface over the cells: its area lies between that of the shorter and that of the longer cuts.
function measureCells({ heights, columns, rows, to, onGlobe }) {
  const found = { ...measure([]), least: 0, most: 0, onGlobe };
  const place = (x, y) => [to[0] + (x + 0.5) * to[1] + (y + 0.5) * to[2], to[3] + (x + 0.5) * to[4] + (y + 0.5) * to[5], heights[y * columns + x]];
  const area = (a, b, c) => Math.hypot(...cross(subtract(b, a), subtract(c, a))) / 2;
  for (let y = 0; y + 1 < rows; ++y) {
    for (let x = 0; x + 1 < columns; ++x) {
      const corners = [place(x, y), place(x + 1, y), place(x + 1, y + 1), place(x, y + 1)];
      const there = corners.filter(([, , h]) => !Number.isNaN(h));
      if (there.length < 3) continue;
      const [a, b, c, d] = there;
      const cuts = d ? [area(a, b, c) + area(a, c, d), area(a, b, d) + area(b, c, d)] : [area(a, b, c)];
      found.triangles += there.length - 2;
      found.least += Math.min(...cuts);
      found.most += Math.max(...cuts);
      for (const corner of there) {
        corner.forEach((value, axis) => {
          found.min[axis] = Math.min(found.min[axis], value);
          found.max[axis] = Math.max(found.max[axis], value);
        });
      }
    }
  }
  found.area = found.most;
  return found;
}

async function measureRaster(file, work) {
  const cells = RASTERS.test(file) ? await cellsOf(file, work) : null;
  return cells && measureCells(cells);
}

// ---- tilesets: the finest tiles as 3d-tiles-tools walks them, their meshes as glTF-Transform reads them

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const Z_UP = [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1];
const times = (a, b) => a.map((_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + (i % 4)] * b[4 * Math.floor(i / 4) + k], 0));
const moved = (m, [x, y, z]) => [0, 1, 2].map((i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]);

async function gltfReader() {
  const [{ NodeIO }, { ALL_EXTENSIONS }, draco, { MeshoptDecoder }] = await Promise.all([import('@gltf-transform/core'), import('@gltf-transform/extensions'), import('draco3dgltf'), import('meshoptimizer')]);
  await MeshoptDecoder.ready;
  return new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'draco3d.decoder': await draco.default.createDecoderModule(), 'meshopt.decoder': MeshoptDecoder });
}

/// Returns the triangles of a glTF's scene, moved by a matrix.
function gltfSoups(document, to) {
  const soups = [];
  const scene = document.getRoot().getDefaultScene() ?? document.getRoot().listScenes()[0];
  scene.traverse((node) => {
    const matrix = times(times(to, Z_UP), node.getWorldMatrix());
    for (const part of node.getMesh()?.listPrimitives() ?? []) {
      const position = part.getAttribute('POSITION');
      if (part.getMode() !== 4 || !position) continue;
      const corners = part.getIndices()?.getArray() ?? Array.from({ length: position.getCount() }, (_, i) => i);
      soups.push({ places: Float64Array.from([...corners].flatMap((i) => moved(matrix, position.getElement(i, [])))), colours: null });
    }
  });
  return soups;
}

async function measureTileset(file) {
  if (!TILESET.test(file)) return null;
  const [{ TilesetTraverser, TilesetSources, TilesetSourceResourceResolver, TileFormats }, io] = await Promise.all([import('3d-tiles-tools'), gltfReader()]);
  const source = await TilesetSources.createAndOpen(file);
  const contents = [];
  const traverser = new TilesetTraverser('.', new TilesetSourceResourceResolver('.', source), { depthFirst: true, traverseExternalTilesets: true });
  await traverser.traverse(JSON.parse((await source.getValue('tileset.json')).toString()), async (tile) => {
    const line = [];
    for (let at = tile; at; at = at.getParent()) line.unshift(at.asFinalTile());
    const adds = line.findLast(({ refine }) => refine)?.refine === 'ADD';
    if (!adds && (await tile.getChildren()).length > 0) return true;
    const to = line.reduce((matrix, { transform }) => (transform ? times(matrix, transform) : matrix), IDENTITY);
    for (const { uri } of tile.getFinalContents()) contents.push([await tile.getResourceResolver().resolveData(uri), to]);
    return true;
  });
  const soups = [];
  for (const [bytes, to] of contents) {
    const start = bytes?.toString('latin1', 0, 100) ?? '{';
    if (/^(\s*\{|i3dm|pnts)/.test(start)) continue; // an external tileset; what is left out
    const glbs = start.startsWith('glTF') ? [bytes] : await TileFormats.extractGlbBuffers(bytes, () => Promise.resolve(undefined));
    for (const glb of glbs) soups.push(...gltfSoups(await io.readBinary(glb), to));
  }
  return { ...measure(soups), isTileset: true };
}

const measureSoups = (read) => async (file, work) => {
  const soups = await read(file, work);
  return soups && measure(soups);
};
const JUDGES = { ...Object.fromEntries(Object.entries(READERS).map(([name, read]) => [name, measureSoups(read)])), gdal: measureRaster, '3d-tiles-tools': measureTileset };

/// Throws the first line that meshhier says.
async function built(meshhier, file, work) {
  const hierarchy = path.join(work, 'a.hier');
  const ply = path.join(work, 'a.ply');
  const call = async (...words) => {
    try {
      return (await run(meshhier, words, { timeout: 1000 * SECONDS, maxBuffer: 2 ** 26 })).stdout;
    } catch (error) {
      throw new Error(String(error.stderr || error.message).trim().split('\n').at(-1));
    }
  };
  await call('build', file, '-o', hierarchy, '--force', '--progress', 'none', '--set', 'preview=false', '--set', 'storage.normals=none', '--set', 'missing_images=ignore');
  const levels = JSON.parse(await call('inspect', hierarchy, '--json')).levels.length;
  await call('export', hierarchy, '--level', String(levels - 1), '-o', ply, '--force', '--progress', 'none');
  return measure(await readPly(ply));
}

const say = (line) => process.stdout.write(`${line}\n`);
const rounded = (value) => Number(value.toPrecision(6));

/// In words; empty if both are the same surface.
function difference(ours, theirs) {
  if (theirs.triangles === 0) return ''; // who finds nothing says nothing
  if (ours.triangles === 0) return theirs.area === 0 ? '' : `no triangles, there area ${rounded(theirs.area)}`;
  const rounding = FLOAT * Math.max(...[ours, theirs].flatMap(({ min, max }) => [...min, ...max].map(Math.abs)));
  const size = Math.hypot(...subtract(theirs.max, theirs.min));
  const told = [];
  const compare = (name, a, b, most) => {
    if (!(Math.abs(a - b) <= most)) told.push(`${name} ${rounded(a)}, there ${rounded(b)}`);
  };
  if (theirs.isTileset) {
    compare('triangles', ours.triangles, theirs.triangles, 0);
    compare('area', ours.area, theirs.area, PART * theirs.area + rounding * theirs.edges);
    return told.join('; '); // it may stand in a local frame
  }
  if (theirs.least !== undefined) {
    compare('triangles', ours.triangles, theirs.triangles, 0);
    if (theirs.onGlobe) return told.join('; '); // it stands in a local frame
    const clamped = Math.min(Math.max(ours.area, theirs.least), theirs.most);
    compare('area', ours.area, clamped, PART * theirs.area + rounding * ours.edges);
  } else {
    compare('area', ours.area, theirs.area, PART * theirs.area + rounding * theirs.edges);
    compare('volume', ours.volume, theirs.volume, (PART * size + 4 * rounding) * theirs.area);
  }
  for (const end of ['min', 'max']) {
    for (let axis = 0; axis < 3; ++axis) compare(`${end} ${'xyz'[axis]}`, ours[end][axis], theirs[end][axis], 2 * rounding + PART * size);
  }
  if (theirs.colour) {
    if (ours.colour === null) told.push('no colours');
    else ours.colour.forEach((c, i) => { compare('rgb'[i], c, theirs.colour[i], COLOUR); });
  }
  return told.join('; ');
}

async function filesBelow(root) {
  const entries = await readdir(root, { withFileTypes: true, recursive: true });
  return entries.filter((entry) => entry.isFile() && KINDS.test(entry.name)).map((entry) => path.join(entry.parentPath ?? entry.path, entry.name)).sort();
}

async function check(name, file, meshhier, reasons, work) {
  let ours = null;
  let refusal = '';
  try {
    ours = await built(meshhier, ODM.test(file) ? path.resolve(path.dirname(file), '..') : file, work);
  } catch (error) {
    refusal = error.message;
  }
  const lines = [];
  for (const [reader, judge] of Object.entries(JUDGES)) {
    let theirs = null;
    try {
      theirs = await judge(file, work);
    } catch {
      // what others refuse says nothing
    }
    if (theirs === null) continue;
    const found = ours ? difference(ours, theirs) : theirs.area > 0 ? `refused: ${refusal}` : '';
    const reason = reasons[name]?.[reader];
    if (found !== '') lines.push([reason ? 'known' : 'FAIL', `${name} (${reader}): ${found}${reason ? `; ${reason}` : ''}`]);
    else if (reason) lines.push(['FAIL', `${name} (${reader}): there is no difference any more (${reason})`]);
  }
  return lines;
}

const [meshhier, reasonsFile, ...roots] = process.argv.slice(2);
if (roots.length === 0 || roots.some((root) => !root.includes('='))) {
  console.log('usage: node check_inputs.mjs MESHHIER REASONS ROOT=NAME...');
  process.exit(2);
}
const reasons = JSON.parse(await readFile(reasonsFile, 'utf8'));
const [share, shares] = (process.env.INPUTS_SHARE ?? '0/1').split('/').map(Number);
const all = [];
for (const [root, name] of roots.map((argument) => argument.split('='))) {
  for (const file of await filesBelow(root)) all.push([path.posix.join(name, path.relative(root, file)), file]);
}
const mine = all.filter((_, i) => i % shares === share % shares);
let failures = 0;
let known = 0;
async function work() {
  const directory = await mkdtemp(path.join(os.tmpdir(), 'check_inputs-'));
  for (let next = mine.shift(); next; next = mine.shift()) {
    for (const [kind, line] of await check(...next, meshhier, reasons, directory)) {
      say(`${kind}  ${line}`);
      if (kind === 'FAIL') failures += 1;
      else known += 1;
    }
  }
  await rm(directory, { recursive: true, force: true });
}
const count = mine.length;
console.log = console.warn = console.error = () => undefined; // the loaders' own words
await Promise.all([work(), work()]);
say(`${count} of ${all.length} files: ${known} known differences, ${failures} others`);
process.exitCode = failures > 0 ? 1 : 0;
