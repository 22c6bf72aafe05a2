// SPDX-License-Identifier: MIT
// Reads tiles of meshhier and draws cuts without cracks: docs/for_engines.md, as a program. No library.

/// The tree of a hierarchy of `partitions`; a node is [level, index].
export class Tree {
  constructor(partitions) {
    Object.assign(this, { partitions, depth: Math.ceil(Math.log2(partitions)) });
  }

  /// Goes down from the root: the partitions [first, end) that are left, and which halves were taken, a bit each.
  walk(levels, isRight) {
    let [first, end, path] = [0, this.partitions, 0];
    for (let l = 0; l < levels; ++l) {
      const middle = first + Math.ceil((end - first) / 2);
      const right = isRight(l, middle);
      [first, end, path] = right ? [middle, end, 2 * path + 1] : [first, middle, 2 * path];
    }
    return { first, end, path };
  }

  range([level, index]) {
    if (level === this.depth) return { first: index, end: index + 1 };
    return this.walk(level, (l) => (index >> (level - 1 - l)) & 1);
  }

  ancestor([level, index], above) {
    if (above === level || level < this.depth) return [above, index >> (level - above)];
    return [above, this.walk(above, (_, middle) => index >= middle).path];
  }

  /// The nodes with tiles below one. An early node, of one partition above the last level, has none: its partition stands for it.
  children([level, index]) {
    if (level === this.depth) return [];
    const { first, end } = this.range([level, index]);
    const middle = first + Math.ceil((end - first) / 2);
    return [[first, middle], [middle, end]].map(([from, to], k) => (to - from === 1 ? [this.depth, from] : [level + 1, 2 * index + k]));
  }
}

export const nameOf = ([level, index]) => `${level}/${index}`;

export function pathOf([level, index]) {
  const digits = (number, count) => String(number).padStart(count, '0');
  const group = index - (index % 10000);
  return `tiles/${digits(level, 2)}/${group > 0 ? `${digits(group, 6)}/` : ''}${digits(index, 6)}.glb`;
}

/// Error and sphere of each tile, by name. `bytes`: of tiles.bin.
export function readIndex(bytes) {
  const view = new DataView(bytes);
  const f32 = (at, count) => Array.from({ length: count }, (_, k) => view.getFloat32(at + 4 * k, true));
  return new Map(Array.from({ length: Number(view.getBigUint64(16, true)) }, (_, i) => {
    const at = 32 + 120 * i;
    const [low, high] = [f32(at + 60, 3), f32(at + 72, 3)];
    const centre = low.map((x, k) => (x + high[k]) / 2);
    return [nameOf([view.getUint32(at, true), view.getUint32(at + 4, true)]), { error: view.getFloat32(at + 48, true), centre, radius: Math.hypot(...high.map((x, k) => x - centre[k])) }];
  }));
}

/// A tile's file, positions relative to the origin. `lattice`: the manifest's storage.positions. Of hierarchies with
/// "storage.compression": "none", or "zlib" that the host has unpacked.
export function readTile(bytes, node, tree, lattice) {
  const view = new DataView(bytes);
  const jsonBytes = view.getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, jsonBytes)));
  if (gltf.extensionsRequired?.includes('EXT_meshopt_compression')) throw new Error('this reader takes tiles without meshopt');
  const start = 28 + jsonBytes; // of the binary part
  const tile = gltf.extensions.MESHHIER_tile;
  const section = (name, Type) => {
    const bufferView = gltf.bufferViews[tile[name] ?? -1];
    return bufferView ? new Type(bytes.slice(start + (bufferView.byteOffset ?? 0), start + (bufferView.byteOffset ?? 0) + bufferView.byteLength)) : new Type(0);
  };
  const accessor = (number) => {
    const { bufferView, componentType, count, type } = gltf.accessors[number];
    const { byteOffset = 0, byteStride } = gltf.bufferViews[bufferView];
    const [Type, width] = [{ 5120: Int8Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array }[componentType], { SCALAR: 1, VEC2: 2, VEC3: 3 }[type]];
    const stride = (byteStride ?? width * Type.BYTES_PER_ELEMENT) / Type.BYTES_PER_ELEMENT;
    const all = new Type(bytes.slice(start + byteOffset, start + byteOffset + count * stride * Type.BYTES_PER_ELEMENT));
    return Type === Float32Array && stride === width ? all : Float32Array.from({ length: count * width }, (_, i) => all[stride * Math.floor(i / width) + (i % width)]);
  };
  const { attributes } = gltf.meshes[0].primitives[0];
  const triangles = (number) => (number < 0 ? new Float32Array(0) : accessor(gltf.meshes[0].primitives[number].indices));
  const quantized = gltf.accessors[attributes.POSITION].componentType === 5123;
  const positions = accessor(attributes.POSITION).map((x, i) => (quantized ? x * lattice.step + lattice.corner[i % 3] : x));
  const { ownCount: own, ghostCount: ghosts, copyCount: copies } = tile;
  const [copyOf, splitOf] = [section('copyOf', own + ghosts <= 65535 ? Uint16Array : Uint32Array), section('splitOf', own + ghosts + copies <= 65535 ? Uint16Array : Uint32Array)];
  const placeOf = new Uint32Array(own + ghosts + copies + (tile.splitCount ?? 0)); // of each vertex
  placeOf.forEach((_, v) => {
    const vertex = v < own + ghosts + copies ? v : splitOf[v - own - ghosts - copies];
    placeOf[v] = vertex < own + ghosts ? vertex : copyOf[vertex - own - ghosts];
  });
  // Each neighbour has its own node and its ancestors below the common one, and the place where its ghosts' chains begin.
  let entry = 0;
  const starts = section('ghostStarts', Uint32Array);
  const neighbours = Array.from(section('neighbours', Uint32Array), (index, i) => {
    const nodes = [];
    for (let l = node[0]; nameOf(tree.ancestor([node[0], index], l)) !== nameOf(tree.ancestor(node, l)); --l) nodes.push(nameOf(tree.ancestor([node[0], index], l)));
    const neighbour = { index, nodes, entry, first: own + starts[i], end: own + starts[i + 1] };
    entry += nodes.length * (starts[i + 1] - starts[i]);
    return neighbour;
  });
  return {
    node, own, ghosts, positions, placeOf, neighbours,
    normals: attributes.NORMAL === undefined ? null : accessor(attributes.NORMAL),
    given: positions.slice(), // before ghosts move
    chains: section('ghostChains', Uint16Array),
    interior: triangles(tile.interiorPrimitive),
    border: triangles(tile.borderPrimitive),
  };
}

/// Moves the ghosts of a tile to where the cut shows them; returns the border triangles that it draws, three vertices each.
/// `shown`: the tiles of the cut by name.
export function resolveSeam(tile, shown) {
  const { node, own, ghosts, positions, placeOf, neighbours, chains, border } = tile;
  const isOurs = new Uint8Array(own + ghosts).fill(1); // of places: whether we draw triangles that touch them
  const at = Array.from({ length: own + ghosts }, (_, place) => place); // of places: which vertex of the cut
  for (const { index, nodes, entry, first, end } of neighbours) {
    const up = nodes.findIndex((name) => shown.has(name)); // 0: at our level, n: as its ancestor n levels up, -1: finer
    const other = shown.get(nodes[up]);
    isOurs.fill(up > 0 || (up === 0 && index > node[1]) ? 1 : 0, first, end);
    for (let ghost = first; other && ghost < end; ++ghost) {
      const vertex = chains[entry + (ghost - first) * nodes.length + up];
      at[ghost] = `${nodes[up]}:${vertex}`;
      positions.set(other.given.subarray(3 * vertex, 3 * vertex + 3), 3 * ghost);
    }
  }
  placeOf.forEach((place, vertex) => { if (place >= own && vertex >= own + ghosts) positions.copyWithin(3 * vertex, 3 * place, 3 * place + 3); });
  const drawn = [];
  for (let t = 0; t < border.length; t += 3) {
    const places = [0, 1, 2].map((k) => placeOf[border[t + k]]);
    // Two different places that are one vertex in this cut: the triangle has vanished.
    const vanished = [0, 1, 2].some((k) => places[k] !== places[(k + 1) % 3] && at[places[k]] === at[places[(k + 1) % 3]]);
    if (!vanished && places.every((place) => isOurs[place])) drawn.push(border[t], border[t + 1], border[t + 2]);
  }
  return drawn;
}
