// SPDX-License-Identifier: MIT
// Encodes and decodes ETC1S in KTX2 (Basis Universal) for a program that speaks to it by one socket, which is its standard input and output: images/ktx2_coder.cpp.
// It is done when that is closed, or after a failure. Numbers are unsigned, 32 bits, little endian.
//
//   greeting   PROTOCOL
//   request    KIND, width, height, quality, byte count, then the bytes: of an encoding red, green, blue, alpha of each texel; of a decoding a KTX2
//   answer     0, byte count, then the bytes: a KTX2; or red, green, blue, alpha of each texel
//           or 1, byte count, then why it cannot be, in UTF-8
import { readSync, writeSync } from 'node:fs';
import createBasis from './node_modules/ktx2-encoder/dist/basis/basis_encoder.js';

const PROTOCOL = 2;
const KINDS = { encode: 0, decode: 1 };
const [INPUT, OUTPUT] = [0, 1];

const ETC1S_EFFORT = 1; // 0 ... 6; 2 takes 1.7 times as long for 0.1 dB
const MOST_ETC1S_QUALITY = 255;
const RAW_PIXELS = 0;
const RGBA32 = 13;
const HEAD = 20; // bytes of a request's
const SLACK = 65536;

/// Null at the end of the input.
function read(count) {
  const bytes = Buffer.allocUnsafe(count);
  for (let at = 0; at < count; ) {
    const more = readSync(INPUT, bytes, at, count - at, null);
    if (more === 0) return null;
    at += more;
  }
  return bytes;
}

function write(bytes) {
  for (let at = 0; at < bytes.length; ) at += writeSync(OUTPUT, bytes, at, bytes.length - at);
}

function words(...values) {
  const bytes = Buffer.alloc(4 * values.length);
  values.forEach((value, i) => bytes.writeUInt32LE(value, 4 * i));
  return bytes;
}

function settle(encoder, quality) {
  encoder.setCreateKTX2File(true);
  encoder.setUASTC(false);
  encoder.setPerceptual(true);
  encoder.setKTX2AndBasisSRGBTransferFunc(true);
  encoder.setMipGen(true);
  encoder.setMipFilter('box'); // as devices do it: nothing of another chart comes in
  encoder.setMipSRGB(true);
  encoder.setMipWrapping(false);
  encoder.setQualityLevel(Math.max(1, Math.round((quality * MOST_ETC1S_QUALITY) / 100)));
  encoder.setETC1SCompressionLevel(ETC1S_EFFORT);
}

function encode(basis, width, height, quality, texels) {
  const encoder = new basis.BasisEncoder();
  try {
    settle(encoder, quality);
    if (!encoder.setSliceSourceImage(0, texels, width, height, RAW_PIXELS)) throw new Error('the encoder does not take its texels');
    const made = new Uint8Array(Math.ceil((4 / 3) * texels.length) + SLACK);
    const count = encoder.encode(made);
    if (count === 0) throw new Error('the encoder does not say why');
    return made.subarray(0, count);
  } finally {
    encoder.delete();
  }
}

function decode(basis, width, height, bytes) {
  const file = new basis.KTX2File(bytes);
  try {
    if (!file.isValid() || file.getWidth() !== width || file.getHeight() !== height || !file.startTranscoding()) throw new Error('it is no KTX2 of Basis Universal, or broken');
    const texels = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, RGBA32));
    if (texels.length !== 4 * width * height || !file.transcodeImage(texels, 0, 0, 0, RGBA32, 0, -1, -1)) throw new Error('it is broken');
    return texels;
  } finally {
    file.close();
    file.delete();
  }
}

async function main() {
  const silent = () => {};
  const basis = await createBasis({ print: silent, printErr: silent });
  basis.initializeBasis();
  write(words(PROTOCOL));
  for (let head = read(HEAD); head !== null; head = read(HEAD)) {
    const [kind, width, height, quality, count] = [0, 4, 8, 12, 16].map((at) => head.readUInt32LE(at));
    const bytes = read(count);
    if (bytes === null) return;
    let [status, answer] = [0, bytes];
    try {
      answer = kind === KINDS.decode ? decode(basis, width, height, bytes) : encode(basis, width, height, quality, bytes);
    } catch (error) {
      [status, answer] = [1, Buffer.from(error instanceof Error ? error.message : String(error))];
    }
    write(words(status, answer.length));
    write(answer);
    if (status !== 0) return; // what failed may have left the library in a bad state
  }
}

await main();
