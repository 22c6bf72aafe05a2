// SPDX-License-Identifier: MIT
// A tile as it is drawn: what its file (docs/file_format.md, section 4) holds for that, in arrays of its own.
import { readFirstView, type FirstView } from './first_view.js';
import { Glb } from './glb.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { normalCone, vertexNormals, type Cone } from './normals.js';
import { decodePicture, dropPicture, findPicture, partsOfPicture, type Picture } from './picture.js';
import { placeOf, toPlaces, unsplitOf, type Indices, type TilePlaces } from './copies.js';
import { isClosed, isInsideOut } from './closed.js';
import { readCounts, withAbsent, type TileCounts, type ExpectedCounts, type TileValues } from './tile_counts.js';
import { readScalarValues } from './scalar_values.js';
import { detached, readColours, readMapTexcoords, readNormals, readPositions, readTangents, readTexcoords, type Accessor, type Normals } from './vertex_values.js';

/// Who made the normals. The viewer makes them from the triangles where the file has none, and those of ghosts are not right:
/// the tile that owns the vertex knows.
export type NormalSource = 'input' | 'build' | 'viewer';

/// Vertices 0 … own - 1 are the tile's; behind them its ghosts, then copies: further vertices at places of these; then splits:
/// any of these once more, with another normal or texture coordinate. All positions are exact.
export interface Tile extends TilePlaces {
  readonly level: number;
  readonly index: number;
  /// x, y, z of each vertex, relative to the place that all tiles of a hierarchy share.
  readonly positions: Float32Array;
  readonly normals: Normals;
  readonly normalsFrom: NormalSource;
  /// r, g, b, a of each vertex as in the input (not linear); or null.
  readonly colours: Uint8Array | null;
  /// The picture's light is multiplied by that of the colours; else they are seen without it alone.
  readonly coloursTint: boolean;
  /// All values of each vertex, in the manifest's order; or null.
  readonly values: Float32Array | null;
  /// u, v of each vertex in the picture and the normal map; none without. Whoever drops the tile lets go of the picture: see letGo().
  readonly texcoords: Float32Array | null;
  readonly picture: Picture | null;
  /// Beside the picture it has the same sides. A root that is drawn before its map has come has the tangents alone, other tiles both or neither.
  readonly normalMap: Picture | null;
  readonly tangents: Int8Array | null;
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
  /// The root alone knows it: the mesh has no open border; and if so, whether its triangles show their backs.
  readonly closed: boolean;
  readonly insideOut: boolean;
  /// x, y, z smallest, then largest, of all vertices.
  readonly box: readonly number[];
  /// The mesh lies with its z axis up.
  readonly zUp: boolean;
  /// The root alone has it; null: an older program made it.
  readonly firstView: FirstView | null;
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

/// Reads which vertices, below `end`, further ones repeat. `what`: these are called so.
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

function readPlaces(glb: Glb, values: TileValues, { own, ghosts, copies, splits }: TileCounts): TilePlaces {
  const copyOf = readRepeated(glb, values.copyOf, copies, own + ghosts, 'copies');
  return { own, ghosts, copyOf, splitOf: readRepeated(glb, values.splitOf, splits, own + ghosts + copies, 'splits') };
}

/// A split has the values of its vertex, `width` each.
function checkSplits(glb: Glb, places: TilePlaces, values: Float32Array | Uint8Array | Normals, width: number): void {
  const unsplit = unsplitOf(places);
  places.splitOf.forEach((vertex, split) => {
    for (let k = 0; k < width; ++k)
      if (values[width * (unsplit + split) + k] !== values[width * vertex + k]) glb.fail('a split differs from its vertex by more than the build may');
  });
}

/// Alike at all vertices of a place; triangles of places.
function normalsByPlace(positions: Float32Array, of: TilePlaces, interior: Indices, border: Indices): Normals {
  const normals = vertexNormals(positions, interior, border);
  for (let vertex = of.own + of.ghosts; 4 * vertex < normals.length; ++vertex) {
    const place = placeOf(of, vertex);
    normals.copyWithin(4 * vertex, 4 * place, 4 * place + 4);
  }
  return normals;
}

function checkStarts(glb: Glb, starts: Uint32Array, { neighbours, ghosts }: TileCounts): void {
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

/// Reads the texture coordinates of the tile's picture, which are those of its normal map, too; or of the map alone.
function texcoordsOf(glb: Glb, attribute: (name: string) => Accessor | undefined, { hasPicture, hasNormalMap }: TileCounts, vertices: number): Float32Array | null {
  if (!hasPicture && !hasNormalMap) return null;
  const set = hasPicture ? 0 : (glb.gltf.materials?.[0]?.normalTexture?.texCoord ?? 0);
  const accessor = attribute(`TEXCOORD_${set}`) ?? glb.fail('a picture without texture coordinates');
  return hasPicture ? readTexcoords(glb, accessor, vertices) : readMapTexcoords(glb, accessor, vertices);
}

/// All but the picture and the normal map.
function decode(glb: Glb, values: TileValues, counts: TileCounts): Omit<Tile, 'picture' | 'normalMap'> {
  const { gltf } = glb;
  const primitive = gltf.meshes?.[0]?.primitives?.[0];
  if (primitive === undefined || gltf.nodes?.[0] === undefined) glb.fail('not a tile of meshhier');
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
  const colour = attribute('COLOR_0') ?? attribute('_COLOR_0');
  const colours = colour ? readColours(glb, colour, vertices, counts.screenColours) : null;
  const scalars = readScalarValues(glb, values.values, vertices);
  const normalsFrom = given === undefined ? 'viewer' : normals instanceof Int8Array ? 'build' : 'input';
  const texcoords = texcoordsOf(glb, attribute, counts, vertices);
  const tangents = counts.hasNormalMap ? readTangents(glb, attribute('TANGENT') ?? glb.fail('a normal map without tangents'), vertices) : null;
  if (counts.splits > 0 && normalsFrom !== 'build' && !texcoords) glb.fail('splits without computed normals or a picture');
  checkSplits(glb, places, positions, 3);
  if (colours) checkSplits(glb, places, colours, 4);
  if (scalars) checkSplits(glb, places, scalars, scalars.length / vertices);
  if (normalsFrom === 'input') checkSplits(glb, places, normals, 4);
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
    values: scalars,
    coloursTint: counts.hasPicture && attribute('COLOR_0') !== undefined,
    texcoords,
    tangents,
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
    firstView: readFirstView(gltf, () => glb.fail('its first view is none')),
  };
}

async function readImage(glb: Glb, number: number, { pictureWidth: width, pictureHeight: height }: TileCounts): Promise<Picture> {
  return decodePicture(glb, findPicture(glb, number, { width, height }));
}

async function readWhole(glb: Glb, expected: ExpectedCounts | null, isBeginning: boolean): Promise<Tile> {
  const extension = glb.gltf.extensions?.MESHHIER_tile;
  if (extension === undefined) glb.fail('not a tile of meshhier');
  const values = withAbsent(extension);
  const counts = readCounts(glb, values, expected);
  const tile = decode(glb, values, counts);
  const { hasPicture, hasNormalMap } = counts;
  const picture = hasPicture ? await readImage(glb, values.image, counts) : null;
  try {
    return { ...tile, picture, normalMap: hasNormalMap && !isBeginning ? await readImage(glb, values.normalMap, counts) : null };
  } catch (problem) {
    if (picture) dropPicture(picture);
    throw problem;
  }
}

/// A tile's file, out of its gzip; `expected`: null of a root of which nothing is known yet. Everything in it is checked, so that what is made of it can be used without.
/// `isBeginning`: but for its normal map, which has not come yet.
export async function readTile(bytes: Uint8Array, name: string, expected: ExpectedCounts | null, isBeginning = false): Promise<Tile> {
  await MeshoptDecoder.ready;
  const glb = Glb.read(bytes, name);
  try {
    return await readWhole(glb, expected, isBeginning);
  } catch (problem) {
    // JSON of another shape than a tile's, which no check above knows.
    if (problem instanceof TypeError || problem instanceof RangeError) glb.fail('its JSON is not that of a tile');
    throw problem;
  }
}

/// Returns the buffers and pictures that a tile holds, each once: they move when it is handed over.
export function partsOf(tile: Tile): Transferable[] {
  const { copyOf, splitOf, positions, normals, colours, values, texcoords, tangents, picture, normalMap, indices, border, neighbours, ghostStarts, chains } = tile;
  const arrays = [copyOf, splitOf, positions, normals, colours, values, texcoords, tangents, indices, border, neighbours, ghostStarts, chains];
  const buffers = arrays.flatMap((array) => (array ? [array.buffer as ArrayBuffer] : []));
  return [...buffers, ...[picture, normalMap].flatMap((each) => (each ? partsOfPicture(each) : []))];
}
