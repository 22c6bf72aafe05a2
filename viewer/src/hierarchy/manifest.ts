// SPDX-License-Identifier: MIT
// The manifest, hierarchy.json (docs/file_format.md, section 2): what a viewer needs of it, checked.
import { JsonValue, type Fail } from '../json_value.js';
import { readView } from '../view/view_json.js';
import type { View } from '../view/view_table.js';
import { COMPRESSIONS, COMPRESSION_NAMES } from './bytes.js';
import { HierarchyProblem } from './problem.js';
import { readObjectFacts, type ObjectFacts } from './object_facts.js';
import { readScalarAttributes, type ScalarAttribute } from './scalar_values.js';
import { FORMATS } from './formats.js';
import { MANIFEST, MOST_MANIFEST_BYTES } from './manifest_file.js';
import { whole, type RemoteFiles } from './files.js';
import { TILES_A_DIRECTORY } from './tree.js';
import { indexSize } from './tile_index.js';

export const MANIFEST_UNITS = ['mm', 'cm', 'm', 'km', 'in', 'ft', 'us_ft'] as const;

export interface Manifest {
  readonly source: {
    readonly fileName: string;
    readonly fileBytes: number;
    readonly vertices: number;
    readonly triangles: number;
    readonly hasColours: boolean;
    readonly hasNormals: boolean;
    /// Attributes that vertices have besides.
    readonly values: readonly ScalarAttribute[];
    /// Its pictures, and those of them that were not there; null: the mesh is not textured.
    readonly textures: { readonly images: number; readonly missingImages: number } | null;
    /// In input coordinates.
    readonly min: readonly [number, number, number];
    readonly max: readonly [number, number, number];
    /// Its coordinates did not fit 32-bit floats: what is stored is rounded, relative to the origin.
    readonly doublePrecision: boolean;
  };
  /// Add to stored positions for input coordinates.
  readonly origin: readonly [number, number, number];
  /// Positions of decoded tiles are relative to this place, which is relative to the origin: not 0 on a lattice of 16-bit numbers.
  readonly place: readonly [number, number, number];
  /// The largest distance that a position was moved to the lattice of a quantized hierarchy; 0 of others.
  readonly worstRounding: number;
  readonly up: 'y' | 'z';
  /// The unit of the input's lengths, as the manifest names it; null: not known.
  readonly units: (typeof MANIFEST_UNITS)[number] | null;
  /// 4 x 4, column by column: from 3D Tiles' coordinates, z up, to the earth's; null: the model has no place.
  readonly transform: readonly number[] | null;
  readonly licence: string;
  readonly partitions: number;
  readonly totalBytes: number;
  /// Tiles above the partitions may have normal maps.
  readonly hasNormalMaps: boolean;
  /// Tiles are stored in gzip.
  readonly packedTiles: boolean;
  readonly index: NamedFile;
  readonly outline: NamedFile;
  /// The model's picture; null: it has none.
  readonly preview: NamedFile | null;
  /// What is known of the model's objects; null: it has none.
  readonly objects: ObjectFacts | null;
  /// How the model is seen first; what is undefined in it is not said.
  readonly view: View;
  /// The name of the build: its own checksum, which covers that of the index, which covers those of all tiles.
  readonly build: string;
}

/// A file of a hierarchy that its manifest names.
export interface NamedFile {
  readonly file: string;
  readonly bytes: number;
  /// XXH3-64.
  readonly checksum: bigint;
}

const FORMAT_VERSION = 14; // 13: the same without objects; 12: and without tiles that have both a picture and a normal map; 11: with another tileset; 10: and without KTX2; 9: and without normal maps; 8: and without values; 7: tiles hold colours as screens have them
const OLDEST_VERSION = 6; // that without a first view
const MOST_PREVIEW_BYTES = 40_000;

const MOST_SHORT_BITS = 16;

function readPlace(positions: JsonValue): [number, number, number] {
  if (positions.isNull() || positions.at('bits').count(8, 24) > MOST_SHORT_BITS) return [0, 0, 0];
  return positions.at('corner').triple();
}

function readTransform(value: JsonValue): readonly number[] | null {
  return value.isNull() ? null : value.numbers(16);
}

/// With how they are stored, which is there if and only if they are.
function readTextures(source: JsonValue, storage: JsonValue): Manifest['source']['textures'] {
  if (!source.has('textures') && !storage.has('texture')) return null;
  storage.at('texture').at('format').oneOf(...FORMATS.pictures.map(({ name }) => name));
  const textures = source.at('textures');
  const images = textures.at('images').count();
  return { images, missingImages: textures.at('missing_images').count(0, images) };
}

function readSource(source: JsonValue, storage: JsonValue): Manifest['source'] {
  const attributes = source.at('attributes');
  return {
    fileName: source.at('file_name').text(),
    fileBytes: source.at('file_bytes').number(),
    vertices: source.at('vertices').count(1, 2 ** 32 - 1),
    triangles: source.at('triangles').count(),
    hasColours: attributes.at('colours').oneOf('none', 'u8', 'u16', 'f32') !== 'none',
    hasNormals: attributes.at('normals').flag(),
    values: readScalarAttributes(source),
    textures: readTextures(source, storage),
    min: source.at('bounds').at('min').triple(),
    max: source.at('bounds').at('max').triple(),
    doublePrecision: source.at('double_precision').flag(),
  };
}

function readFile(file: JsonValue, leastBytes: number, mostBytes: number): NamedFile {
  return { file: file.at('file').fileName(), bytes: file.at('bytes').count(leastBytes, mostBytes), checksum: BigInt(`0x${file.at('checksum').checksum()}`) };
}

/// Reads a manifest. Throws HierarchyProblem for what is none.
export function readManifest(text: string): Manifest {
  const refuse: Fail = (what) => {
    throw new HierarchyProblem(MANIFEST, what);
  };
  const root = JsonValue.parse(text, refuse);
  root.at('format').oneOf('meshhier');
  const version = root.at('format_version').count();
  if (version < OLDEST_VERSION) refuse(`format version ${version}, made by an older meshhier: build the hierarchy again`);
  if (version > FORMAT_VERSION) refuse(`format version ${version}; this viewer knows ${FORMAT_VERSION}`);
  const partitions = root.at('partitions').count(1, 2 ** 32 - 1);
  if (version === OLDEST_VERSION && partitions > TILES_A_DIRECTORY) refuse(`format version ${version} has its tiles elsewhere: build the hierarchy again`);
  const indexBytes = indexSize(2 * partitions - 1);
  const positions = root.at('storage').at('positions');
  return {
    source: readSource(root.at('source'), root.at('storage')),
    origin: root.at('origin').triple(),
    place: readPlace(positions),
    worstRounding: positions.isNull() ? 0 : positions.at('worst_rounding').number(),
    up: root.at('up').oneOf('y', 'z'),
    units: root.has('units') ? root.at('units').oneOf(...MANIFEST_UNITS) : null,
    transform: readTransform(root.at('transform')),
    licence: root.at('licence').text(),
    partitions,
    totalBytes: root.at('total_bytes').count(),
    index: readFile(root.at('index'), indexBytes, indexBytes),
    outline: readFile(root.at('outline'), 1, 2 ** 32 - 1),
    preview: root.has('preview') ? readFile(root.at('preview'), 1, MOST_PREVIEW_BYTES) : null,
    objects: root.has('objects') ? readObjectFacts(root.at('objects')) : null,
    view: root.has('view') ? readView(root.at('view')) : {},
    build: root.at('checksum').checksum(),
    hasNormalMaps: root.at('storage').has('normal_map'),
    packedTiles: COMPRESSIONS[root.at('storage').at('compression').oneOf(...COMPRESSION_NAMES)],
  };
}

/// From no cache. Throws HierarchyProblem, and what ends `signal`.
export async function fetchManifest(files: RemoteFiles, signal: AbortSignal): Promise<Manifest> {
  const isHeld = files.holds?.(MANIFEST) ?? false;
  return parsed(await (isHeld ? whole(files, MANIFEST, MOST_MANIFEST_BYTES, { signal }) : files.manifestNow(signal)));
}

/// That of the host. Throws as fetchManifest().
export async function fetchHostManifest(files: RemoteFiles, signal: AbortSignal): Promise<Manifest> {
  return parsed(await files.manifestNow(signal));
}

function parsed(bytes: Uint8Array): Manifest {
  return readManifest(new TextDecoder().decode(bytes));
}
