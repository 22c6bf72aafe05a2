// The materials of tiles: three's own, so that any scene's lights do.
import { Color, DoubleSide, LineBasicMaterial, MeshStandardMaterial, PointsMaterial, type Material } from 'three';
import type { Look } from './settings.js';

const PLAIN = 0xb9b4ab;
const WIRES = 0x101418;
const POINTS = 0xd04a1e;
/// How far the surface stands back behind its own wires and points: more than programs differ by rounding.
const BEHIND = { slopes: 2, units: 16 };
const GOLDEN = 0.618034; // colours of neighbours in a list lie far apart

/// The input's colours are those of a screen; three adds in linear light.
const TO_LINEAR = `#include <color_vertex>
#ifdef USE_COLOR
  vColor.rgb = mix(vColor.rgb / 12.92, pow((vColor.rgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, vColor.rgb));
#endif`;

/// Looks of one key have the same surfaces.
export function surfaceKey({ colours, shading, wires, points }: Look): string {
  return [colours, shading, wires || points].join();
}

/// One tile's: programs are shared by all of a look.
export function surfaceMaterial(look: Look, hasColours: boolean): MeshStandardMaterial {
  const material = new MeshStandardMaterial({
    color: PLAIN,
    roughness: 0.75,
    metalness: 0,
    side: DoubleSide,
    flatShading: look.shading === 'flat',
    vertexColors: look.colours === 'vertex' && hasColours,
    polygonOffset: look.wires || look.points,
    polygonOffsetFactor: BEHIND.slopes,
    polygonOffsetUnits: BEHIND.units,
  });
  if (!material.vertexColors) return material;
  material.color.set(0xffffff);
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace('#include <color_vertex>', TO_LINEAR);
  };
  material.customProgramCacheKey = () => 'meshhier-colours';
  return material;
}

export function partitionColour(level: number, index: number): Color {
  return new Color().setHSL((index * GOLDEN + level * 0.13) % 1, 0.55, 0.6);
}

/// Green: none; yellow: as much as is allowed; red: eight times that and more.
export function errorColour(pixels: number, threshold: number): Color {
  const heat = Math.log2(1 + pixels / threshold) / Math.log2(9);
  return new Color().setHSL(0.36 * (1 - Math.min(1, heat)), 0.7, 0.5);
}

export function wireMaterial(): Material {
  return new LineBasicMaterial({ color: WIRES, transparent: true, opacity: 0.45 });
}

export function pointMaterial(): Material {
  return new PointsMaterial({ color: POINTS, size: 5, sizeAttenuation: false });
}
