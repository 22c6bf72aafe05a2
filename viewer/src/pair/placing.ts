// SPDX-License-Identifier: MIT
// Where a second model lies beside the first one: both in one frame of coordinates, in double precision.
//
//     tiles of b  --+ origin-->  input of b  --laying-->  input of a  -- - origin-->  tiles of a  --upright-->  world
//
// Laying is the way over the earth where both have a place on it; else coordinates are the same, but for the unit and the axis
// that is up, where the files say different ones.
import { Box3, Matrix4, Vector3 } from 'three';
import type { Manifest } from '../hierarchy/manifest.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { uprightRows, type Standing } from '../scene/standing.js';
import { unitOfModel, UNITS } from '../tools/units.js';
import type { Vector } from '../tools/vectors.js';

/// How the second model's coordinates become the first one's.
export interface Laying {
  /// From the second input's coordinates to the first one's.
  readonly matrix: Matrix4;
  /// `earth`: both have a place on it. `alone`: only one has, and the coordinates are taken as they are.
  readonly by: 'coordinates' | 'earth' | 'alone';
  /// Units of the first model for one of the second's; 1 where either is not known.
  readonly factor: number;
  /// The files say different axes are up, and both stand upright.
  readonly isTurned: boolean;
}

/// In these parts of each other's size boxes are laid on each other without making either larger.
const LIKE = 4;

function matrixOf(rows: readonly Vector[]): Matrix4 {
  const [[a, b, c], [d, e, f], [g, h, i]] = rows;
  return new Matrix4().set(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1);
}

function uprightOf(standing: Standing, { up }: Pick<Manifest, 'up'>): Matrix4 {
  return matrixOf(uprightRows(standing, up === 'z'));
}

/// 3D Tiles has z up, whatever the file has.
function toGlobeAxes({ up }: Pick<Manifest, 'up'>): Matrix4 {
  return up === 'z' ? new Matrix4() : matrixOf([[1, 0, 0], [0, 0, -1], [0, 1, 0]]);
}

function moved([x, y, z]: Vector): Matrix4 {
  return new Matrix4().makeTranslation(x, y, z);
}

function isSame(one: readonly number[], other: readonly number[]): boolean {
  return one.every((value, i) => value === other[i]);
}

function metresOf(manifest: Manifest): number | null {
  const unit = unitOfModel(manifest);
  return unit === null ? null : UNITS[unit].metres;
}

function overEarth(first: Manifest, second: Manifest, one: readonly number[], other: readonly number[]): Matrix4 {
  const between = isSame(one, other) ? new Matrix4() : new Matrix4().fromArray([...one]).invert().multiply(new Matrix4().fromArray([...other]));
  return toGlobeAxes(first).transpose().multiply(between).multiply(toGlobeAxes(second));
}

/// `standing`: of both. One that is chosen turns both alike, whatever their files say.
export function layingOf(first: Manifest, second: Manifest, standing: Standing): Laying {
  if (first.transform !== null && second.transform !== null)
    return { matrix: overEarth(first, second, first.transform, second.transform), by: 'earth', factor: 1, isTurned: false };
  const [one, other] = [metresOf(first), metresOf(second)];
  const factor = one === null || other === null ? 1 : other / one;
  const isTurned = standing.up === 'file' && first.up !== second.up;
  const matrix = new Matrix4();
  if (isTurned) matrix.copy(uprightOf({ ...standing, stretch: 1 }, first).transpose()).multiply(uprightOf({ ...standing, stretch: 1 }, second));
  if (factor !== 1) matrix.premultiply(new Matrix4().makeScale(factor, factor, factor));
  return { matrix, by: first.transform === null && second.transform === null ? 'coordinates' : 'alone', factor, isTurned };
}

function middleOf({ origin, place }: Manifest): Vector {
  return [origin[0] + place[0], origin[1] + place[1], origin[2] + place[2]];
}

/// Brings the coordinates of the second view's group into the world, in which the first one stands as `world` says.
export function groupMatrix(first: Manifest, second: Manifest, laying: Laying, standing: Standing, world: Readonly<Matrix4>): Matrix4 {
  return new Matrix4().copy(world).multiply(uprightOf(standing, first))
    .multiply(tilesMatrix(first, second, laying))
    .multiply(uprightOf(standing, second).invert());
}

/// Laid so, the middles of both boxes are one; where one is many times as large, it is made as large as the other.
export function alignedMatrix(first: Box3, second: Box3): Matrix4 {
  const [one, other] = [first, second].map((box) => ({ middle: box.getCenter(new Vector3()), size: box.getSize(new Vector3()).length() || 1 }));
  const ratio = one.size / other.size;
  const factor = ratio > LIKE || ratio < 1 / LIKE ? ratio : 1;
  const { x, y, z } = other.middle;
  return new Matrix4().makeTranslation(one.middle).scale(new Vector3(factor, factor, factor)).multiply(moved([-x, -y, -z]));
}

/// The model's box in the world.
export function worldBox(view: Pick<HierarchyView, 'box' | 'matrixWorld'>): Box3 {
  return view.box.clone().applyMatrix4(view.matrixWorld);
}

/// From the second view's tiles to the first one's.
export function tilesMatrix(first: Manifest, second: Manifest, laying: Laying): Matrix4 {
  const [from, [x, y, z]] = [middleOf(second), middleOf(first)];
  return moved([-x, -y, -z]).multiply(laying.matrix).multiply(moved(from));
}
