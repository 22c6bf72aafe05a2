// Compares compressed hierarchies with their uncompressed twins, bit for bit, with meshoptimizer's
// own JavaScript decoder.
//
//   node compare.mjs COMPRESSED PLAIN
//
// Both are directories with the same .glb files below. Every section must decode to the twin's
// bytes, lists of triangles up to their order and the corner they begin with; all else of the JSON
// must be equal. Exit code 0: no difference; 1: there is one, or there is no file; 2: wrong use;
// 77: the decoder is not installed (run `npm ci` here).
import path from 'node:path';
import { glbFiles, readGlb, required } from './glb.mjs';

const EXTENSION = 'EXT_meshopt_compression';

function open(file) {
  const bytes = readGlb(file);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const jsonBytes = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonBytes)));
  return { json, bin: bytes.subarray(28 + jsonBytes) };
}

// The bytes that accessors see of a buffer view.
function viewBytes({ json, bin }, number, decoder) {
  const view = json.bufferViews[number];
  const packed = view.extensions?.[EXTENSION];
  if (!packed) {
    if (view.buffer !== 0) throw new Error(`view ${number} is in buffer ${view.buffer}`);
    return bin.slice(view.byteOffset, view.byteOffset + view.byteLength);
  }
  if (packed.buffer !== 0 || view.byteLength !== packed.count * packed.byteStride)
    throw new Error(`view ${number} is not what its extension says`);
  const target = new Uint8Array(packed.count * packed.byteStride);
  const source = bin.subarray(packed.byteOffset, packed.byteOffset + packed.byteLength);
  decoder.decodeGltfBuffer(
    target, packed.count, packed.byteStride, source, packed.mode, packed.filter);
  return target;
}

// Triangles as texts, the smallest corner first, ascending.
function triangles(bytes, corners) {
  const wide = bytes.length / corners === 4;
  const numbers = wide ? new Uint32Array(bytes.buffer) : new Uint16Array(bytes.buffer);
  const list = [];
  for (let i = 0; i < corners; i += 3) {
    const t = [...numbers.subarray(i, i + 3)];
    const first = t.indexOf(Math.min(...t));
    list.push([...t.slice(first), ...t.slice(0, first)].join(' '));
  }
  return list.sort();
}

function same(a, b) {
  return a.length === b.length && a.every((value, i) => value === b[i]);
}

// The JSON without what compression changes.
function rest(json) {
  const { bufferViews, buffers, extensionsUsed, extensionsRequired, ...others } = json;
  const views = bufferViews?.map(({ byteLength, byteStride, target }) => [
    byteLength, byteStride, target]);
  const extensions = [extensionsUsed, extensionsRequired ?? []].map((names) =>
    names.filter((name) => name !== EXTENSION));
  return JSON.stringify([others, views, extensions]);
}

function differences(packed, plain, decoder) {
  const found = rest(packed.json) === rest(plain.json) ? [] : ['the JSON differs'];
  const indices = new Set(
    (plain.json.meshes ?? []).flatMap(({ primitives }) =>
      primitives.filter(({ mode }) => mode === 4).map((primitive) => primitive.indices)));
  for (let i = 0; i < (plain.json.bufferViews ?? []).length; i += 1) {
    const a = viewBytes(packed, i, decoder);
    const b = viewBytes(plain, i, decoder);
    const count = plain.json.accessors[i]?.count;
    const equal = indices.has(i) ? same(triangles(a, count), triangles(b, count)) : same(a, b);
    if (!equal) found.push(`buffer view ${i} differs`);
  }
  return found;
}

async function main([compressed, plain]) {
  if (!plain) {
    console.error('use: node compare.mjs COMPRESSED PLAIN');
    return 2;
  }
  const { MeshoptDecoder } = await required('meshoptimizer', () => import('meshoptimizer/decoder'));
  await MeshoptDecoder.ready;
  const files = glbFiles(plain).map((file) => path.relative(plain, file));
  let packedViews = 0;
  let different = 0;
  const others = glbFiles(compressed).length - files.length;
  for (const file of files) {
    const packed = open(path.join(compressed, file));
    let found;
    try {
      found = differences(packed, open(path.join(plain, file)), MeshoptDecoder);
    } catch (error) {
      found = [String(error)];
    }
    packedViews += (packed.json.bufferViews ?? []).filter((view) => view.extensions).length;
    different += found.length;
    for (const difference of found) console.log(`${file}: ${difference}`);
  }
  if (others !== 0) console.log(`${others} more files in ${compressed}`);
  console.log(`${files.length} files, ${packedViews} compressed views: ${different} differences`);
  return different === 0 && others === 0 && files.length > 0 ? 0 : 1;
}

process.exit(await main(process.argv.slice(2)));
