// Which object a ray meets first: in an OBJ file as three.js reads it, or in tiles, whose triangles are read here.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { MeshoptDecoder } from 'meshoptimizer';
import * as THREE from 'three';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { readGlb } from '../gltf/glb.mjs';

const ARRAYS = { 5121: Uint8Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const WIDTHS = { SCALAR: 1, VEC3: 3 };
const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide });

/// A tile's JSON, and its accessors as plain arrays.
class TileReader {
  constructor(bytes) {
    const jsonBytes = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
    this.json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonBytes)));
    this.binary = bytes.subarray(28 + jsonBytes);
  }

  view(index) {
    const { byteOffset, byteLength, byteStride, extensions } = this.json.bufferViews[index];
    const packed = extensions?.EXT_meshopt_compression;
    if (packed === undefined) return { bytes: this.binary.subarray(byteOffset, byteOffset + byteLength), byteStride };
    const bytes = new Uint8Array(byteLength);
    const source = this.binary.subarray(packed.byteOffset, packed.byteOffset + packed.byteLength);
    MeshoptDecoder.decodeGltfBuffer(bytes, packed.count, packed.byteStride, source, packed.mode, packed.filter);
    return { bytes, byteStride };
  }

  accessor(index) {
    const { bufferView, byteOffset = 0, componentType, count, type } = this.json.accessors[index];
    const { bytes, byteStride } = this.view(bufferView);
    const [ArrayType, width] = [ARRAYS[componentType], WIDTHS[type]];
    const stride = byteStride ?? width * ArrayType.BYTES_PER_ELEMENT;
    const values = new ArrayType(width * count);
    for (let i = 0; i < count; ++i) {
      const begin = byteOffset + i * stride;
      values.set(new ArrayType(bytes.slice(begin, begin + width * ArrayType.BYTES_PER_ELEMENT).buffer), width * i);
    }
    return values;
  }
}

/// The meshes of a tile in the tileset's coordinates; an object's number is a vertex's attribute.
function tileMeshes(file) {
  const reader = new TileReader(readGlb(file));
  const { nodes: [{ matrix }], meshes: [{ primitives }] } = reader.json;
  const toTileset = new THREE.Matrix4().makeRotationX(Math.PI / 2).multiply(new THREE.Matrix4().fromArray(matrix));
  return primitives.map(({ attributes, indices }) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(reader.accessor(attributes.POSITION)), 3));
    geometry.setAttribute('object', new THREE.BufferAttribute(reader.accessor(attributes._OBJECT), 1));
    geometry.setIndex(new THREE.BufferAttribute(reader.accessor(indices), 1));
    geometry.applyMatrix4(toTileset);
    return new THREE.Mesh(geometry, material);
  });
}

function nearest(meshes, { from, direction }) {
  const ray = new THREE.Raycaster(new THREE.Vector3(...from), new THREE.Vector3(...direction));
  return ray.intersectObjects(meshes, true)[0];
}

export class ObjectJudge {
  #tiles = new Map();

  constructor(obj, hierarchy) {
    this.hierarchy = hierarchy;
    this.original = new OBJLoader().parse(readFileSync(obj, 'utf8'));
    this.original.traverse((node) => { if (node.isMesh) node.material = material; });
    const bytewise = (one, other) => Buffer.compare(Buffer.from(one), Buffer.from(other));
    this.names = this.original.children.map(({ name }) => name).sort(bytewise);
  }

  /// The name of the object that is met in the original; undefined: none.
  inOriginal(ray) {
    return nearest(this.original.children, ray)?.object.name;
  }

  /// The name of the object that is met in tiles, by their files' addresses.
  inTiles(addresses, ray) {
    const hit = nearest(addresses.flatMap((address) => this.#meshes(address)), ray);
    if (hit === undefined) return undefined;
    const objects = hit.object.geometry.getAttribute('object');
    const [one, ...others] = [hit.face.a, hit.face.b, hit.face.c].map((corner) => objects.getX(corner));
    return others.every((other) => other === one) ? this.names[one] : `corners of ${[one, ...others]}`;
  }

  #meshes(address) {
    const file = path.join(this.hierarchy, /tiles\/.*/.exec(address)[0]);
    if (!this.#tiles.has(file)) this.#tiles.set(file, tileMeshes(file));
    return this.#tiles.get(file);
  }
}

await MeshoptDecoder.ready;
