// SPDX-License-Identifier: MIT
// Shows one object in another colour, and leaves objects out: all corners of a triangle have its object.
import { Color, DataTexture, NearestFilter, RedFormat, UnsignedByteType, type BufferGeometry } from 'three';
import type { ObjectRange } from '../hierarchy/object_table.js';
import { objectIndex, type ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import type { Look } from '../scene/settings.js';
import { replaceChunk, type Shader, type Shading } from '../scene/shading.js';
import { setValueAttribute } from './value_attribute.js';

/// A texel an object: all 2^24 that there may be have room.
const ROW = 4096;
const NONE = -1;
/// As a screen has it.
export const MARK = 0xff8a1f;

const OBJECT = `#include <begin_vertex>
vObject = object;`;

const SHOWN = `#include <color_fragment>
if (leavesObjectsOut) {
  int object = int(vObject + 0.5);
  if (texelFetch(leftOutObjects, ivec2(object & ${ROW - 1}, object >> 12), 0).r > 0.5) discard;
}
if (abs(vObject - markedObject) < 0.5) diffuseColor.rgb = mix(diffuseColor.rgb, objectMark, 0.45);`;

export class ObjectShading implements Shading {
  /// Pictures that have their light already show it, too.
  readonly isForUnlit = true;
  readonly uniforms = {
    markedObject: { value: NONE },
    objectMark: { value: new Color(MARK) },
    leavesObjectsOut: { value: false },
    leftOutObjects: { value: null as DataTexture | null },
  };
  /// The place of the object among a vertex's values; -1: the model has none, or it is not known yet.
  private index = -1;
  private isUsed = false;

  /// Once something was marked or left out, it goes on: programs are made once.
  key(_: Look, tile: Tile): string {
    return this.isUsed && this.index >= 0 && tile.values !== null ? 'object' : '';
  }

  readonly edit = (shader: Shader): void => {
    replaceChunk(shader, 'vertexShader', 'begin_vertex', OBJECT);
    replaceChunk(shader, 'fragmentShader', 'color_fragment', SHOWN);
    shader.vertexShader = `attribute float object;\nflat varying float vObject;\n${shader.vertexShader}`;
    shader.fragmentShader = `uniform float markedObject;\nuniform vec3 objectMark;\nuniform bool leavesObjectsOut;\nuniform highp sampler2D leftOutObjects;\nflat varying float vObject;\n${shader.fragmentShader}`;
  };

  show(_: Look, attributes: readonly ScalarAttribute[]): void {
    this.index = objectIndex(attributes);
  }

  prepare(geometry: BufferGeometry, tile: Tile, look: Look): void {
    if (this.key(look, tile) !== '') setValueAttribute(geometry, tile, 'object', this.index);
  }

  /// Null: none.
  mark(object: number | null): void {
    this.isUsed ||= object !== null;
    this.uniforms.markedObject.value = object ?? NONE;
  }

  /// Leaves objects out, or all but these; null: none. `count`: of all objects.
  leaveOut(ranges: readonly ObjectRange[] | null, areShown: boolean, count: number): void {
    const { leavesObjectsOut, leftOutObjects } = this.uniforms;
    leavesObjectsOut.value = ranges !== null;
    if (ranges === null) return;
    this.isUsed = true;
    const rows = Math.max(1, Math.ceil(count / ROW));
    const states = new Uint8Array(ROW * rows).fill(areShown ? 255 : 0);
    for (const { begin, end } of ranges) states.fill(areShown ? 0 : 255, begin, end);
    leftOutObjects.value?.dispose();
    leftOutObjects.value = new DataTexture(states, ROW, rows, RedFormat, UnsignedByteType);
    leftOutObjects.value.minFilter = leftOutObjects.value.magFilter = NearestFilter;
    leftOutObjects.value.needsUpdate = true;
  }

  /// An object is marked, and drawn.
  get isMarking(): boolean {
    const { value } = this.uniforms.markedObject;
    return value !== NONE && this.draws(value);
  }

  /// Tells whether an object is drawn.
  draws(object: number): boolean {
    const { leavesObjectsOut, leftOutObjects: { value } } = this.uniforms;
    return !leavesObjectsOut.value || (value?.image.data as Uint8Array | undefined)?.[object] !== 255;
  }

  /// The object of values at a vertex; null: there is none.
  objectOf(values: readonly number[]): number | null {
    const value = values[this.index] as number | undefined;
    return value !== undefined && value >= 0 ? value : null;
  }

  dispose(): void {
    this.uniforms.leftOutObjects.value?.dispose();
    this.uniforms.leftOutObjects.value = null;
    this.uniforms.leavesObjectsOut.value = false;
    this.uniforms.markedObject.value = NONE;
  }
}
