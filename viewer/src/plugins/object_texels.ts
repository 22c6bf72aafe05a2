// SPDX-License-Identifier: MIT
// A texel an object, for shaders: all 2^24 that there may be have room.
import { DataTexture, NearestFilter, RedFormat, RGBAFormat, SRGBColorSpace, UnsignedByteType } from 'three';

const ROW = 4096;

/// The texel of an object, in GLSL; `object`: its number, as a float.
export function texelOf(texture: string, object: string): string {
  return `texelFetch(${texture}, ivec2(int(${object} + 0.5) & ${ROW - 1}, int(${object} + 0.5) >> 12), 0)`;
}

function rowsOf(objects: number): number {
  return Math.max(1, Math.ceil(objects / ROW));
}

/// Returns room for so many objects, in whole rows.
export function texelBytes(objects: number, channels: 1 | 4): Uint8Array<ArrayBuffer> {
  return new Uint8Array(channels * ROW * rowsOf(objects));
}

/// `bytes`: of texelBytes(); with four channels the colours of a screen.
export function texelTexture(bytes: Uint8Array<ArrayBuffer>, channels: 1 | 4): DataTexture {
  const made = new DataTexture(bytes, ROW, bytes.length / channels / ROW, channels === 1 ? RedFormat : RGBAFormat, UnsignedByteType);
  made.minFilter = made.magFilter = NearestFilter;
  if (channels === 4) made.colorSpace = SRGBColorSpace;
  made.needsUpdate = true;
  return made;
}
