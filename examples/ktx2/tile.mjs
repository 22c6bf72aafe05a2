// SPDX-License-Identifier: MIT
// A tile's GLB with its picture as KTX2.
import { gunzipSync, gzipSync } from 'node:zlib';
import { encodeToKTX2 } from 'ktx2-encoder';
import sharp from 'sharp';

const HEAD = 12; // bytes: magic, version, length
const CHUNK = 8; // bytes: length, type
const EXTENSION = 'KHR_texture_basisu';
const WEBP = 'EXT_texture_webp';

async function decode(bytes) {
  const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  return { data: new Uint8Array(data), width: info.width, height: info.height };
}

function padded(bytes, filler) {
  const rest = -bytes.length & 3;
  return rest === 0 ? bytes : Buffer.concat([bytes, Buffer.alloc(rest, filler)]);
}

function chunk(type, bytes) {
  const head = Buffer.alloc(CHUNK);
  head.writeUInt32LE(bytes.length, 0);
  head.write(type, 4, 'latin1');
  return [head, bytes];
}

function readGlb(bytes) {
  if (bytes.length < HEAD + CHUNK || bytes.toString('latin1', 0, 4) !== 'glTF') throw new Error('is no GLB');
  const jsonEnd = HEAD + CHUNK + bytes.readUInt32LE(HEAD);
  return { json: JSON.parse(bytes.toString('utf8', HEAD + CHUNK, jsonEnd)), binary: bytes.subarray(jsonEnd + CHUNK) };
}

function writeGlb(json, binary) {
  const chunks = [...chunk('JSON', padded(Buffer.from(JSON.stringify(json)), 0x20)), ...chunk('BIN\0', padded(binary, 0))];
  const head = Buffer.alloc(HEAD);
  head.write('glTF', 0, 'latin1');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(chunks.reduce((sum, { length }) => sum + length, HEAD), 8);
  return Buffer.concat([head, ...chunks]);
}

/// With the picture's name as others read it, and without that of WebP.
function rename(json) {
  const texture = json.textures[0];
  const source = texture.source ?? texture.extensions[WEBP].source;
  delete texture.source;
  texture.extensions = { [EXTENSION]: { source } };
  json.images[source].mimeType = 'image/ktx2';
  for (const list of ['extensionsUsed', 'extensionsRequired']) json[list] = [...(json[list] ?? []).filter((name) => name !== WEBP), EXTENSION];
}

/// `bytes`: of a tile's file, packed by gzip or not; so is the result. A tile without a picture stays as it is.
export async function convertTile(bytes, isEtc1s) {
  const isPacked = bytes[0] === 0x1f && bytes[1] === 0x8b;
  const { json, binary } = readGlb(isPacked ? gunzipSync(bytes) : bytes);
  if (json.images === undefined) return bytes;
  const view = json.bufferViews[json.images[0].bufferView];
  const begin = view.byteOffset ?? 0;
  if (json.images.length !== 1 || json.bufferViews.at(-1) !== view) throw new Error('has more than one picture, or something behind it: is it a tile of meshhier?');
  const picture = await encodeToKTX2(binary.subarray(begin, begin + view.byteLength), {
    imageDecoder: decode, isUASTC: !isEtc1s, needSupercompression: !isEtc1s, qualityLevel: 192,
    generateMipmap: true, isPerceptual: true, isSetKTX2SRGBTransferFunc: true,
  });
  view.byteLength = picture.length;
  json.buffers[0].byteLength = begin + picture.length;
  rename(json);
  const made = writeGlb(json, Buffer.concat([binary.subarray(0, begin), picture]));
  return isPacked ? gzipSync(made, { level: 9 }) : made;
}
