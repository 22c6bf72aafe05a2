// SPDX-License-Identifier: MIT
// How a ball of clay looks in a bright room: what is seen of a surface by its normal alone.
import { DataTexture, LinearFilter, SRGBColorSpace } from 'three';

const SIDE = 128;

type Colour = readonly [number, number, number];

/// Without a colour of its own: the surface's comes on top.
const DARK: Colour = [52, 48, 52];
const BODY: Colour = [200, 194, 188];
const BRIGHT: Colour = [255, 252, 246];
const RIM: Colour = [176, 196, 222];

function mixed(a: Colour, b: Colour, part: number): Colour {
  return [0, 1, 2].map((k) => a[k] + (b[k] - a[k]) * part) as unknown as Colour;
}

function smooth(from: number, to: number, value: number): number {
  const t = Math.min(1, Math.max(0, (value - from) / (to - from)));
  return t * t * (3 - 2 * t);
}

/// Returns the colour for a normal in view: x to the right, y up; z towards the eye.
function shade(x: number, y: number, z: number): Colour {
  const key = -0.5 * x + 0.62 * y + 0.6 * z;
  const body = mixed(DARK, BODY, smooth(-0.75, 0.65, key));
  const lit = mixed(body, BRIGHT, 0.85 * smooth(0.62, 1.02, key) ** 2);
  return mixed(lit, RIM, 0.5 * smooth(0.2, 0.95, 0.8 * x - 0.5 * y) * (1 - z) ** 1.5);
}

export function makeMatcap(): DataTexture {
  const pixels = new Uint8Array(4 * SIDE * SIDE);
  for (let row = 0; row < SIDE; ++row)
    for (let column = 0; column < SIDE; ++column) {
      const [x, y] = [(2 * (column + 0.5)) / SIDE - 1, (2 * (row + 0.5)) / SIDE - 1];
      const length = Math.max(1, Math.hypot(x, y));
      const z = Math.sqrt(Math.max(0, 1 - (x / length) ** 2 - (y / length) ** 2));
      pixels.set([...shade(x / length, y / length, z), 255], 4 * (SIDE * row + column));
    }
  const texture = new DataTexture(pixels, SIDE, SIDE);
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
