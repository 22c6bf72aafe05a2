// A tile as it is drawn: what its file (docs/file_format.md, section 4) holds for that, in arrays of its own.
import { Glb, type Gltf } from './glb.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { MOST_ELEMENTS, MOST_OWN, MOST_ROOT_TRIANGLES } from './limits.js';
import { normalCone, vertexNormals, type Cone } from './normals.js';
import { toPlaces } from './copies.js';
import { isClosed, isInsideOut } from './closed.js';

export type Indices = Uint16Array | Uint32Array;

/// Vertices 0 … own - 1 are the tile's; behind them its ghosts, then copies: further vertices at places of these. All
/// positions are exact.
export interface Tile {
  readonly level: number;
  readonly index: number;
  readonly own: number;
  readonly ghosts: number;
  /// Of each copy the vertex whose place it shares, own or ghost; ascending.
  readonly copyOf: Indices;
  /// x, y, z of each vertex, relative to the place that all tiles of a hierarchy share.
  readonly positions: Float32Array;
  /// x, y, z, 0 of each vertex, in parts of 32767: of the file, else made from the triangles. Of ghosts only the
  /// file's are right: else the tile that owns the vertex knows.
  readonly normals: Int16Array;
  /// They are the file's.
  readonly hasNormals: boolean;
  /// r, g, b, a of each vertex as in the input (not linear); or null.
  readonly colours: Uint8Array | null;
  /// Corners: of the interior triangles, then room for the border triangles that are drawn.
  readonly indices: Indices;
  readonly interiorCount: number;
  /// Corners of all border triangles, three each.
  readonly border: Indices;
  /// Tiles of this level with ghosts here, ascending; where each one's ghosts begin, and their end.
  readonly neighbours: Uint32Array;
  readonly ghostStarts: Uint32Array;
  readonly chains: Uint16Array;
  readonly cone: Cone;
  /// Of the root: whether it has no open border; and if so, whether its triangles show their backs.
  readonly closed: boolean;
  readonly insideOut: boolean;
  /// x, y, z smallest, then largest, of all vertices.
  readonly box: readonly number[];
  /// The mesh lies with its z axis up.
  readonly zUp: boolean;
}

/// What the index says of a tile.
export interface ExpectedCounts {
  readonly level: number;
  readonly index: number;
  readonly own: number;
  readonly ghosts: number;
  readonly copies: number;
  readonly interior: number;
  readonly border: number;
}

const VERSION = 2;

interface Counts extends ExpectedCounts {
  readonly neighbours: number;
  readonly chains: number;
}

/// Before anything is sized by them.
function checkCounts(glb: Glb, counts: Counts, expected: ExpectedCounts | null): void {
  const keys = ['level', 'index', 'own', 'ghosts', 'copies', 'interior', 'border'] as const;
  if (expected !== null && keys.some((key) => counts[key] !== expected[key])) glb.fail('not the tile that the index tells of');
  if (counts.level === 0 && (counts.ghosts > 0 || counts.border > 0 || counts.interior > MOST_ROOT_TRIANGLES)) glb.fail('not a root');
  if (counts.neighbours > counts.ghosts || counts.chains > counts.ghosts * counts.level) glb.fail('more neighbours or chains than ghosts allow');
}

function count(glb: Glb, values: Record<string, number>, key: string, least: number, most: number): number {
  const value = values[key];
  if (!Number.isInteger(value) || value < least || value > most) glb.fail(`"${key}" is not from ${least} to ${most}`);
  return value;
}

function readCounts(glb: Glb, values: Record<string, number>): Counts {
  if (values.version !== VERSION) glb.fail(`version ${values.version} of MESHHIER_tile is not known; this viewer knows ${VERSION}`);
  return {
    level: count(glb, values, 'level', 0, 32),
    index: count(glb, values, 'index', 0, 2 ** 32 - 1),
    own: count(glb, values, 'ownCount', 1, MOST_OWN),
    ghosts: count(glb, values, 'ghostCount', 0, MOST_ELEMENTS),
    copies: count(glb, values, 'copyCount', 0, MOST_ELEMENTS),
    neighbours: count(glb, values, 'neighbourCount', 0, MOST_ELEMENTS),
    chains: count(glb, values, 'chainEntryCount', 0, MOST_ELEMENTS),
    interior: count(glb, values, 'interiorCount', 0, MOST_ELEMENTS),
    border: count(glb, values, 'borderCount', 0, MOST_ELEMENTS),
  };
}

/// A copy, so that it is aligned and holds nothing else alive.
function detached(bytes: Uint8Array): ArrayBuffer {
  return bytes.slice().buffer;
}

function floats(bytes: Uint8Array): Float32Array {
  return new Float32Array(detached(bytes));
}

function stepOf(node: Gltf['nodes'][number]): number {
  return node.matrix ? Math.hypot(node.matrix[0], node.matrix[1], node.matrix[2]) : (node.scale?.[0] ?? 1);
}

function readPositions(glb: Glb, accessor: Gltf['accessors'][number], vertices: number): Float32Array {
  if (accessor.componentType === 5126) return floats(glb.section(accessor.bufferView, 12 * vertices));
  if (accessor.componentType !== 5123) glb.fail('positions of an unknown type');
  const points = new Uint16Array(detached(glb.section(accessor.bufferView, 8 * vertices)));
  const step = stepOf(glb.gltf.nodes[0]);
  const positions = new Float32Array(3 * vertices);
  for (let v = 0; v < vertices; ++v)
    for (let axis = 0; axis < 3; ++axis) positions[3 * v + axis] = step * points[4 * v + axis];
  return positions;
}

const COLOUR_TYPES: Record<number, { bytes: number; most: number }> = {
  5121: { bytes: 1, most: 255 },
  5123: { bytes: 2, most: 65535 },
  5126: { bytes: 4, most: 1 },
};

function readColours(glb: Glb, accessor: Gltf['accessors'][number], vertices: number): Uint8Array {
  const type = COLOUR_TYPES[accessor.componentType];
  const width = accessor.type === 'VEC4' ? 4 : 3;
  if (type === undefined) glb.fail('colours of an unknown type');
  const stride = Math.ceil((width * type.bytes) / 4) * 4;
  const bytes = detached(glb.section(accessor.bufferView, stride * vertices));
  const values = type.bytes === 1 ? new Uint8Array(bytes) : type.bytes === 2 ? new Uint16Array(bytes) : new Float32Array(bytes);
  const colours = new Uint8ClampedArray(4 * vertices).fill(255);
  for (let v = 0; v < vertices; ++v)
    for (let c = 0; c < width; ++c) colours[4 * v + c] = (255 * values[(v * stride) / type.bytes + c]) / type.most;
  return new Uint8Array(colours.buffer);
}

/// The file's own normals, in parts of 32767.
function readNormals(glb: Glb, accessor: Gltf['accessors'][number], vertices: number): Int16Array {
  if (accessor.componentType !== 5126) glb.fail('normals of an unknown type');
  const given = floats(glb.section(accessor.bufferView, 12 * vertices));
  const normals = new Int16Array(4 * vertices);
  for (let v = 0; v < vertices; ++v)
    for (let axis = 0; axis < 3; ++axis) normals[4 * v + axis] = Math.max(-32767, Math.min(32767, Math.round(32767 * given[3 * v + axis])));
  return normals;
}

function readIndices(glb: Glb, primitive: number, triangles: number, end: number): Indices {
  if (triangles === 0) return new Uint16Array(0);
  const number = glb.gltf.meshes[0].primitives[primitive]?.indices ?? -1;
  const accessor = glb.gltf.accessors[number];
  if (accessor === undefined) glb.fail('triangles are missing');
  const wide = accessor.componentType === 5125;
  const bytes = detached(glb.section(accessor.bufferView, 3 * triangles * (wide ? 4 : 2)));
  const indices = wide ? new Uint32Array(bytes) : new Uint16Array(bytes);
  for (const index of indices) if (index >= end) glb.fail('a triangle names a vertex that is not there');
  return indices;
}

/// Of copies, the vertices whose places they share.
function readCopyOf(glb: Glb, number: number, { own, ghosts, copies }: Counts): Indices {
  const places = own + ghosts;
  const wide = places > 65535;
  const bytes = detached(glb.section(number, copies * (wide ? 4 : 2)));
  const copyOf = wide ? new Uint32Array(bytes) : new Uint16Array(bytes);
  let before = 0;
  for (const place of copyOf) {
    if (place < before || place >= places) glb.fail('copies are not in order');
    before = place;
  }
  return copyOf;
}

/// Alike at all vertices of a place.
function normalsByPlace(positions: Float32Array, places: number, copyOf: Indices, interior: Indices, border: Indices): Int16Array {
  const normals = vertexNormals(positions, interior, border);
  copyOf.forEach((place, copy) => normals.copyWithin(4 * (places + copy), 4 * place, 4 * place + 4));
  return normals;
}

function checkStarts(glb: Glb, starts: Uint32Array, { neighbours, ghosts }: Counts): void {
  if (neighbours === 0 && ghosts === 0) return;
  let before = -1;
  for (const start of starts) {
    if (start <= before) glb.fail('ghosts are not in order');
    before = start;
  }
  if (starts[0] !== 0 || before !== ghosts) glb.fail('ghosts are not all there');
}

/// Interior triangles, and as much room behind them as the border triangles need.
function withRoom(interior: Indices, border: Indices): Indices {
  const wide = interior.BYTES_PER_ELEMENT === 4 || border.BYTES_PER_ELEMENT === 4;
  const all = wide ? new Uint32Array(interior.length + border.length) : new Uint16Array(interior.length + border.length);
  all.set(interior);
  return all;
}

function boxOf(glb: Glb, positions: Float32Array): number[] {
  const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    const value = positions[i];
    const axis = i % 3;
    if (value < box[axis]) box[axis] = value;
    if (value > box[3 + axis]) box[3 + axis] = value;
    if (!Number.isFinite(value)) glb.fail('a position is not finite');
  }
  return box;
}

function decode(glb: Glb, expected: ExpectedCounts | null): Tile {
  const { gltf } = glb;
  const values = gltf.extensions?.MESHHIER_tile;
  const primitive = gltf.meshes?.[0]?.primitives?.[0];
  if (values === undefined || primitive === undefined || gltf.nodes?.[0] === undefined) glb.fail('not a tile of meshhier');
  const counts = readCounts(glb, values);
  checkCounts(glb, counts, expected);
  const { own, ghosts, interior: interiorCount } = counts;
  const places = own + ghosts;
  const vertices = places + counts.copies;
  const attribute = (name: string): Gltf['accessors'][number] | undefined => gltf.accessors?.[primitive.attributes?.[name]];
  const place = attribute('POSITION') ?? glb.fail('no positions');
  const positions = readPositions(glb, place, vertices);
  const copyOf = readCopyOf(glb, values.copyOf, counts);
  const interior = readIndices(glb, values.interiorPrimitive, interiorCount, vertices);
  const border = readIndices(glb, values.borderPrimitive, counts.border, vertices);
  const surface = toPlaces(interior, places, copyOf);
  if (surface.some((place) => place >= own)) glb.fail('an interior triangle names a ghost');
  const normals = attribute('NORMAL');
  const colours = attribute('COLOR_0');
  const starts = new Uint32Array(detached(glb.section(values.ghostStarts, counts.neighbours === 0 ? 0 : 4 * (counts.neighbours + 1))));
  checkStarts(glb, starts, counts);
  const closed = counts.level === 0 && isClosed(surface);
  return {
    level: counts.level,
    index: counts.index,
    own,
    ghosts,
    copyOf,
    positions,
    normals: normals ? readNormals(glb, normals, vertices) : normalsByPlace(positions, places, copyOf, surface, toPlaces(border, places, copyOf)),
    hasNormals: normals !== undefined,
    colours: colours ? readColours(glb, colours, vertices) : null,
    indices: withRoom(interior, border),
    interiorCount,
    border,
    neighbours: new Uint32Array(detached(glb.section(values.neighbours, 4 * counts.neighbours))),
    ghostStarts: starts,
    chains: new Uint16Array(detached(glb.section(values.ghostChains, 2 * counts.chains))),
    cone: normalCone(positions, interior, border),
    closed,
    insideOut: closed && isInsideOut(positions, interior),
    box: boxOf(glb, positions),
    zUp: gltf.nodes[0].matrix !== undefined,
  };
}

/// A tile's file, out of its gzip; `expected`: null of a root of which nothing is known yet. Everything in it is checked, so that what is made of it can be used without.
export async function readTile(bytes: Uint8Array, name: string, expected: ExpectedCounts | null): Promise<Tile> {
  await MeshoptDecoder.ready;
  const glb = Glb.read(bytes, name);
  try {
    return decode(glb, expected);
  } catch (problem) {
    // JSON of another shape than a tile's, which no check above knows.
    if (problem instanceof TypeError || problem instanceof RangeError) glb.fail('its JSON is not that of a tile');
    throw problem;
  }
}

/// The arrays that a tile holds, each once: what moves when it is handed over.
export function buffersOf(tile: Tile): ArrayBuffer[] {
  const { copyOf, positions, normals, colours, indices, border, neighbours, ghostStarts, chains } = tile;
  const arrays = [copyOf, positions, normals, colours, indices, border, neighbours, ghostStarts, chains];
  return arrays.flatMap((array) => (array ? [array.buffer as ArrayBuffer] : []));
}
