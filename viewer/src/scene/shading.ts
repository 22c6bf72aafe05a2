// SPDX-License-Identifier: MIT
// Tiles see this of a plug-in: it shades their surfaces otherwise than three alone would.
import type { BufferGeometry, IUniform, Material, MaterialParameters, WebGLProgramParametersWithUniforms } from 'three';
import type { ScalarAttribute } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import { attempt } from '../plugins/attempt.js';
import { leaveOut, type Omission, type Omits } from './omission.js';
import type { Look } from './settings.js';

export type Shader = WebGLProgramParametersWithUniforms;

/// Changes the material of surfaces. All tiles of a view share it. Its members are called whenever tiles are shown otherwise, in the order
/// `show`, `key`, `parameters`, `prepare`, and `edit` once a program is compiled. If one of them throws, the error is told and the shading left
/// out, until its plug-in is registered anew.
export interface Shading {
  /// They are declared by `edit`, and there in all programs that it edits.
  readonly uniforms: Readonly<Record<string, IUniform>>;
  /// It also changes surfaces that no light is on, of pictures that have theirs already; else only lit ones.
  readonly isForUnlit?: boolean;
  /// It leaves parts of tiles out: `edit` does so on their surfaces, and this wherever else they are drawn or measured.
  readonly omission?: Omission;
  /// Surfaces of one key have one program, as far as they share `edit`; empty: this one's is left alone.
  key(look: Look, tile: Tile): string;
  /// Changes three's shaders. Chunks that it replaces begin with themselves, for others may replace them too: what they add runs in the order
  /// in which the plug-ins came, after what every view adds.
  readonly edit: (shader: Shader, look: Look, tile: Tile) => void;
  /// Returns parameters that the material is made with besides.
  parameters?(look: Look): MaterialParameters & Readonly<Record<string, unknown>>;
  /// Tiles are shown so from now on; `attributes`: what the model's vertices have, none while that is not known.
  show?(look: Look, attributes: readonly ScalarAttribute[]): void;
  /// Gives a tile's vertices what the shader wants of them, whenever it is shown otherwise. Arrays of the tile are kept up as its seams change.
  prepare?(geometry: BufferGeometry, tile: Tile, look: Look): void;
}

/// The shadings of a view's plug-ins, in their order. One that throws is left out from then on.
export class Shadings {
  private list: readonly Shading[] = [];
  private readonly failed = new Set<Shading>();

  /// `changed`: one is left out, and tiles are to be shown anew.
  constructor(private readonly changed: () => void = () => undefined) {}

  get all(): readonly Shading[] {
    return this.list.filter((each) => !this.failed.has(each));
  }

  /// One that was taken away has another try when it is back.
  set all(shadings: readonly Shading[]) {
    this.list = shadings;
    for (const each of this.failed) if (!shadings.includes(each)) this.failed.delete(each);
  }

  /// Returns what `call` does, `otherwise` where it throws.
  ask<Answer>(shading: Shading, call: () => Answer, otherwise: Answer): Answer {
    return attempt(call, () => {
      this.failed.add(shading);
      this.changed();
      return otherwise;
    });
  }

  show(look: Look, attributes: readonly ScalarAttribute[]): void {
    for (const each of this.all) this.ask(each, () => each.show?.(look, attributes), undefined);
  }

  prepare(geometry: BufferGeometry, tile: Tile, look: Look): void {
    for (const each of this.all) this.ask(each, () => each.prepare?.(geometry, tile, look), undefined);
  }

  /// What is left out; null: nothing is.
  get omits(): Omits | null {
    const { omissions } = this;
    return omissions.length === 0 ? null : (tile, vertex) => omissions.some((each) => each.omits(tile, vertex));
  }

  /// Another text whenever something else is left out.
  get omissionKey(): string {
    return this.omissions.map((each) => `${numberOf(each)}:${each.version}`).join();
  }

  /// Makes a material, with which tiles are drawn otherwise, leave out what is left out now.
  leaveOut(material: Material): void {
    leaveOut(material, this.omissions);
  }

  private get omissions(): readonly Omission[] {
    return this.all.flatMap(({ omission }) => (omission?.isUsed === true ? [omission] : []));
  }

  /// Those that change a tile's surface, with their keys.
  keyed(look: Look, tile: Tile): { readonly shading: Shading; readonly key: string }[] {
    return this.all.map((shading) => ({ shading, key: this.ask(shading, () => shading.key(look, tile), '') })).filter(({ key }) => key !== '');
  }

  /// A shader is as before where its edit fails.
  edit(shading: Shading, shader: Shader, look: Look, tile: Tile): void {
    if (this.failed.has(shading)) return;
    const { vertexShader, fragmentShader } = shader;
    this.ask(shading, () => { shading.edit(shader, look, tile); }, undefined);
    if (this.failed.has(shading)) Object.assign(shader, { vertexShader, fragmentShader });
  }
}

const numbers = new WeakMap<object, number>();
let numbered = 0;

/// Returns the number of an object, which no other has.
export function numberOf(object: object): number {
  const number = numbers.get(object) ?? ++numbered;
  numbers.set(object, number);
  return number;
}

/// Replaces `#include <chunk>` of a shader; nothing happens where it has none.
export function replaceChunk(shader: Shader, where: 'vertexShader' | 'fragmentShader', chunk: string, by: string): void {
  shader[where] = shader[where].replace(`#include <${chunk}>`, by);
}
