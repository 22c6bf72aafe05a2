// SPDX-License-Identifier: MIT
// Shows one object in another colour, and leaves objects out: all corners of a triangle have its object.
import { Color, DataTexture, NearestFilter, RedFormat, RGBAFormat, SRGBColorSpace, UnsignedByteType, type BufferGeometry } from 'three';
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
if (coloursObjects) {
  int object = int(vObject + 0.5);
  vec4 colour = texelFetch(objectColours, ivec2(object & ${ROW - 1}, object >> 12), 0);
  if (colour.a > 0.5) diffuseColor.rgb = colour.rgb;
}
if (abs(vObject - markedObject) < 0.5) diffuseColor.rgb = mix(diffuseColor.rgb, objectMark, 0.45);`;

function rowsOf(objects: number): number {
  return Math.max(1, Math.ceil(objects / ROW));
}

function texture(bytes: Uint8Array<ArrayBuffer>, rows: number, format: typeof RedFormat | typeof RGBAFormat): DataTexture {
  const made = new DataTexture(bytes, ROW, rows, format, UnsignedByteType);
  made.minFilter = made.magFilter = NearestFilter;
  made.needsUpdate = true;
  return made;
}

export class ObjectShading implements Shading {
  /// Pictures that have their light already show it, too.
  readonly isForUnlit = true;
  readonly uniforms = {
    markedObject: { value: NONE },
    objectMark: { value: new Color(MARK) },
    leavesObjectsOut: { value: false },
    leftOutObjects: { value: null as DataTexture | null },
    coloursObjects: { value: false },
    objectColours: { value: null as DataTexture | null },
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
    shader.fragmentShader = `uniform float markedObject;\nuniform vec3 objectMark;\nuniform bool leavesObjectsOut;\nuniform highp sampler2D leftOutObjects;\nuniform bool coloursObjects;\nuniform highp sampler2D objectColours;\nflat varying float vObject;\n${shader.fragmentShader}`;
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
    const states = new Uint8Array(ROW * rowsOf(count)).fill(areShown ? 255 : 0);
    for (const { begin, end } of ranges) states.fill(areShown ? 0 : 255, begin, end);
    leftOutObjects.value?.dispose();
    leftOutObjects.value = texture(states, rowsOf(count), RedFormat);
  }

  /// Gives each object a colour of a screen, four bytes each; the fourth is 0 where it has none. Null: they look as they are.
  colour(bytes: Uint8Array | null): void {
    const { coloursObjects, objectColours } = this.uniforms;
    coloursObjects.value = bytes !== null;
    objectColours.value?.dispose();
    objectColours.value = null;
    if (bytes === null) return;
    this.isUsed = true;
    const rows = rowsOf(bytes.length / 4);
    const padded = new Uint8Array(4 * ROW * rows);
    padded.set(bytes);
    objectColours.value = texture(padded, rows, RGBAFormat);
    objectColours.value.colorSpace = SRGBColorSpace;
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
    this.colour(null);
    this.uniforms.markedObject.value = NONE;
  }
}
