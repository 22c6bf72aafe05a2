// SPDX-License-Identifier: MIT
// The counts of a tile (docs/file_format.md, section 4.4), checked before anything is sized by them.
import type { Glb } from './glb.js';
import { MOST_ELEMENTS, MOST_OWN, MOST_ROOT_TRIANGLES, MOST_SIDE, mostSplits } from './limits.js';
import type { TileRecord } from './tile_index.js';
import type { Node } from './tree.js';

const KEYS = ['level', 'index', 'own', 'ghosts', 'copies', 'splits', 'interior', 'border', 'pictureWidth', 'pictureHeight', 'hasNormalMap'] as const;

/// The index says this of a tile.
export type ExpectedCounts = Pick<Node & TileRecord, (typeof KEYS)[number]>;

export interface TileCounts extends ExpectedCounts {
  /// Colours are values of a screen; else they are light, as glTF has it.
  readonly screenColours: boolean;
  readonly hasPicture: boolean;
  readonly neighbours: number;
  readonly chains: number;
}

const VERSION = 7;
const NO_OBJECTS_VERSION = 6; // the same without a table of objects
const NO_MAPS_VERSION = 5; // the same in hierarchies without normal maps
const NO_VALUES_VERSION = 4; // the same without values
const SCREEN_COLOURS_VERSION = 3; // the same with colours as screens have them
/// Tiles without splits, pictures, values or normal maps need not say these.
const ABSENT = { splitCount: 0, splitOf: -1, imageWidth: 0, imageHeight: 0, image: -1, values: -1, normalMapWidth: 0, normalMapHeight: 0, normalMap: -1 };

/// MESHHIER_tile.
export type TileValues = Record<string, number>;

export function withAbsent(extension: TileValues): TileValues {
  return { ...ABSENT, ...extension };
}

function count(glb: Glb, values: TileValues, key: string, least: number, most: number): number {
  const value = values[key];
  if (!Number.isInteger(value) || value < least || value > most) glb.fail(`"${key}" is not from ${least} to ${most}`);
  return value;
}

function parse(glb: Glb, values: TileValues): TileCounts {
  const screenColours = values.version === SCREEN_COLOURS_VERSION;
  const isKnown = [VERSION, NO_OBJECTS_VERSION, NO_MAPS_VERSION, NO_VALUES_VERSION, SCREEN_COLOURS_VERSION].includes(values.version);
  if (!isKnown) glb.fail(`version ${values.version} of MESHHIER_tile is not known; this viewer knows ${VERSION}`);
  const side = (key: string): number => count(glb, values, key, 0, MOST_SIDE);
  const [picture, map] = [{ width: side('imageWidth'), height: side('imageHeight') }, { width: side('normalMapWidth'), height: side('normalMapHeight') }];
  const [hasPicture, hasNormalMap] = [picture, map].map(({ width }) => width > 0);
  if (hasPicture && hasNormalMap && (picture.width !== map.width || picture.height !== map.height)) glb.fail('its picture and its normal map have different sides');
  const { width: pictureWidth, height: pictureHeight } = hasNormalMap ? map : picture;
  return {
    screenColours,
    hasPicture,
    hasNormalMap,
    pictureWidth,
    pictureHeight,
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

function check(glb: Glb, counts: TileCounts, expected: ExpectedCounts | null): void {
  if (expected !== null && KEYS.some((key) => counts[key] !== expected[key])) glb.fail('not the tile that the index tells of');
  if (counts.level === 0 && (counts.ghosts > 0 || counts.border > 0 || counts.interior > MOST_ROOT_TRIANGLES)) glb.fail('not a root');
  if (counts.neighbours > counts.ghosts || counts.chains > counts.ghosts * counts.level) glb.fail('more neighbours or chains than ghosts allow');
  if (counts.splits > mostSplits(counts)) glb.fail('more splits than corners of triangles');
  if ((counts.pictureWidth === 0) !== (counts.pictureHeight === 0)) glb.fail('a picture with one side only');
}

/// `expected`: null of a root of which nothing is known yet.
export function readCounts(glb: Glb, values: TileValues, expected: ExpectedCounts | null): TileCounts {
  const counts = parse(glb, values);
  check(glb, counts, expected);
  return counts;
}
