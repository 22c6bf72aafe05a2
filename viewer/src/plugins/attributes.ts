// SPDX-License-Identifier: MIT
// Colours by an attribute of the vertices: along a ramp, or one for each label.
import { DataTexture, Vector2, type BufferGeometry } from 'three';
import { isLabel, LEAST_VALUE, type ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import { linear } from '../scene/materials.js';
import { labelTexture, PLAIN, rampTexture } from '../scene/ramps.js';
import { attributeIndex, wholeRange, type AttributeLook, type Look } from '../scene/settings.js';
import { replaceChunk, type Shader, type Shading } from '../scene/shading.js';
import type { PluginOf } from './plugin.js';
import { setValueAttribute } from './value_attribute.js';

/// Labels farther apart share colours: a texture has no more texels.
const MOST_LABEL_TEXELS = 4096;
const LINES = 10;

const VALUE = `#include <begin_vertex>
vValue = scalar;`;

const QUANTITY = `#include <color_fragment>
if (vValue > ${LEAST_VALUE}) {
  vec2 valueEnds = beyond(valueRange);
  float valuePart = (beyond(vec2(vValue)).x - valueEnds.x) / (valueEnds.y == valueEnds.x ? 1.0 : valueEnds.y - valueEnds.x);
  diffuseColor.rgb = texture2D(valueRamp, vec2(clamp(valuePart, 0.5 / 256.0, 255.5 / 256.0), 0.5)).rgb;
  if (abs(vValue) <= valueTolerance) diffuseColor.rgb = ${linear(PLAIN)};
  if (isolineStep > 0.0) {
    float lineAt = vValue / isolineStep;
    float lineWidth = max(fwidth(lineAt), 1e-6);
    float away = abs(fract(lineAt + 0.5) - 0.5) / lineWidth;
    if (lineWidth < 0.5) diffuseColor.rgb *= mix(0.25, 1.0, smoothstep(0.6, 1.2, away));
  }
}`;

/// As rampPart() has it.
const BEYOND = `vec2 beyond(vec2 value) {
  return value - clamp(value, -max(valueTolerance, 0.0), max(valueTolerance, 0.0));
}
`;

/// Labels beyond the texture begin again at its start.
const LABEL = `#include <color_fragment>
{
  float texels = valueRange.y - valueRange.x;
  vec4 labelColour = texture2D(valueRamp, vec2((mod(floor(vValue - valueRange.x + 0.5), texels) + 0.5) / texels, 0.5));
  if (labelColour.a < 0.5) discard;
  diffuseColor.rgb = labelColour.rgb;
}`;

/// A round step of which about ten lie in a range.
export function isolineStep([from, to]: readonly [number, number]): number {
  const rough = Math.abs(to - from) / LINES || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  return ([1, 2, 5].find((step) => step * power >= rough) ?? 10) * power;
}

export class Attributes implements PluginOf<unknown>, Shading {
  readonly name = 'attributes';
  readonly shading: Shading = this;
  readonly uniforms = {
    valueRamp: { value: null as DataTexture | null },
    /// Where the texture begins and ends.
    valueRange: { value: new Vector2(0, 1) },
    isolineStep: { value: 0 },
    /// Below 0: there is none.
    valueTolerance: { value: -1 },
  };
  /// The place of the attribute among a vertex's values; -1: the model has none, or it is not known yet.
  private index = -1;
  /// A label is that of a whole triangle.
  private isLabel = false;
  private made = '';
  private shown: ScalarAttribute | null = null;

  key({ colours }: Look, tile: Tile): string {
    if (colours !== 'attribute' || tile.values === null || this.index < 0) return '';
    return this.isLabel ? 'label' : 'quantity';
  }

  edit(shader: Shader): void {
    const varying = `${this.isLabel ? 'flat ' : ''}varying float vValue;\n`;
    replaceChunk(shader, 'vertexShader', 'begin_vertex', VALUE);
    replaceChunk(shader, 'fragmentShader', 'color_fragment', this.isLabel ? LABEL : QUANTITY);
    shader.vertexShader = `attribute float scalar;\n${varying}${shader.vertexShader}`;
    shader.fragmentShader = `uniform sampler2D valueRamp;\nuniform vec2 valueRange;\nuniform float isolineStep, valueTolerance;\n${BEYOND}${varying}${shader.fragmentShader}`;
  }

  show(look: Look, attributes: readonly ScalarAttribute[]): void {
    this.index = attributeIndex(attributes, look.attribute);
    if (this.index < 0) return;
    const attribute = attributes[this.index];
    const key = JSON.stringify([this.index, look]);
    if (key === this.made && attribute === this.shown) return;
    [this.made, this.shown] = [key, attribute];
    this.isLabel = isLabel(attribute);
    this.uniforms.valueRamp.value?.dispose();
    if (this.isLabel) this.setLabels(attribute, look.hidden);
    else this.setRamp(attribute, look);
  }

  prepare(geometry: BufferGeometry, tile: Tile, { colours }: Look): void {
    if (colours !== 'attribute' || tile.values === null || this.index < 0) return;
    setValueAttribute(geometry, tile, 'scalar', this.index);
  }

  dispose(): void {
    this.uniforms.valueRamp.value?.dispose();
  }

  private setRamp(attribute: ScalarAttribute, { ramp, range, tolerance, isolines }: AttributeLook): void {
    const ends = range ?? wholeRange(attribute, ramp);
    this.uniforms.valueRamp.value = rampTexture(ramp);
    this.uniforms.valueRange.value.set(...ends);
    this.uniforms.valueTolerance.value = tolerance ?? -1;
    this.uniforms.isolineStep.value = isolines ? isolineStep(ends) : 0;
  }

  private setLabels({ min, max, labels }: ScalarAttribute, hidden: readonly number[]): void {
    const texels = Math.min(MOST_LABEL_TEXELS, Math.max(1, Math.floor(max - min) + 1));
    const numbers = new Map(labels.map((label, i) => [label, i]));
    this.uniforms.valueRamp.value = labelTexture(min, texels, (label) => numbers.get(label) ?? Math.abs(Math.round(label)), hidden);
    this.uniforms.valueRange.value.set(min, min + texels);
    this.uniforms.isolineStep.value = 0;
  }
}
