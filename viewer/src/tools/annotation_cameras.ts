// SPDX-License-Identifier: MIT
// Cameras of IIIF's scenes: at the point of their target, looking along their negative z axis, however a resource turns it, or at something.
import type { Fail, JsonValue } from '../json_value.js';
import { bodiesOf, labelOf, shortened, type Body, type Languages } from './annotation_bodies.js';
import { axesOf, idOf, isOfType, pointOf, targetOf } from './annotation_points.js';
import type { SeenFrom } from './note.js';
import { add, distanceOf, length, scale, subtract, unit, type Vector } from './vectors.js';

/// How what a camera sees is shown: a property of this program's own.
export const CHOICES = 'meshhier:choices';

export interface Camera {
  readonly id: string;
  readonly name: string;
  /// How it sees; `at`: the point that it is to look at or beside, null: none is known.
  readonly seen: (at: Vector | null) => SeenFrom;
}

const RADIANS = Math.PI / 180;

/// In the plane of two axes, from the first to the second.
function turned(point: Vector, from: number, to: number, degrees: number): Vector {
  const [cos, sin] = [Math.cos(degrees * RADIANS), Math.sin(degrees * RADIANS)];
  return point.map((value, axis) => (axis === from ? cos * point[from] - sin * point[to] : axis === to ? sin * point[from] + cos * point[to] : value)) as unknown as Vector;
}

/// Around the axes that the turns before have left: x, then y, then z.
function rotated(point: Vector, [x, y, z]: Vector): Vector {
  return turned(turned(turned(point, 0, 1, z), 2, 0, y), 1, 2, x);
}

function transformed(point: Vector, transform: JsonValue): Vector {
  if (isOfType(transform, 'RotateTransform')) return rotated(point, axesOf(transform, 0));
  if (isOfType(transform, 'TranslateTransform')) return add(point, axesOf(transform, 0));
  if (!isOfType(transform, 'ScaleTransform')) return point;
  const factors = axesOf(transform, 1);
  return [point[0] * factors[0], point[1] * factors[1], point[2] * factors[2]];
}

/// Null: at nothing that is known. What is painted at no point is at the origin.
function lookedAt(body: JsonValue, annotations: ReadonlyMap<string, JsonValue>, refuse: Fail): Vector | null {
  if (!body.has('lookAt')) return null;
  const lookAt = body.at('lookAt');
  const annotation = annotations.get(idOf(lookAt));
  return pointOf(lookAt, refuse) ?? (annotation === undefined ? null : (targetOf(annotation, refuse) ?? [0, 0, 0]));
}

/// One that looks at nothing looks as far as the middle of its scene is away, or the point that it is to look beside.
function seenFrom(position: Vector, direction: Vector, target: Vector | null, choices: string): Camera['seen'] {
  return (at) => {
    const far = distanceOf(position, at ?? [0, 0, 0]) || length(position) || 1;
    return { position, target: target ?? add(position, scale(direction, far)), choices };
  };
}

export function cameraBodyOf(annotation: JsonValue, languages: Languages): Body | undefined {
  return bodiesOf(annotation, languages).find(({ value }) => isOfType(value, 'PerspectiveCamera'));
}

/// `annotations`: all, by their ids. Null: it stands at no point.
export function readCamera(annotation: JsonValue, { value, transforms }: Body, annotations: ReadonlyMap<string, JsonValue>, languages: Languages, refuse: Fail): Camera | null {
  const place = targetOf(annotation, refuse);
  if (place === null) return null;
  const along = (point: Vector): Vector => transforms.reduce(transformed, point);
  const offset = along([0, 0, 0]);
  const direction = unit(subtract(along([0, 0, -1]), offset));
  const choices = value.has(CHOICES) ? shortened(value.at(CHOICES).text()) : '';
  return {
    id: idOf(annotation),
    name: labelOf(annotation, languages) || labelOf(value, languages),
    seen: seenFrom(add(place, offset), direction, lookedAt(value, annotations, refuse), choices),
  };
}
