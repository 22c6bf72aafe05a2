// SPDX-License-Identifier: MIT
// In which ways the device that draws keeps pictures compressed.

/// Blocks of 4 x 4 texels, as glTF's viewers know them; `rgba`: none of them, four bytes a texel.
export type TexelFormat = 'etc2' | 'etc2_alpha' | 'bc1' | 'bc3' | 'bc7' | 'astc' | 'rgba';

/// The device decides: true where it takes a format, as sRGB too.
export interface DeviceFormats {
  readonly etc2: boolean;
  readonly s3tc: boolean;
  readonly bptc: boolean;
  readonly astc: boolean;
}

let found: DeviceFormats | null = null;

function ask(): DeviceFormats {
  const context = typeof OffscreenCanvas === 'undefined' ? document.createElement('canvas').getContext('webgl2') : new OffscreenCanvas(1, 1).getContext('webgl2');
  const names = new Set(context?.getSupportedExtensions() ?? []);
  context?.getExtension('WEBGL_lose_context')?.loseContext(); // a page has few of them
  return {
    etc2: names.has('WEBGL_compressed_texture_etc'),
    s3tc: names.has('WEBGL_compressed_texture_s3tc') && names.has('WEBGL_compressed_texture_s3tc_srgb'),
    bptc: names.has('EXT_texture_compression_bptc'),
    astc: names.has('WEBGL_compressed_texture_astc'),
  };
}

/// Asked once, where this is called: in a worker too.
export function deviceFormats(): DeviceFormats {
  return (found ??= ask());
}

/// The smallest that loses little. `isEtc1s`: half a byte a texel is all that the picture has; else UASTC, a byte.
export function chooseFormat({ etc2, s3tc, bptc, astc }: DeviceFormats, isEtc1s: boolean, hasAlpha: boolean): TexelFormat {
  const small = etc2 ? (hasAlpha ? 'etc2_alpha' : 'etc2') : s3tc ? (hasAlpha ? 'bc3' : 'bc1') : null;
  const exact = astc ? 'astc' : bptc ? 'bc7' : null;
  return (isEtc1s ? (small ?? exact) : (exact ?? small)) ?? 'rgba';
}
