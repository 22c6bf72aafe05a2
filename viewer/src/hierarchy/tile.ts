// A tile as it is drawn: what its file (docs/file_format.md, section 4) holds for that, in arrays of its own.
import { Glb } from './glb.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { MOST_ELEMENTS, MOST_OWN, MOST_ROOT_TRIANGLES, mostSplits } from './limits.js';
import { normalCone, vertexNormals, type Cone } from './normals.js';
import { toPlaces, unsplitOf, type Places } from './copies.js';
import { isClosed, isInsideOut } from './closed.js';
import { detached, readColours, readNormals, readPositions, type Accessor, type Normals } from './vertex_values.js';

export type Indices = Uint16Array | Uint32Array;

/// Who made the normals. The viewer makes them from the triangles where the file has none, and those of ghosts are not right:
/// the tile that owns the vertex knows.
export type NormalSource = 'input' | 'build' | 'viewer';

/// Vertices 0 … own - 1 are the tile's; behind them its ghosts, then copies: further vertices at places of these; then splits:
/// any of these once more, with another normal. All positions are exact.
export interface Tile extends Places {
  readonly level: number;
  readonly index: number;
  /// x, y, z of each vertex, relative to the place that all tiles of a hierarchy share.
  readonly positions: Float32Array;
  readonly normals: Normals;
  readonly normalsFrom: NormalSource;
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
  readonly splits: number;
  readonly interior: number;
  readonly border: number;
}

const VERSION = 2;
/// Tiles without computed normals need not say so.
const NO_SPLITS = { splitCount: 0, splitOf: -1 };

interface Counts extends ExpectedCounts {
  readonly neighbours: number;
  readonly chains: number;
}

/// Before anything is sized by them.
function checkCounts(glb: Glb, counts: Counts, expected: ExpectedCounts | null): void {
  const keys = ['level', 'index', 'own', 'ghosts', 'copies', 'splits', 'interior', 'border'] as const;
  if (expected !== null && keys.some((key) => counts[key] !== expected[key])) glb.fail('not the tile that the index tells of');
  if (counts.level === 0 && (counts.ghosts > 0 || counts.border > 0 || counts.interior > MOST_ROOT_TRIANGLES)) glb.fail('not a root');
  if (counts.neighbours > counts.ghosts || counts.chains > counts.ghosts * counts.level) glb.fail('more neighbours or chains than ghosts allow');
  if (counts.splits > mostSplits(counts)) glb.fail('more splits than corners of triangles');
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
    splits: count(glb, values, 'splitCount', 0, MOST_ELEMENTS),
    neighbours: count(glb, values, 'neighbourCount', 0, MOST_ELEMENTS),
    chains: count(glb, values, 'chainEntryCount', 0, MOST_ELEMENTS),
    interior: count(glb, values, 'interiorCount', 0, MOST_ELEMENTS),
    border: count(glb, values, 'borderCount', 0, MOST_ELEMENTS),
  };
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

/// Of further vertices those that they repeat, below `end`; `what`: they are called.
function readRepeated(glb: Glb, number: number, length: number, end: number, what: string): Indices {
  const wide = end > 65535;
  const bytes = detached(glb.section(number, length * (wide ? 4 : 2)));
  const repeated = wide ? new Uint32Array(bytes) : new Uint16Array(bytes);
  let before = 0;
  for (const vertex of repeated) {
    if (vertex < before || vertex >= end) glb.fail(`${what} are not in order`);
    before = vertex;
  }
  return repeated;
}

function readPlaces(glb: Glb, values: Record<string, number>, { own, ghosts, copies, splits }: Counts): Places {
  const copyOf = readRepeated(glb, values.copyOf, copies, own + ghosts, 'copies');
  return { own, ghosts, copyOf, splitOf: readRepeated(glb, values.splitOf, splits, own + ghosts + copies, 'splits') };
}

/// A split has the values of its vertex, `width` each.
function checkSplits(glb: Glb, places: Places, values: Float32Array | Uint8Array, width: number): void {
  const unsplit = unsplitOf(places);
  places.splitOf.forEach((vertex, split) => {
    for (let k = 0; k < width; ++k)
      if (values[width * (unsplit + split) + k] !== values[width * vertex + k]) glb.fail('a split differs from its vertex by more than the normal');
  });
}

/// Alike at all vertices of a place; triangles of places.
function normalsByPlace(positions: Float32Array, { own, ghosts, copyOf }: Places, interior: Indices, border: Indices): Normals {
  const normals = vertexNormals(positions, interior, border);
  const places = own + ghosts;
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
  const extension = gltf.extensions?.MESHHIER_tile;
  const primitive = gltf.meshes?.[0]?.primitives?.[0];
  if (extension === undefined || primitive === undefined || gltf.nodes?.[0] === undefined) glb.fail('not a tile of meshhier');
  const values: Record<string, number> = { ...NO_SPLITS, ...extension };
  const counts = readCounts(glb, values);
  checkCounts(glb, counts, expected);
  const places = readPlaces(glb, values, counts);
  const vertices = unsplitOf(places) + counts.splits;
  const attribute = (name: string): Accessor | undefined => gltf.accessors?.[primitive.attributes?.[name]];
  const positions = readPositions(glb, attribute('POSITION') ?? glb.fail('no positions'), vertices);
  const interior = readIndices(glb, values.interiorPrimitive, counts.interior, vertices);
  const border = readIndices(glb, values.borderPrimitive, counts.border, vertices);
  const surface = toPlaces(places, interior);
  if (surface.some((place) => place >= counts.own)) glb.fail('an interior triangle names a ghost');
  const given = attribute('NORMAL');
  const normals = given ? readNormals(glb, given, vertices) : normalsByPlace(positions, places, surface, toPlaces(places, border));
  const colour = attribute('COLOR_0');
  const colours = colour ? readColours(glb, colour, vertices) : null;
  const normalsFrom = given === undefined ? 'viewer' : normals instanceof Int8Array ? 'build' : 'input';
  if (counts.splits > 0 && normalsFrom !== 'build') glb.fail('splits without computed normals');
  checkSplits(glb, places, positions, 3);
  if (colours) checkSplits(glb, places, colours, 4);
  const starts = new Uint32Array(detached(glb.section(values.ghostStarts, counts.neighbours === 0 ? 0 : 4 * (counts.neighbours + 1))));
  checkStarts(glb, starts, counts);
  const closed = counts.level === 0 && isClosed(surface);
  return {
    level: counts.level,
    index: counts.index,
    ...places,
    positions,
    normals,
    normalsFrom,
    colours,
    indices: withRoom(interior, border),
    interiorCount: counts.interior,
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
  const { copyOf, splitOf, positions, normals, colours, indices, border, neighbours, ghostStarts, chains } = tile;
  const arrays = [copyOf, splitOf, positions, normals, colours, indices, border, neighbours, ghostStarts, chains];
  return arrays.flatMap((array) => (array ? [array.buffer as ArrayBuffer] : []));
}
