// SPDX-License-Identifier: MIT
// The point that an annotation is at: of a PointSelector, the middle of a line or polygon (WKT), or in an address (`#xyz=1,2,3`).
import { areNear } from '../farthest.js';
import type { Fail, JsonValue } from '../json_value.js';
import { add, cross, dot, scale, subtract, type Vector } from './vectors.js';

const WKT = /^\s*(POINT|LINESTRING|POLYGON)\s*(?:Z\s*)?\(+([^()]*)\)/i;
const FRAGMENT = /[#&]xyz=([^&]*)/;

export function isOfType(value: JsonValue, type: string): boolean {
  return value.isObject() && value.at('type').isText(type);
}

export function idOf(value: JsonValue): string {
  if (value.isText()) return value.text();
  return value.isObject() && value.at('id').isText() ? value.at('id').text() : '';
}

/// Along x, y and z; what is not said is `otherwise`.
export function axesOf(value: JsonValue, otherwise: number): Vector {
  const along = (axis: string): number => (value.has(axis) ? value.at(axis).coordinate() : otherwise);
  return [along('x'), along('y'), along('z')];
}

/// Reads two numbers or three, with `between` between them; null: it is something else.
function parsePoint(text: string, between: RegExp): Vector | null {
  const [x, y, z = 0, ...more] = text.trim().split(between).map((part) => (part === '' ? NaN : Number(part)));
  return more.length === 0 && areNear([x, y, z]) ? [x, y, z] : null;
}

function meanOf(points: readonly Vector[]): Vector {
  return scale(points.reduce(add), 1 / points.length);
}

/// Returns the middle of the area within a polygon; of its corners, if it has no area.
function centroidOf(corners: readonly Vector[]): Vector {
  const [first] = corners;
  const fan = corners.slice(2).map((corner, i) => [corners[i + 1], corner] as const);
  const areas = fan.map(([a, b]) => cross(subtract(a, first), subtract(b, first)));
  const normal = areas.reduce(add, [0, 0, 0]);
  const weights = areas.map((area) => dot(area, normal));
  const weight = weights.reduce((sum, each) => sum + each, 0);
  if (!(weight > 0)) return meanOf(corners);
  return scale(fan.map(([a, b], i) => scale(meanOf([first, a, b]), weights[i])).reduce(add), 1 / weight);
}

/// Null of a shape that is not known.
function middleOf(shape: string, refuse: Fail): Vector | null {
  const match = WKT.exec(shape);
  if (match === null) return null;
  const points = match[2].split(',').map((text) => parsePoint(text, /\s+/) ?? refuse(`"${shape.slice(0, 80)}" has no such points`));
  const isClosed = points.length > 1 && points[0].every((value, axis) => value === points[points.length - 1][axis]);
  const corners = isClosed ? points.slice(0, -1) : points;
  return match[1].toUpperCase() === 'POLYGON' ? centroidOf(corners) : meanOf(corners);
}

/// Null: it is none of a point.
function pointOfSelector(selector: JsonValue, refuse: Fail): Vector | null {
  if (isOfType(selector, 'PointSelector')) return axesOf(selector, 0);
  const isShape = ['WktSelector', 'WKTSelector', 'PolygonZSelector'].some((type) => isOfType(selector, type));
  return isShape ? middleOf(selector.at('value').text(), refuse) : null;
}

function pointInAddress(address: string): Vector | null {
  const match = FRAGMENT.exec(address);
  return match && parsePoint(match[1], /,/);
}

/// Reads the point of a target, a selector or an address. Null: it is no point.
export function pointOf(value: JsonValue, refuse: Fail): Vector | null {
  if (!value.isObject()) return value.isText() ? pointInAddress(value.text()) : null;
  const selectors = value.has('selector') ? value.at('selector').oneOrMore() : [value];
  for (const selector of selectors) {
    const point = pointOfSelector(selector, refuse);
    if (point !== null) return point;
  }
  const [source] = value.has('source') ? value.at('source').oneOrMore() : [value];
  return source === undefined ? null : pointInAddress(idOf(source));
}

/// Returns the point of the first of an annotation's targets that is at one.
export function targetOf(annotation: JsonValue, refuse: Fail): Vector | null {
  if (!annotation.isObject() || !annotation.has('target')) return null;
  for (const target of annotation.at('target').oneOrMore()) {
    const point = pointOf(target, refuse);
    if (point !== null) return point;
  }
  return null;
}
