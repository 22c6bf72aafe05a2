// SPDX-License-Identifier: MIT
// What is left out of tiles is left out in every pass: of their surface, wires and points, of their depth alone, of what fills a cut, and of what
// tools measure. A shading says it once, for shaders and for programs.
import type { IUniform, Material, WebGLProgramParametersWithUniforms } from 'three';
import type { Tile } from '../hierarchy/tile.js';

/// All corners of a triangle are left out, or none is.
export interface Omission {
  readonly uniforms: Readonly<Record<string, IUniform>>;
  /// True once something was left out: programs are made once.
  readonly isUsed: boolean;
  /// Another number whenever others are left out.
  readonly version: number;
  /// Changes the vertex shader: what is left out lies where nothing is drawn.
  readonly edit: (shader: WebGLProgramParametersWithUniforms) => void;
  /// Tells whether a vertex is left out.
  omits(tile: Tile, vertex: number): boolean;
}

/// Tells whether a vertex of a tile is left out.
export type Omits = (tile: Tile, vertex: number) => boolean;

interface Own extends Pick<Material, 'onBeforeCompile' | 'customProgramCacheKey'> {
  key: string;
}

const owns = new WeakMap<Material, Own>();
const numbers = new WeakMap<Omission, number>();
let numbered = 0;

function numberOf(omission: Omission): number {
  const number = numbers.get(omission) ?? ++numbered;
  numbers.set(omission, number);
  return number;
}

/// Makes a material leave out what omissions do; it is compiled again where they are others than last time.
export function leaveOut(material: Material, omissions: readonly Omission[]): void {
  const own = owns.get(material) ?? { key: '', onBeforeCompile: material.onBeforeCompile.bind(material), customProgramCacheKey: material.customProgramCacheKey.bind(material) };
  const key = omissions.map(numberOf).join();
  if (key === own.key) return;
  owns.set(material, own);
  own.key = key;
  material.onBeforeCompile = (shader, renderer) => {
    own.onBeforeCompile(shader, renderer);
    Object.assign(shader.uniforms, ...omissions.map(({ uniforms }) => uniforms));
    for (const { edit } of omissions) edit(shader);
  };
  material.customProgramCacheKey = () => `${own.customProgramCacheKey()}-without-${key}`;
  material.needsUpdate = true;
}
