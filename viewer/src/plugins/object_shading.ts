// SPDX-License-Identifier: MIT
// Shows one object in another colour, all of them in colours of their own, and leaves objects out: all corners of a triangle have its object.
import { Color, type BufferGeometry, type DataTexture } from 'three';
import { objectIndex, valueWidth, type ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import type { Look } from '../scene/settings.js';
import { replaceChunk, type Shader, type Shading } from '../scene/shading.js';
import { LeftOutObjects, type ObjectLayer } from './left_out_objects.js';
import { texelOf, texelTexture } from './object_texels.js';
import { setValueAttribute } from './value_attribute.js';

const NONE = -1;
/// As a screen has it.
export const MARK = 0xff8a1f;

const OBJECT = `#include <begin_vertex>
vObject = object;`;

const SHOWN = `#include <color_fragment>
if (coloursObjects) {
  vec4 colour = ${texelOf('objectColours', 'vObject')};
  if (colour.a > 0.5) diffuseColor.rgb = colour.rgb;
}
if (abs(vObject - markedObject) < 0.5) diffuseColor.rgb = mix(diffuseColor.rgb, objectMark, 0.45);`;

export class ObjectShading implements Shading {
  /// Pictures that have their light already show it, too.
  readonly isForUnlit = true;
  readonly omission = new LeftOutObjects((tile, vertex) => this.object(tile.values?.[valueWidth(tile) * vertex + this.index]));
  readonly uniforms = {
    ...this.omission.uniforms,
    markedObject: { value: NONE },
    objectMark: { value: new Color(MARK) },
    coloursObjects: { value: false },
    objectColours: { value: null as DataTexture | null },
  };
  /// The place of the object among a vertex's values; -1: the model has none, or it is not known yet.
  private index = -1;
  private isUsed = false;

  /// Once something was marked or left out, it goes on: programs are made once.
  key(_: Look, tile: Tile): string {
    return (this.isUsed || this.omission.isUsed) && this.index >= 0 && tile.values !== null ? 'object' : '';
  }

  readonly edit = (shader: Shader): void => {
    replaceChunk(shader, 'vertexShader', 'begin_vertex', OBJECT);
    replaceChunk(shader, 'fragmentShader', 'color_fragment', SHOWN);
    this.omission.edit(shader);
    shader.vertexShader = `flat varying float vObject;\n${shader.vertexShader}`;
    shader.fragmentShader = `uniform float markedObject;\nuniform vec3 objectMark;\nuniform bool coloursObjects;\nuniform highp sampler2D objectColours;\nflat varying float vObject;\n${shader.fragmentShader}`;
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

  /// Each layer goes over those before it; of none all `count` objects are drawn.
  leaveOut(layers: readonly ObjectLayer[], count: number): void {
    this.omission.set(layers, count);
  }

  /// Gives each object a colour: `bytes` as texelBytes() has room for them, the fourth is 0 where there is none. The same bytes again: they have
  /// changed. Null: objects look as they are.
  colour(bytes: Uint8Array<ArrayBuffer> | null): void {
    const { coloursObjects, objectColours } = this.uniforms;
    this.isUsed ||= bytes !== null;
    coloursObjects.value = bytes !== null;
    if (bytes !== null && objectColours.value?.image.data === bytes) {
      objectColours.value.needsUpdate = true;
      return;
    }
    objectColours.value?.dispose();
    objectColours.value = bytes && texelTexture(bytes, 4);
  }

  /// An object is marked, and drawn.
  get isMarking(): boolean {
    const { value } = this.uniforms.markedObject;
    return value !== NONE && this.draws(value);
  }

  /// Tells whether an object is drawn.
  draws(object: number): boolean {
    return !this.omission.has(object);
  }

  /// The object of values at a vertex; null: there is none.
  objectOf(values: readonly number[]): number | null {
    return this.object(values[this.index]);
  }

  dispose(): void {
    this.leaveOut([], 0);
    this.colour(null);
    this.uniforms.markedObject.value = NONE;
  }

  private object(value: number | undefined): number | null {
    return value !== undefined && value >= 0 ? value : null;
  }
}
