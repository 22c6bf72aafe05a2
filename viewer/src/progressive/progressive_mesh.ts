// SPDX-License-Identifier: MIT
// The client of a progressive stream: two arrays, and what each file's lists put into them.
//
// Lin & Luo, "Progressive Display Method for Interactive Mobile 3D Graphics": vertices and triangles
// are put into their places; then each merge copies one vertex's slot to another's. Nothing else is
// ever updated: O(1) for each entry of a file.
import { fetchBytes } from '../hierarchy/bytes.js';
import { checksum } from '../hierarchy/checksum.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { readRuns, type Run } from './detail_file.js';
import { parseStreamIndex, StreamError, valueBytes, type StreamIndex } from './stream_index.js';

const SIGN = 0x80000000;
const MOST_INDEX = 2 ** 20; // bytes

/// A file of at most `most` bytes. Throws StreamError.
async function fetchFile(url: string, most: number): Promise<Uint8Array<ArrayBuffer>> {
  try {
    return await fetchBytes((one, init) => fetch(one, init), url, url, most);
  } catch (problem) {
    throw problem instanceof HierarchyProblem ? new StreamError(problem.message) : problem;
  }
}

/// Returns what `make` does. Throws StreamError where there is no memory for it.
function allocated<T>(make: () => T, name: string): T {
  try {
    return make();
  } catch (problem) {
    throw problem instanceof RangeError ? new StreamError(`${name}: there is no memory for it`) : problem;
  }
}

/// Ascends with the float that has these bits, by one from each to the next; and back.
function ordered(bits: number): number {
  return (bits & SIGN) !== 0 ? ~bits : bits | SIGN;
}
function unordered(number: number): number {
  return (number & SIGN) !== 0 ? number & ~SIGN : ~number;
}
function unfold(residual: number): number {
  return (residual & 1) !== 0 ? ~(residual >>> 1) : residual >>> 1;
}

/// A file did this to the mesh.
export interface Step {
  file: string;
  level: number;
  bytes: number;
  entries: number;
  /// To unpack it and put it into its places, without fetching.
  milliseconds: number;
}

export class ProgressiveMesh {
  readonly index: StreamIndex;
  /// `width` values a vertex: x, y, z relative to the index's origin, then normal, colour (as stored:
  /// 0 to 255, 0 to 65535, or a float), texture coordinate. Slots that nothing was put into have NaN.
  readonly values: Float32Array;
  readonly width: number;
  /// Three vertices each; of triangles that are not there three times vertex 0.
  readonly triangles: Uint32Array;
  /// Files that were put in.
  taken = 0;

  private readonly bytes: readonly number[];
  private readonly bits: Uint32Array;

  /// Throws StreamError where there is no memory for the arrays.
  constructor(index: StreamIndex) {
    this.index = index;
    this.bytes = valueBytes(index.source.attributes);
    this.width = this.bytes.length;
    const name = index.source.file_name;
    this.values = allocated(() => new Float32Array(index.vertices * this.width), name).fill(NaN);
    this.bits = new Uint32Array(this.values.buffer);
    this.triangles = allocated(() => new Uint32Array(3 * index.triangles), name);
  }

  /// The index of the stream at `url`, a directory without a slash at its end. Throws StreamError.
  static async open(url: string): Promise<ProgressiveMesh> {
    const name = `${url}/progressive.json`;
    return new ProgressiveMesh(parseStreamIndex(new TextDecoder().decode(await fetchFile(name, MOST_INDEX)), name));
  }

  /// Fetches the next file and puts it in: the base first. Null if there is none. Throws StreamError;
  /// the arrays are good for nothing then.
  async next(url: string): Promise<Step | null> {
    if (this.taken === this.index.files.length) return null;
    const { file, bytes } = this.index.files[this.taken];
    const name = `${url}/${file}`;
    return this.take(await fetchFile(name, bytes), name);
  }

  /// Puts the next file in.
  async take(bytes: Uint8Array<ArrayBuffer>, name: string): Promise<Step> {
    const file = this.index.files[this.taken];
    if (bytes.byteLength !== file.bytes)
      throw new StreamError(`${name}: has ${bytes.byteLength} bytes, expected ${file.bytes}`);
    if (checksum(bytes) !== file.checksum) throw new StreamError(`${name}: is damaged, or of another stream that has taken the place of this one`);
    const start = performance.now();
    const entries = [0, 0, 0, 0];
    for await (const run of readRuns(bytes, this.taken, this.bytes, name)) {
      if (run.list === 1) this.putVertices(run, name);
      else if (run.list === 2) this.putTriangles(run, name);
      else this.merge(run, name);
      entries[run.list] += run.indices.length;
    }
    if (entries[1] !== file.vertices || entries[2] !== file.triangles || entries[3] !== file.merges)
      throw new StreamError(`${name}: its counts are not those of the index`);
    ++this.taken;
    return {
      file: file.file,
      level: file.level,
      bytes: file.bytes,
      entries: entries[1] + entries[2] + entries[3],
      milliseconds: performance.now() - start,
    };
  }

  private putVertices(run: Run, name: string): void {
    const { width, bits, values, bytes } = this;
    let before = -1; // place of the run's last vertex
    for (let i = 0; i < run.indices.length; ++i) {
      const vertex = run.indices[i];
      if (vertex >= this.index.vertices) throw new StreamError(`${name}: vertex ${vertex} is beyond the mesh`);
      const slot = vertex * width;
      const from = !Number.isNaN(values[slot]) ? slot : before;
      for (let k = 0; k < width; ++k) {
        const difference = unfold(run.entries[i * width + k]);
        if (bytes[k] === 4) {
          bits[slot + k] = unordered((from < 0 ? SIGN : ordered(bits[from + k])) + difference);
        } else {
          const mask = 2 ** (8 * bytes[k]) - 1;
          values[slot + k] = ((from < 0 ? 0 : values[from + k]) + difference) & mask;
        }
      }
      before = slot;
    }
  }

  private putTriangles(run: Run, name: string): void {
    const { triangles } = this;
    for (let i = 0; i < run.indices.length; ++i) {
      const triangle = run.indices[i];
      if (triangle >= this.index.triangles) throw new StreamError(`${name}: triangle ${triangle} is beyond the mesh`);
      for (let k = 0; k < 3; ++k) {
        if (run.entries[3 * i + k] >= this.index.vertices)
          throw new StreamError(`${name}: triangle ${triangle} has a corner beyond the mesh`);
        triangles[3 * triangle + k] = run.entries[3 * i + k];
      }
    }
  }

  private merge(run: Run, name: string): void {
    const { width, bits } = this;
    for (let i = 0; i < run.indices.length; ++i) {
      const vertex = run.indices[i];
      const target = run.entries[i];
      if (vertex >= this.index.vertices || target >= this.index.vertices)
        throw new StreamError(`${name}: a merge of vertex ${vertex} is beyond the mesh`);
      bits.copyWithin(vertex * width, target * width, (target + 1) * width);
    }
  }
}
