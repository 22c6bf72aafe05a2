// SPDX-License-Identifier: MIT
// Draws contour lines on the surface as it is shown, each fifth one bolder: what is finer, or cut, shows them so at once. Lines that can be
// saved and labelled are made by tools/contours.ts.
import { Vector3 } from 'three';
import { replaceChunk, type Shader, type Shading } from '../scene/shading.js';
import type { HierarchyView, Plugin } from '../scene/hierarchy_view.js';
import { INDEX_EVERY, type Heights } from '../tools/contours.js';

const HEIGHT = '#include <begin_vertex>\ncontourAt = dot(position, contourUp);';

/// A line is as wide in pixels however steep the surface is; where lines would run into each other there are none.
const LINES = `#include <color_fragment>
{
  float at = (contourAt + contourShift) / contourStep;
  float slope = max(fwidth(at), 1e-9);
  float away = abs(fract(at + 0.5) - 0.5) / slope;
  float index = at / ${INDEX_EVERY}.0;
  float indexAway = abs(fract(index + 0.5) - 0.5) * ${INDEX_EVERY}.0 / slope;
  float line = slope < 0.33 ? 0.75 * (1.0 - smoothstep(0.4, 1.1, away)) : 0.0;
  float bold = slope < ${INDEX_EVERY}.0 * 0.33 ? 0.9 * (1.0 - smoothstep(0.9, 1.7, indexAway)) : 0.0;
  diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.23, 0.09, 0.024), max(line, bold));
}`;

export class Contours implements Plugin, Shading {
  readonly shading: Shading = this;
  readonly isForUnlit = true;
  readonly uniforms = { contourUp: { value: new Vector3() }, contourShift: { value: 0 }, contourStep: { value: 1 } };
  private view: HierarchyView | null = null;
  private isOn = false;

  constructor(readonly name = 'contours') {}

  init(view: HierarchyView): void {
    this.view = view;
  }

  /// In the tiles' coordinates; a shift by whole index contours is none, so that numbers stay small. Throws RangeError for an interval that is none.
  draw({ up, shift }: Heights, interval: number): void {
    if (!(interval > 0) || !Number.isFinite(interval)) throw new RangeError(`an interval of ${interval}`);
    this.isOn = true;
    this.uniforms.contourUp.value.set(...up);
    this.uniforms.contourStep.value = interval;
    this.uniforms.contourShift.value = shift % (INDEX_EVERY * interval);
    this.view?.setLook({}); // programs are chosen anew
  }

  hide(): void {
    this.isOn = false;
    this.view?.setLook({});
  }

  key(): string {
    return this.isOn ? 'contours' : '';
  }

  edit(shader: Shader): void {
    replaceChunk(shader, 'vertexShader', 'begin_vertex', HEIGHT);
    replaceChunk(shader, 'fragmentShader', 'color_fragment', LINES);
    shader.vertexShader = `uniform vec3 contourUp;\nvarying float contourAt;\n${shader.vertexShader}`;
    shader.fragmentShader = `uniform float contourShift;\nuniform float contourStep;\nvarying float contourAt;\n${shader.fragmentShader}`;
  }

  dispose(): void {
    this.isOn = false;
    this.view = null;
  }
}
