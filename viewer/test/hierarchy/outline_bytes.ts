// SPDX-License-Identifier: MIT
// Makes outlines for tests, good and bad ones.

export interface OutlineParts {
  positions?: number[];
  segments?: number[];
  node?: Record<string, unknown>;
  vertexCount?: number;
  segmentCount?: number;
  formSegmentCount?: number;
  version?: number;
}

function jsonBytes(parts: OutlineParts): Uint8Array {
  const positions = parts.positions ?? [];
  const segments = parts.segments ?? [];
  const MESHHIER_outline = {
    version: parts.version ?? 1,
    vertexCount: parts.vertexCount ?? positions.length / 3,
    segmentCount: parts.segmentCount ?? segments.length / 2,
    ...(parts.formSegmentCount === undefined ? {} : { formSegmentCount: parts.formSegmentCount }),
  };
  const text = JSON.stringify({ extensions: { MESHHIER_outline }, nodes: [parts.node ?? { mesh: 0 }] });
  return new TextEncoder().encode(text.padEnd(1024));
}

function binBytes(positions: number[], segments: number[]): Uint8Array {
  const short = positions.length / 3 <= 65535;
  const corners = short ? new Uint16Array(segments) : new Uint32Array(segments);
  const bytes = new Uint8Array(4 * positions.length + corners.byteLength);
  bytes.set(new Uint8Array(new Float32Array(positions).buffer));
  bytes.set(new Uint8Array(corners.buffer), 4 * positions.length);
  return bytes;
}

/// The file that `parts` make; what they leave out is as it should be.
export function outlineBytes(parts: OutlineParts): Uint8Array {
  const json = jsonBytes(parts);
  const bin = binBytes(parts.positions ?? [], parts.segments ?? []);
  const tail = bin.byteLength > 0 ? 8 + bin.byteLength : 0;
  const bytes = new Uint8Array(20 + json.byteLength + tail);
  const view = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.byteLength, json.byteLength, 0x4e4f534a].forEach((word, i) => { view.setUint32(4 * i, word, true); });
  bytes.set(json, 20);
  if (tail === 0) return bytes;
  view.setUint32(20 + json.byteLength, bin.byteLength, true);
  view.setUint32(24 + json.byteLength, 0x004e4942, true);
  bytes.set(bin, 28 + json.byteLength);
  return bytes;
}
