// SPDX-License-Identifier: MIT
// Colours for numbers: perceptual ramps of the field, and colours for names.
import { ClampToEdgeWrapping, DataTexture, LinearFilter, NearestFilter, SRGBColorSpace } from 'three';
import type { RampName } from './ramp_names.js';
import type { AttributeLook } from './settings.js';

export { RAMPS, type RampName } from './ramp_names.js';

/// Colours of a screen, at equal steps. viridis and cividis (Nuñez, Anderton & Renslow 2018) are even to the eye, cividis also to eyes that see
/// few colours; turbo (Mikhailov 2019) tells more steps apart; coolwarm (Moreland 2009) has a middle, for signed values.
const STOPS: Readonly<Record<RampName, readonly number[]>> = {
  viridis: [0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725],
  cividis: [0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838],
  turbo: [0x30123b, 0x4662d7, 0x36aaf9, 0x1ae4b6, 0x72fe5e, 0xc8ef34, 0xfaba39, 0xf66b19, 0xcb2a04, 0x7a0403],
  coolwarm: [0x3b4cc0, 0x5977e3, 0x7b9ff9, 0x9ebeff, 0xc0d4f5, 0xdddcdc, 0xf2cbb7, 0xf7ac8e, 0xee8468, 0xd65244, 0xb40426],
};

type Rgb = readonly [number, number, number];

function rgbOf(hex: number): Rgb {
  return [hex >> 16, (hex >> 8) & 255, hex & 255];
}

/// Returns a ramp's colour at `part` of the way, 0 … 1; what lies outside has the colour of that end.
export function rampColour(name: RampName, part: number): Rgb {
  const stops = STOPS[name];
  const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1);
  const first = Math.min(Math.floor(at), stops.length - 2);
  const [a, b] = [rgbOf(stops[first]), rgbOf(stops[first + 1])];
  const mix = (k: number): number => Math.round(a[k] + (b[k] - a[k]) * (at - first));
  return [mix(0), mix(1), mix(2)];
}

/// The plain colour of models, and of values within the tolerance.
export const PLAIN = 0xb9b4ab;

/// How far along the ramp a value lies, 0 … 1 between the ends of the range: what is within the tolerance is cut out of the axis.
export function rampPart(value: number, [from, to]: readonly [number, number], tolerance: number | null): number {
  const beyond = (each: number): number => each - Math.min(Math.max(each, -(tolerance ?? 0)), tolerance ?? 0);
  return (beyond(value) - beyond(from)) / (beyond(to) - beyond(from) || 1);
}

/// The colour of a value of a quantity.
export function valueColour({ ramp, tolerance }: Pick<AttributeLook, 'ramp' | 'tolerance'>, range: readonly [number, number], value: number): Rgb {
  return tolerance !== null && Math.abs(value) <= tolerance ? rgbOf(PLAIN) : rampColour(ramp, rampPart(value, range, tolerance));
}

const GOLDEN = 0.6180339887498949; // colours of neighbours in a list lie far apart

/// Returns the colour of the label with that number in the list of all.
export function labelColour(number: number): Rgb {
  const hue = 6 * ((number * GOLDEN + 0.58) % 1);
  const [light, strength] = [[0.62, 0.62], [0.45, 0.7], [0.74, 0.5]][number % 3];
  const channel = (shift: number): number => {
    const k = (shift + 2 * hue) % 12;
    return Math.round(255 * (light - strength * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

const RAMP_TEXELS = 256;

function texture(texels: number, colourOf: (i: number) => readonly [...Rgb, number], smooth: boolean): DataTexture {
  const bytes = new Uint8Array(4 * texels);
  for (let i = 0; i < texels; ++i) bytes.set(colourOf(i), 4 * i);
  const made = new DataTexture(bytes, texels, 1);
  made.colorSpace = SRGBColorSpace;
  made.wrapS = made.wrapT = ClampToEdgeWrapping;
  made.minFilter = made.magFilter = smooth ? LinearFilter : NearestFilter;
  made.needsUpdate = true;
  return made;
}

export function rampTexture(name: RampName): DataTexture {
  return texture(RAMP_TEXELS, (i) => [...rampColour(name, i / (RAMP_TEXELS - 1)), 255], true);
}

/// A texel for each label from `first` on; those of `hidden` are clear.
export function labelTexture(first: number, texels: number, numberOf: (label: number) => number, hidden: readonly number[]): DataTexture {
  return texture(texels, (i) => [...labelColour(numberOf(first + i)), hidden.includes(first + i) ? 0 : 255], false);
}
