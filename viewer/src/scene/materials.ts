// SPDX-License-Identifier: MIT
// The materials of tiles: three's own, so that any scene's lights do.
import {
  Color, DoubleSide, FrontSide, LineBasicMaterial, MeshBasicMaterial, MeshMatcapMaterial, MeshStandardMaterial, PointsMaterial, Vector2, Vector3, type Material, type MaterialParameters, type Side, type Texture,
} from 'three';
import type { Alpha, Picture } from '../hierarchy/picture.js';
import type { Tile } from '../hierarchy/tile.js';
import { makeMatcap } from './matcap.js';
import type { Look } from './settings.js';
import { PLAIN } from './ramps.js';
import { numberOf, replaceChunk, Shadings, type Shader, type Shading } from './shading.js';

const CLAY = 0xd99a76;
const WIRES = 0x101418;
const POINTS = 0xd04a1e;
const POINT_SIZE = 7; // pixels of the page
const DOTS = 0x8d887f; // of a model without triangles, on light and dark grounds
const DOT_SIZE = 4;
const ROUND = `#include <clipping_planes_fragment>
if (distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;`;
/// Edges and points of faces that are not drawn are not, either.
const FACING = `#include <project_vertex>
facing = hidesBacks ? -dot(normalMatrix * normal, isPerspectiveMatrix(projectionMatrix) ? mvPosition.xyz : vec3(0.0, 0.0, -1.0)) : 1.0;`;
const FACING_ONLY = `#include <clipping_planes_fragment>
if (facing < 0.0) discard;`;
/// How far the surface stands back behind its own wires and points: more than programs differ by rounding.
const BEHIND = { slopes: 2, units: 16 };
const GOLDEN = 0.618034; // colours of neighbours in a list lie far apart

/// Backs shine through beside silhouettes, where the front's edge takes but a part of a pixel: there they are lit as that front, and
/// turned to the eye only where they face it. `outwards`: 1 or, for a mesh that is inside out, -1.
const BACKS = `#include <normal_fragment_begin>
#ifdef DOUBLE_SIDED
if (outwards * faceDirection < 0.0) {
  vec3 eye = isOrthographic ? vec3(0.0, 0.0, 1.0) : normalize(vViewPosition);
  float facing = dot(normal, eye);
  vec3 aside = normal - facing * eye;
  normal = normalize(mix(-aside, aside, smoothstep(0.6, 0.98, facing)) + max(facing, 0.001) * eye);
#ifdef USE_NORMALMAP_TANGENTSPACE
  tbn[2] = normal;
#endif
}
#endif`;

/// The input's colours are those of a screen; three adds in linear light.
const TO_LINEAR = `#include <color_vertex>
#ifdef USE_COLOR
  vColor.rgb = mix(vColor.rgb / 12.92, pow((vColor.rgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, vColor.rgb));
#endif`;

function takeScreenColours(shader: { vertexShader: string }): void {
  shader.vertexShader = shader.vertexShader.replace('#include <color_vertex>', TO_LINEAR);
}

const HEIGHT = `#include <begin_vertex>
vHeight = (dot(position, upwards) - heights.x) / max(heights.y - heights.x, 1e-30);`;

/// Lowland green, straw, ochre, rock, snow: of a screen, at equal steps.
const HEIGHT_COLOURS = [0x4f8a63, 0xb9c28a, 0xd8b878, 0x9c7b62, 0xf4f2ee];

/// As shaders have it.
export function linear(hex: number): string {
  return `vec3(${new Color(hex).toArray().map((value) => value.toFixed(5)).join(', ')})`;
}

const RAMP = `#include <color_fragment>
float step_ = clamp(vHeight, 0.0, 1.0) * ${(HEIGHT_COLOURS.length - 1).toFixed(1)};
diffuseColor.rgb *= ${HEIGHT_COLOURS.slice(1).reduce((below, hex, i) => `mix(${below}, ${linear(hex)}, clamp(step_ - ${i.toFixed(1)}, 0.0, 1.0))`, linear(HEIGHT_COLOURS[0]))};`;

/// How the normal turns from one pixel to the next: away from itself over an edge, towards itself in a hollow. Along silhouettes it turns
/// from a surface to the one behind it, which is neither.
export function cavitiesBy({ strength, least, most }: { readonly strength: number; readonly least: number; readonly most: number }): string {
  return `#include <normal_fragment_maps>
float bend = (dFdx(normal).x + dFdy(normal).y) * smoothstep(0.4, 0.8, abs(normal.z));
diffuseColor.rgb *= clamp(1.0 + ${strength.toFixed(1)} * bend, ${least.toFixed(2)}, ${most.toFixed(2)});`;
}

const CAVITIES = cavitiesBy({ strength: 1.8, least: 0.5, most: 1.4 });

/// A tile's surfaces of one key are the same.
export function surfaceKey(look: Look, tile: Tile, { shadings, hidesBacks }: SharedMaterials): string {
  const { colours, texture, relight, material, cavities, shading, wires, points } = look;
  return [colours, texture, relight, material, cavities, shading, wires || points, hidesBacks.value, ...shadings.keyed(look, tile).map((each) => `${numberOf(each.shading)}:${each.key}`)].join();
}

/// The materials of a model's tiles share this.
export interface SharedMaterials {
  readonly wires: Material;
  readonly points: Material;
  /// Instead, where there is nothing but points; `coloured`: by the input.
  readonly dots: { readonly plain: Material; readonly coloured: Material };
  /// Which side of triangles is outside: 1: the front, -1: the back.
  readonly outwards: { value: number };
  /// Which way is up in the tiles' coordinates, and what lies low and high along it.
  readonly upwards: { value: Vector3 };
  readonly heights: { value: Vector2 };
  readonly matcap: Texture;
  /// Faces that look away are not drawn.
  readonly hidesBacks: { value: boolean };
  /// Those of plug-ins.
  readonly shadings: Shadings;
}

/// A tile's surface shows this of it.
export interface Painting {
  readonly tile: Tile;
  /// The picture's.
  readonly texture: Texture | null;
  /// The normal map's.
  readonly normals: Texture | null;
}

export type SurfaceMaterial = MeshStandardMaterial | MeshMatcapMaterial | MeshBasicMaterial;

/// A texel of less alpha is a hole. Pictures that blend have hardly any: tiles hide what lies behind them, in whatever order they are drawn.
const HOLES: Readonly<Record<Alpha, number>> = { OPAQUE: 0, MASK: 0.5, BLEND: 1 / 512 };

/// The picture's part in a material; nothing where there is none.
function picturing(picture: Picture | null, map: Texture | null): { map?: Texture; alphaTest?: number; transparent?: boolean } {
  if (picture === null || map === null) return {};
  return { map, alphaTest: HOLES[picture.alpha], transparent: picture.alpha === 'BLEND' };
}

function standing({ wires, points }: Look): { polygonOffset: boolean; polygonOffsetFactor: number; polygonOffsetUnits: number } {
  return { polygonOffset: wires || points, polygonOffsetFactor: BEHIND.slopes, polygonOffsetUnits: BEHIND.units };
}

/// The sides of tiles that are drawn.
export function sideOf({ hidesBacks }: SharedMaterials): Side {
  return hidesBacks.value ? FrontSide : DoubleSide;
}

/// The picture's colours, and what tints them.
function unlitMaterial(look: Look, { tile, texture }: Painting, shared: SharedMaterials): MeshBasicMaterial {
  const { picture, coloursTint } = tile;
  const { shadings } = shared;
  const material = new MeshBasicMaterial({ side: sideOf(shared), toneMapped: false, vertexColors: coloursTint, ...standing(look), ...picturing(picture, texture) });
  const keyed = shadings.keyed(look, tile).filter(({ shading }) => shading.isForUnlit === true);
  if (!coloursTint && keyed.length === 0) return material;
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, ...keyed.map(({ shading: { uniforms } }) => uniforms));
    for (const { shading } of [...keyed].reverse()) shadings.edit(shading, shader, look, tile);
    if (coloursTint) takeScreenColours(shader);
  };
  material.customProgramCacheKey = () => `meshhier-unlit-${[coloursTint, ...keyed.map(programKey)].join('-')}`;
  return material;
}

/// Surfaces with the same one share the program's part of a shading.
function programKey({ shading, key }: { readonly shading: Shading; readonly key: string }): string {
  return `${numberOf(shading.edit)}:${key}`;
}

/// Changes three's shaders for a look.
function edit(shader: Shader, { colours, cavities, material }: Look, vertexColors: boolean): void {
  replaceChunk(shader, 'fragmentShader', 'normal_fragment_begin', BACKS);
  if (vertexColors) takeScreenColours(shader);
  if (cavities && material !== 'relief') replaceChunk(shader, 'fragmentShader', 'normal_fragment_maps', CAVITIES);
  const height = colours === 'height' ? 'varying float vHeight;\n' : '';
  if (height !== '') replaceChunk(shader, 'vertexShader', 'begin_vertex', HEIGHT);
  if (height !== '') replaceChunk(shader, 'fragmentShader', 'color_fragment', RAMP);
  shader.vertexShader = `uniform vec3 upwards;\nuniform vec2 heights;\n${height}${shader.vertexShader}`;
  shader.fragmentShader = `uniform float outwards;\n${height}${shader.fragmentShader}`;
}

/// Facets are shown without their map, as they are.
function normalMap({ shading }: Look, normals: Texture | null): { normalMap?: Texture } {
  return normals === null || shading === 'flat' ? {} : { normalMap: normals };
}

function litMaterial(look: Look, { tile, texture, normals }: Painting, shared: SharedMaterials): MeshStandardMaterial | MeshMatcapMaterial {
  const { colours, cavities, shading } = look;
  const { outwards, upwards, heights } = shared;
  const vertexColors = colours === 'vertex' && tile.colours !== null && (texture === null || tile.coloursTint);
  const plain = look.material === 'matcap' ? CLAY : PLAIN;
  const own = { color: vertexColors || texture || colours === 'height' ? 0xffffff : plain, side: sideOf(shared), flatShading: shading === 'flat', vertexColors };
  const keyed = shared.shadings.keyed(look, tile);
  const shadings = keyed.map((each) => each.shading);
  const besides = shadings.map((each) => shared.shadings.ask(each, () => each.parameters?.(look) ?? {}, {}));
  const parameters = { ...own, ...standing(look), ...picturing(tile.picture, texture), ...normalMap(look, normals), ...(Object.assign({}, ...besides) as MaterialParameters) };
  const material = look.material === 'matcap'
    ? new MeshMatcapMaterial({ ...parameters, matcap: shared.matcap })
    : new MeshStandardMaterial({ ...parameters, roughness: texture ? 1 : 0.75, metalness: 0 });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { outwards, upwards, heights }, ...shadings.map(({ uniforms }) => uniforms));
    for (const each of [...shadings].reverse()) shared.shadings.edit(each, shader, look, tile); // the last one that replaces a chunk comes first in it
    edit(shader, look, vertexColors);
  };
  material.customProgramCacheKey = () => `meshhier-${[vertexColors, colours === 'height', cavities, look.material, ...keyed.map(programKey)].join('-')}`;
  return material;
}

/// True where tiles with pictures show them.
export function showsPictures({ colours, texture }: Look): boolean {
  return colours === 'vertex' && texture;
}

/// One tile's: programs are shared by all of a look.
export function surfaceMaterial(look: Look, painting: Painting, shared: SharedMaterials): SurfaceMaterial {
  const shown = showsPictures(look) ? painting : { ...painting, texture: null };
  return shown.texture !== null && shown.tile.picture?.unlit && !look.relight ? unlitMaterial(look, shown, shared) : litMaterial(look, shown, shared);
}

export function partitionColour(level: number, index: number): Color {
  return new Color().setHSL((index * GOLDEN + level * 0.13) % 1, 0.55, 0.6);
}

/// Green: none; yellow: as much as is allowed; red: eight times that and more.
export function errorColour(pixels: number, threshold: number): Color {
  const heat = Math.log2(1 + pixels / threshold) / Math.log2(9);
  return new Color().setHSL(0.36 * (1 - Math.min(1, heat)), 0.7, 0.5);
}

/// Gives a shader of edges or points what leaves out those that look away.
function showFacing(shader: Shader, hidesBacks: SharedMaterials['hidesBacks']): void {
  shader.uniforms.hidesBacks = hidesBacks;
  replaceChunk(shader, 'vertexShader', 'project_vertex', FACING);
  replaceChunk(shader, 'fragmentShader', 'clipping_planes_fragment', FACING_ONLY);
  shader.vertexShader = `uniform bool hidesBacks;\nvarying float facing;\n${shader.vertexShader}`;
  shader.fragmentShader = `varying float facing;\n${shader.fragmentShader}`;
}

function wireMaterial(hidesBacks: SharedMaterials['hidesBacks']): Material {
  const material = new LineBasicMaterial({ color: WIRES, transparent: true, opacity: 0.45, depthWrite: false });
  material.onBeforeCompile = (shader) => { showFacing(shader, hidesBacks); };
  material.customProgramCacheKey = () => 'meshhier-wires';
  return material;
}

/// Makes the material of points: round, and over the wires.
function pointMaterial(hidesBacks: SharedMaterials['hidesBacks'], color: number, size: number, vertexColors = false): Material {
  const material = new PointsMaterial({ color, size, vertexColors, sizeAttenuation: false, transparent: true });
  material.onBeforeCompile = (shader) => {
    replaceChunk(shader, 'fragmentShader', 'clipping_planes_fragment', ROUND);
    showFacing(shader, hidesBacks);
    takeScreenColours(shader);
  };
  material.customProgramCacheKey = () => 'meshhier-round';
  return material;
}

export function sharedMaterials(shadings = new Shadings()): SharedMaterials {
  const uniforms = { outwards: { value: 1 }, upwards: { value: new Vector3(0, 1, 0) }, heights: { value: new Vector2(0, 1) } };
  const hidesBacks = { value: false };
  const dots = { plain: pointMaterial(hidesBacks, DOTS, DOT_SIZE), coloured: pointMaterial(hidesBacks, 0xffffff, DOT_SIZE, true) };
  return { wires: wireMaterial(hidesBacks), points: pointMaterial(hidesBacks, POINTS, POINT_SIZE), dots, matcap: makeMatcap(), hidesBacks, shadings, ...uniforms };
}
