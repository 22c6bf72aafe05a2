// SPDX-License-Identifier: MIT
// Marks over the picture: points, lines and texts, at their places in each frame.
import { Vector4, type Matrix4 } from 'three';
import type { ViewCamera } from '../scene/projection.js';
import { placeOf, type PicturePlace } from '../tools/picture_place.js';
import type { Vector } from '../tools/vectors.js';

/// In the tiles' coordinates; a line has an end.
export interface Mark {
  readonly at: Vector;
  readonly to?: Vector;
  readonly text?: string;
  /// The text alone, around the place.
  readonly isBare?: boolean;
}

const SVG = 'http://www.w3.org/2000/svg';
const POINT_RADIUS = 5; // pixels
const TEXT_OFF = 9;
const POINT = { fill: '#c8501e', stroke: '#fff', 'stroke-width': 2 };
const LINE = { stroke: '#c8501e', 'stroke-width': 2.5 };
const UNDER = { class: 'under', stroke: '#fff', 'stroke-width': 5, opacity: 0.8 };
const TEXT = { fill: '#1d2125', stroke: '#fff', 'stroke-width': 4, 'paint-order': 'stroke', 'font-family': 'system-ui, sans-serif', 'font-size': 13, 'font-weight': 600 };
const LEAST_LINE = 60; // pixels: the text of a shorter one would cover others

function make(tag: string, to: Element, attributes: Readonly<Record<string, number | string>>): SVGElement {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  to.append(made);
  return made;
}

export class Overlay {
  readonly root = document.createElementNS(SVG, 'svg');

  /// A page's style of marks in the class goes before their attributes here: colours, widths. The overlay's place is set here alone.
  constructor(name = 'meshhier-overlay') {
    this.root.setAttribute('class', name);
    this.root.style.cssText = 'position: absolute; inset: 0; width: 100%; height: 100%; pointer-events: none';
    this.root.setAttribute('aria-hidden', 'true'); // cards tell the same in words
  }

  show(marks: readonly Mark[], camera: ViewCamera, matrix: Readonly<Matrix4>): void {
    if (marks.length === 0 && this.root.childElementCount === 0) return;
    this.root.replaceChildren();
    const clipOf = ([x, y, z]: Vector): Vector4 =>
      new Vector4(x, y, z, 1).applyMatrix4(matrix).applyMatrix4(camera.matrixWorldInverse).applyMatrix4(camera.projectionMatrix);
    for (const mark of marks) {
      if (mark.to) this.line(clipOf(mark.at), clipOf(mark.to), mark.text);
      else this.point(clipOf(mark.at), mark.text, mark.isBare);
    }
  }

  private point(clip: Vector4, text: string | undefined, isBare = false): void {
    const { x, y } = placeOf(clip, this.root);
    if (clip.w <= 0 || !Number.isFinite(x + y)) return; // notes may be anywhere
    if (isBare) {
      this.text({ x, y }, text, { 'text-anchor': 'middle', 'dominant-baseline': 'central' });
      return;
    }
    make('circle', this.root, { ...POINT, cx: x, cy: y, r: POINT_RADIUS });
    this.text({ x: x + TEXT_OFF, y: y - TEXT_OFF }, text);
  }

  /// Nothing is drawn that lies behind the camera.
  private line(a: Vector4, b: Vector4, text: string | undefined): void {
    const near = Math.max(a.w, b.w) * 1e-6;
    if (near <= 0) return;
    const cut = (from: Vector4, to: Vector4): Vector4 => (from.w >= near ? from : from.clone().lerp(to, (near - from.w) / (to.w - from.w)));
    const [one, other] = [placeOf(cut(a, b), this.root), placeOf(cut(b, a), this.root)];
    make('line', this.root, { ...UNDER, x1: one.x, y1: one.y, x2: other.x, y2: other.y });
    make('line', this.root, { ...LINE, x1: one.x, y1: one.y, x2: other.x, y2: other.y });
    if (Math.hypot(one.x - other.x, one.y - other.y) >= LEAST_LINE) this.text({ x: (one.x + other.x) / 2 + TEXT_OFF, y: (one.y + other.y) / 2 - TEXT_OFF }, text);
  }

  private text({ x, y }: PicturePlace, text: string | undefined, more: Readonly<Record<string, string>> = {}): void {
    if (text !== undefined) make('text', this.root, { ...TEXT, ...more, x, y }).textContent = text;
  }
}
