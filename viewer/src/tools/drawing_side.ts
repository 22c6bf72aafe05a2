// SPDX-License-Identifier: MIT
// The sides from which a model is drawn: the plan, from above with its front below, and four elevations.
import { Vector3, type Matrix4 } from 'three';
import { CameraPose } from '../scene/camera_pose.js';
import { axesOf } from '../scene/framing.js';
import { heightAt } from '../scene/projection.js';
import type { DrawingFrame } from './line_drawing.js';
import { SIDES } from './orientation.js';
import type { Extent, Flat, PaperAxis } from './paper.js';
import { localNormal } from './planes.js';
import { dot, scale, type Vector } from './vectors.js';

export type DrawingSide = 'plan' | 'front' | 'back' | 'left' | 'right';
export const DRAWING_SIDES: readonly DrawingSide[] = ['plan', 'front', 'right', 'back', 'left'];

const NAMES = ['x', 'y', 'z'];

/// To the viewer, in the world.
export function directionOf(side: DrawingSide): Vector {
  return SIDES[side === 'plan' ? 'top' : side];
}

/// To the right, up and to the viewer, in the world.
function worldAxes(side: DrawingSide): readonly [Vector3, Vector3, Vector3] {
  const towards = new Vector3(...directionOf(side));
  const { right, up } = axesOf(towards.clone().negate());
  return [right, up, towards];
}

/// In the input's coordinates, in which lengths are true; `matrix` brings the tiles' into the world.
export function frameOf(side: DrawingSide, matrix: Readonly<Matrix4>): DrawingFrame {
  const [right, up, towards] = worldAxes(side).map((axis): Vector => {
    const [x, y, z] = localNormal(axis.toArray(), matrix);
    return [x + 0, y + 0, z + 0];
  });
  return [right, up, towards];
}

/// The same as the picture shows it: heights may be stretched.
export function stretchedFrame(side: DrawingSide, frame: DrawingFrame, stretch: number): DrawingFrame {
  return side === 'plan' ? frame : [frame[0], scale(frame[1], stretch), frame[2]];
}

/// Which of the input's axes an axis of the drawing is.
export function paperAxis(axis: Vector, stretch = 1): PaperAxis {
  const along = axis.findIndex((value) => Math.abs(value) > 0.5);
  return { name: NAMES[along], sign: Math.sign(axis[along]), stretch };
}

/// The range of a box along a direction.
export function rangeAlong({ min, max }: { readonly min: Vector; readonly max: Vector }, axis: Vector): readonly [least: number, most: number] {
  const ends = axis.map((part, k) => [part * min[k], part * max[k]]);
  return [ends.reduce((sum, pair) => sum + Math.min(...pair), 0), ends.reduce((sum, pair) => sum + Math.max(...pair), 0)];
}

/// All of a box, in the drawing's coordinates.
export function extentOf(box: { readonly min: Vector; readonly max: Vector }, [rightAxis, upAxis]: DrawingFrame): Extent {
  const [[left, right], [bottom, top]] = [rangeAlong(box, rightAxis), rangeAlong(box, upAxis)];
  return { left, right, bottom, top };
}

/// The camera of parallel rays that has a place of the drawing in the middle of a picture of that height. `frame`: as the picture shows it.
/// `origin`: of the tiles' coordinates, in the input's. `angle`: that the camera sees in perspective.
export function poseFor(side: DrawingSide, middle: Flat, height: number, frame: DrawingFrame, origin: Vector, angle: number): CameraPose {
  const [right, up, towards] = worldAxes(side);
  const target = right.multiplyScalar(middle[0] - dot(frame[0], origin)).addScaledVector(up, middle[1] - dot(frame[1], origin));
  return new CameraPose(target.clone().addScaledVector(towards, height / heightAt(1, angle)), target);
}

/// The place of the drawing where a point of the world is.
export function drawnPlace(side: DrawingSide, point: Vector3, frame: DrawingFrame, origin: Vector): Flat {
  const [right, up] = worldAxes(side);
  return [point.dot(right) + dot(frame[0], origin), point.dot(up) + dot(frame[1], origin)];
}
