// Tiles as bytes (docs/file_format.md, section 4), made by hand.

export interface TileParts {
  readonly own: number;
  readonly ghosts?: number;
  /// x, y, z of each vertex.
  readonly positions: readonly number[];
  readonly normals?: readonly number[];
  readonly interior: readonly number[];
  readonly border?: readonly number[];
  readonly copyOf?: readonly number[];
  readonly level?: number;
  readonly index?: number;
  readonly neighbours?: readonly number[];
  readonly ghostStarts?: readonly number[];
  readonly chains?: readonly number[];
}

/// glTF binary; `change`: what is different in MESHHIER_tile.
export function tileBytes(parts: TileParts, change: Record<string, number> = {}): Uint8Array {
  const { own, ghosts = 0, positions, normals, interior, border = [], copyOf = [], neighbours = [], ghostStarts = [], chains = [] } = parts;
  const chunks: Uint8Array[] = [];
  const bufferViews: object[] = [];
  let end = 0;
  const section = (values: ArrayBufferView): number => {
    if (values.byteLength === 0) return -1;
    const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
    chunks.push(bytes, new Uint8Array(-bytes.length & 3));
    bufferViews.push({ byteOffset: end, byteLength: bytes.length });
    end += bytes.length + (-bytes.length & 3);
    return bufferViews.length - 1;
  };
  const accessors = [{ bufferView: section(Float32Array.from(positions)), componentType: 5126, count: positions.length / 3, type: 'VEC3' }];
  const attributes: Record<string, number> = { POSITION: 0 };
  if (normals) attributes.NORMAL = accessors.push({ bufferView: section(Float32Array.from(normals)), componentType: 5126, count: normals.length / 3, type: 'VEC3' }) - 1;
  const primitives: object[] = [];
  const primitive = (corners: readonly number[]): number => {
    if (corners.length === 0) return -1;
    const indices = accessors.push({ bufferView: section(Uint16Array.from(corners)), componentType: 5123, count: corners.length, type: 'SCALAR' }) - 1;
    return primitives.push({ attributes, indices, mode: 4 }) - 1;
  };
  const extension = {
    version: 2, level: parts.level ?? 0, index: parts.index ?? 0, ownCount: own, rimCount: own, ghostCount: ghosts, copyCount: copyOf.length,
    neighbourCount: neighbours.length, chainEntryCount: chains.length, interiorCount: interior.length / 3, borderCount: border.length / 3,
    interiorPrimitive: primitive(interior), borderPrimitive: primitive(border), neighbours: section(Uint32Array.from(neighbours)),
    ghostStarts: section(Uint32Array.from(ghostStarts)), ghostChains: section(Uint16Array.from(chains)), copyOf: section(Uint16Array.from(copyOf)), ...change,
  };
  const text = JSON.stringify({ nodes: [{}], meshes: [{ primitives }], accessors, bufferViews, extensions: { MESHHIER_tile: extension } });
  return container(text.padEnd(Math.ceil(text.length / 4) * 4), chunks, end);
}

function container(text: string, chunks: readonly Uint8Array[], binBytes: number): Uint8Array {
  const bytes = new Uint8Array(28 + text.length + binBytes);
  const view = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.length, text.length, 0x4e4f534a].forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  bytes.set(new TextEncoder().encode(text), 20);
  view.setUint32(20 + text.length, binBytes, true);
  view.setUint32(24 + text.length, 0x004e4942, true);
  let at = 28 + text.length;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
}
