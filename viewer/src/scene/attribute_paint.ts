// SPDX-License-Identifier: MIT
// Colours by an attribute: what the shaders of all tiles of a model have in common.
import { DataTexture, Vector2 } from 'three';
import { LEAST_VALUE, type ScalarAttribute } from '../hierarchy/scalar_values.js';
import { labelTexture, rampTexture, type RampName } from './ramps.js';

/// How an attribute is shown.
export interface AttributeLook {
  /// Its name; one that the model does not have is its first one.
  attribute: string;
  ramp: RampName;
  /// Values at the ends of the ramp; null: the least and the most, of signed values as far on both sides of 0.
  range: readonly [number, number] | null;
  /// Lines of equal value, about ten.
  isolines: boolean;
  /// Labels that are not drawn.
  hidden: readonly number[];
}

/// Labels farther apart share colours: a texture has no more texels.
const MOST_LABEL_TEXELS = 4096;
const LINES = 10;

/// At the ends of the ramp if nothing is said.
export function wholeRange({ min, max }: ScalarAttribute, ramp: RampName): readonly [number, number] {
  const most = Math.max(-min, max);
  return ramp === 'coolwarm' && min < 0 && max > 0 ? [-most, most] : [min, max];
}

/// The attribute of that name, else the first one; -1: there is none.
export function attributeIndex(attributes: readonly ScalarAttribute[], name: string): number {
  return Math.max(attributes.findIndex((each) => each.name === name), Math.min(0, attributes.length - 1));
}

/// A round step of which about ten lie in a range.
export function isolineStep([from, to]: readonly [number, number]): number {
  const rough = Math.abs(to - from) / LINES || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  return ([1, 2, 5].find((step) => step * power >= rough) ?? 10) * power;
}

export class AttributePaint {
  /// Of the values of a vertex, which one; -1: the model has none, or it is not known yet.
  index = -1;
  isLabel = false;
  readonly uniforms = {
    valueRamp: { value: null as DataTexture | null },
    /// Where the texture begins and ends.
    valueRange: { value: new Vector2(0, 1) },
    isolineStep: { value: 0 },
  };
  private made = '';

  /// Takes an attribute of a model, as it is to be shown.
  set(attributes: readonly ScalarAttribute[], look: AttributeLook): void {
    this.index = attributeIndex(attributes, look.attribute);
    if (this.index < 0) return;
    const attribute = attributes[this.index];
    const key = JSON.stringify([this.index, look]);
    if (key === this.made) return;
    this.made = key;
    this.isLabel = attribute.kind === 'label';
    this.uniforms.valueRamp.value?.dispose();
    if (this.isLabel) this.setLabels(attribute, look.hidden);
    else this.setRamp(attribute, look);
  }

  private setRamp(attribute: ScalarAttribute, { ramp, range, isolines }: AttributeLook): void {
    const ends = range ?? wholeRange(attribute, ramp);
    this.uniforms.valueRamp.value = rampTexture(ramp);
    this.uniforms.valueRange.value.set(...ends);
    this.uniforms.isolineStep.value = isolines ? isolineStep(ends) : 0;
  }

  private setLabels({ min, max, labels }: ScalarAttribute, hidden: readonly number[]): void {
    const texels = Math.min(MOST_LABEL_TEXELS, Math.max(1, Math.floor(max - min) + 1));
    const numbers = new Map(labels.map((label, i) => [label, i]));
    this.uniforms.valueRamp.value = labelTexture(min, texels, (label) => numbers.get(label) ?? Math.abs(Math.round(label)), hidden);
    this.uniforms.valueRange.value.set(min, min + texels);
    this.uniforms.isolineStep.value = 0;
  }

  /// What decides which program draws: a label is that of a whole triangle.
  get key(): string {
    return this.isLabel ? 'label' : 'quantity';
  }

  dispose(): void {
    this.uniforms.valueRamp.value?.dispose();
  }
}

// ---- shaders

/// What stands before a shader.
export function valueDeclarations(isLabel: boolean, isVertexShader: boolean): string {
  const varying = `${isLabel ? 'flat ' : ''}varying float vValue;\n`;
  if (isVertexShader) return `attribute float scalar;\n${varying}`;
  return `uniform sampler2D valueRamp;\nuniform vec2 valueRange;\nuniform float isolineStep;\n${varying}`;
}

export const VALUE_VERTEX = `#include <begin_vertex>
vValue = scalar;`;

const QUANTITY = `#include <color_fragment>
if (vValue > ${LEAST_VALUE}) {
  float valuePart = (vValue - valueRange.x) / (valueRange.y == valueRange.x ? 1.0 : valueRange.y - valueRange.x);
  diffuseColor.rgb = texture2D(valueRamp, vec2(clamp(valuePart, 0.5 / 256.0, 255.5 / 256.0), 0.5)).rgb;
  if (isolineStep > 0.0) {
    float lineAt = vValue / isolineStep;
    float lineWidth = max(fwidth(lineAt), 1e-6);
    float away = abs(fract(lineAt + 0.5) - 0.5) / lineWidth;
    if (lineWidth < 0.5) diffuseColor.rgb *= mix(0.25, 1.0, smoothstep(0.6, 1.2, away));
  }
}`;

/// Labels beyond the texture begin again at its start.
const LABEL = `#include <color_fragment>
{
  float texels = valueRange.y - valueRange.x;
  vec4 labelColour = texture2D(valueRamp, vec2((mod(floor(vValue - valueRange.x + 0.5), texels) + 0.5) / texels, 0.5));
  if (labelColour.a < 0.5) discard;
  diffuseColor.rgb = labelColour.rgb;
}`;

export function valueFragment(isLabel: boolean): string {
  return isLabel ? LABEL : QUANTITY;
}
