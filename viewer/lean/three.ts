// SPDX-License-Identifier: MIT
// three for the page, the element and the page in one file, without what nothing of theirs draws.
//
// Problem: three comes as two files, and a renderer needs nearly all of both: 535 kB, most of what a phone waits for before the first picture.
// Idea: it is built from its sources instead. Shaders lose what is only for lights, maps and materials that no scene here has; methods that
// nobody calls and stages of the renderer that nothing reaches are left out.
// Invariant: pictures are the same. A build that contains something whose shaders are left out fails, and names it.
import path from 'node:path';
import type { Plugin, Rollup } from 'vite';
import { leanShader, type KnownMacros } from './glsl.js';

const SOURCES = '/three/src/';
const SHADERS = /\/renderers\/shaders\/Shader(?:Chunk|Lib)\/(\w+)\.glsl\.js$/;

/// Features of three's programs that none of these scenes has.
const MACROS: KnownMacros = {
  absent: new RegExp(`^(?:${[
    'USE_(?:CLEARCOAT|IRIDESCENCE|SHEEN|RETROREFLECTION|ANISOTROPY|DIFFUSE_ROUGHNESS|TRANSMISSION|THICKNESS|SPECULAR|DISPERSION)\\w*', 'IOR', 'PHYSICAL', // MeshPhysicalMaterial
    'USE_(?:ENVMAP|LIGHTMAP|AOMAP|BUMPMAP|DISPLACEMENTMAP|ROUGHNESSMAP|METALNESSMAP|EMISSIVEMAP|ALPHAMAP|GRADIENTMAP|NORMALMAP_OBJECTSPACE)', 'ENVMAP_\\w+', 'USE_ALPHAHASH',
    'USE_(?:SKINNING|MORPH\\w+|BATCHING\\w*|INSTANCING\\w*)',
    'USE_FOG', 'FOG_EXP2', 'USE_SHADOWMAP', 'SHADOWMAP_\\w+', 'USE_LIGHT_PROBES', 'USE_LOGARITHMIC_DEPTH_BUFFER', 'USE_REVERSED_DEPTH_BUFFER', 'LAMBERT', 'PHONG', 'TOON',
    'DECODE_VIDEO_TEXTURE\\w*', 'DITHERING',
  ].join('|')})$`),
  zeros: /^NUM_(?:(?:POINT|SPOT|RECT_AREA|SUN)_LIGHTS|\w+_SHADOWS|SPOT_LIGHT_\w+|LIGHT_PROBE_GRIDS)$/,
};

/// Programs of materials that are not drawn.
const UNUSED_SHADERS = /^(?:meshlambert|meshphong|meshtoon|meshdistance|linedashed|sprite|equirect|cube|backgroundCube|background|shadow|distance|vsm)$/;

/// What these would draw needs what is left out; a few are there for others, which do not draw with them.
const UNDRAWN = /\/(?:MeshPhysicalMaterial|MeshLambertMaterial|MeshPhongMaterial|MeshToonMaterial|LineDashedMaterial|SpriteMaterial|Sprite|SkinnedMesh|InstancedMesh|BatchedMesh|Fog|FogExp2|PointLight|SpotLight|RectAreaLight|LightProbe)\.js$/;

/// Stages of the renderer that nothing reaches, and what stands in for them.
const STAGES: Readonly<Record<string, string>> = {
  WebGLEnvironments: 'export function WebGLEnvironments() { return { get: () => null, dispose() {} }; }',
  WebGLShadowMap: 'export function WebGLShadowMap() { this.enabled = false; this.autoUpdate = true; this.needsUpdate = false; this.type = 1; this.render = () => {}; }',
  WebGLMorphtargets: 'export function WebGLMorphtargets() { return { update() {} }; }',
  WebGLUniformsGroups: 'export function WebGLUniformsGroups() { return { bind() {}, update() {}, dispose() {} }; }',
};

/// Methods that write objects to files, or read them.
const UNCALLED = /^(?:toJSON|fromJSON)$/;

interface Span {
  readonly start: number;
  readonly end: number;
}

type Method = Span & { readonly type: string; readonly key: { readonly name?: string } };

function isClass(node: { type: string }): node is Rollup.AstNode & { body: { body: Method[] } } {
  return node.type === 'ClassDeclaration';
}

/// Returns the methods of a module's classes that nobody calls, the last one first.
function uncalled(program: { body: readonly { type: string }[] }): Span[] {
  const methods = program.body.filter(isClass).flatMap(({ body }) => body.body);
  return methods.filter(({ type, key }) => type === 'MethodDefinition' && UNCALLED.test(key.name ?? '')).reverse();
}

function stageOf(id: string): string | undefined {
  return STAGES[path.basename(id, '.js')];
}

/// Builds from three's sources, leaner; programs that run from node_modules, as tests do, have three as it is.
export function leanThree(): Plugin {
  return {
    name: 'lean-three',
    apply: 'build',
    enforce: 'pre',
    resolveId: (source) => (source === 'three' ? path.resolve('node_modules/three/src/Three.js') : null),
    load: (id) => (id.includes(SOURCES) ? stageOf(id) : null),
    transform(code, id) {
      if (!id.includes(SOURCES)) return null;
      const shader = SHADERS.exec(id);
      if (shader !== null) {
        return { code: code.replace(/\/\* glsl \*\/\s*`([^`]*)`/g, (_, text: string) => JSON.stringify(UNUSED_SHADERS.test(shader[1]) ? '' : leanShader(text, MACROS))), map: null };
      }
      let lean = code;
      for (const { start, end } of uncalled(this.parse(code))) lean = lean.slice(0, start) + lean.slice(end);
      return { code: lean, map: null };
    },
    generateBundle(_, bundle) {
      const modules = Object.values(bundle).flatMap((part) => (part.type === 'chunk' ? Object.entries(part.modules) : []));
      for (const [id, { renderedLength }] of modules)
        if (renderedLength > 0 && id.includes(SOURCES) && UNDRAWN.test(id)) this.error(`${path.basename(id)} is drawn by shaders that lean/three.ts leaves out: keep them there`);
    },
  };
}
