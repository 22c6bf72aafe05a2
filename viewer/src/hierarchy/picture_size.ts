// SPDX-License-Identifier: MIT
// Tells how large a picture is, out of the beginning of its file, before anything decodes it.
import { FORMATS } from './formats.js';

export interface Size {
  readonly width: number;
  readonly height: number;
}

type Read = (bytes: DataView) => Size | null;

const PNG_BYTES = 24;
const PNG = [0x89504e47, 0x0d0a1a0a, 13, 0x49484452]; // signature, then a chunk of 13 bytes, IHDR

function ofPng(bytes: DataView): Size | null {
  if (bytes.byteLength < PNG_BYTES || PNG.some((word, i) => bytes.getUint32(4 * i) !== word)) return null;
  return { width: bytes.getUint32(16), height: bytes.getUint32(20) };
}

const START_OF_IMAGE = 0xffd8;
const FRAME_BYTES = 9; // of a frame's header: marker, length, bits, height, width

/// Markers of frames lie among these; three of that range are none.
function isFrame(marker: number): boolean {
  return marker >= 0xc0 && marker <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(marker);
}

function ofJpeg(bytes: DataView): Size | null {
  if (bytes.byteLength < 2 || bytes.getUint16(0) !== START_OF_IMAGE) return null;
  for (let at = 2; at + FRAME_BYTES <= bytes.byteLength; ) {
    if (bytes.getUint8(at) !== 0xff) return null;
    const marker = bytes.getUint8(at + 1);
    if (isFrame(marker)) return { width: bytes.getUint16(at + 7), height: bytes.getUint16(at + 5) };
    // A segment is as long as it says; what fills up before a marker is one byte.
    at += marker === 0xff ? 1 : 2 + bytes.getUint16(at + 2);
  }
  return null;
}

const WEBP_BYTES = 30;
const [RIFF, WEBP, LOSSY, LOSSLESS, EXTENDED] = ['RIFF', 'WEBP', 'VP8 ', 'VP8L', 'VP8X'].map((text) =>
  new DataView(new TextEncoder().encode(text).buffer).getUint32(0));

function ofWebp(bytes: DataView): Size | null {
  if (bytes.byteLength < WEBP_BYTES || bytes.getUint32(0) !== RIFF || bytes.getUint32(8) !== WEBP) return null;
  const chunk = bytes.getUint32(12);
  const u24 = (at: number): number => bytes.getUint16(at, true) + 65536 * bytes.getUint8(at + 2);
  if (chunk === LOSSY) return { width: bytes.getUint16(26, true) & 0x3fff, height: bytes.getUint16(28, true) & 0x3fff };
  if (chunk === LOSSLESS) return { width: 1 + (u24(21) & 0x3fff), height: 1 + ((bytes.getUint32(21, true) >>> 14) & 0x3fff) };
  return chunk === EXTENDED ? { width: 1 + u24(24), height: 1 + u24(27) } : null;
}

export const KTX2 = 'image/ktx2';
const KTX2_BYTES = 28;
const KTX2_MARK = [0xab4b5458, 0x203230bb, 0x0d0a1a0a];

/// Both sides are multiples of 4, as blocks are.
function ofKtx2(bytes: DataView): Size | null {
  if (bytes.byteLength < KTX2_BYTES || KTX2_MARK.some((word, i) => bytes.getUint32(4 * i) !== word)) return null;
  const size = { width: bytes.getUint32(20, true), height: bytes.getUint32(24, true) };
  return size.width % 4 === 0 && size.height % 4 === 0 ? size : null;
}

const READS: Readonly<Record<(typeof FORMATS.pictures)[number]['name'], Read>> = { jpeg: ofJpeg, png: ofPng, webp: ofWebp, ktx2: ofKtx2 };

/// Null of what is no picture of that type.
export function pictureSize(bytes: Uint8Array, type: string): Size | null {
  const format = FORMATS.pictures.find((each) => each.type === type);
  return format === undefined ? null : READS[format.name](new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength));
}
