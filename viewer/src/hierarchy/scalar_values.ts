// SPDX-License-Identifier: MIT
// Attributes that vertices have besides normals, colours and texture coordinates (docs/file_format.md, sections 2 and 4.11).
import type { JsonValue } from '../json_value.js';
import type { Glb, Gltf } from './glb.js';
import { detached } from './vertex_values.js';

export const MOST_VALUES = 54;
/// A float accessor has the lowest float where a vertex has no finite value.
export const NO_VALUE = -3.4028234663852886e38;

/// One number a vertex.
export interface ScalarAttribute {
  readonly name: string;
  /// A label names something, as a class; of a quantity means are made. An object is a label of which all corners of a triangle have the same.
  readonly kind: 'quantity' | 'label' | 'object';
  readonly min: number;
  readonly max: number;
  /// Vertices without a finite value.
  readonly missing: number;
  /// A histogram of quantities: `bins[i]` lie from (firstBin + i) * binWidth on.
  readonly binWidth: number;
  readonly firstBin: number;
  readonly bins: readonly number[];
  /// All labels, ascending; empty of quantities, and if there are very many.
  readonly labels: readonly number[];
  /// The input's names of the labels; '' where it says nothing.
  readonly labelNames: readonly string[];
}

/// Tells whether numbers stand for things: nothing lies between two.
export function isLabel({ kind }: Pick<ScalarAttribute, 'kind'>): boolean {
  return kind !== 'quantity';
}

/// The place of the value that is a triangle's object; -1: there is none.
export function objectIndex(attributes: readonly ScalarAttribute[]): number {
  return attributes.findIndex(({ kind }) => kind === 'object');
}

/// The name of a label, or '' if it has none.
export function labelName({ labels, labelNames }: ScalarAttribute, label: number): string {
  return labelNames[labels.indexOf(label)] ?? '';
}

/// Beside a vertex without a value what lies between is none either.
export const LEAST_VALUE = -1e37;

/// How many values a vertex has, of as many positions.
export function valueWidth({ positions, values }: { readonly positions: Float32Array; readonly values?: Float32Array | null }): number {
  return (3 * (values?.length ?? 0)) / positions.length;
}

function numbers(value: JsonValue): number[] {
  return value.items().map((item) => item.number());
}

/// Reads the attributes in the manifest's source.
export function readScalarAttributes(source: JsonValue): ScalarAttribute[] {
  if (!source.has('values')) return [];
  return source.at('values').items().slice(0, MOST_VALUES).map(readScalarAttribute);
}

function readScalarAttribute(value: JsonValue): ScalarAttribute {
  const labels = value.has('labels') ? numbers(value.at('labels')) : [];
  return {
    name: value.at('name').text(),
    kind: value.at('kind').oneOf('quantity', 'label', 'object'),
    min: value.at('min').number(),
    max: value.at('max').number(),
    missing: value.at('missing').count(),
    binWidth: 2 ** value.at('bin_exponent').number(),
    firstBin: value.at('first_bin').number(),
    bins: numbers(value.at('bins')),
    labels,
    labelNames: value.has('label_names') ? value.at('label_names').items().map((name) => name.text()) : labels.map(() => ''),
  };
}

/// How a value is read, by its component type.
const READERS: Record<number, (bytes: DataView, at: number) => number> = {
  5120: (bytes, at) => bytes.getInt8(at),
  5121: (bytes, at) => bytes.getUint8(at),
  5122: (bytes, at) => bytes.getInt16(at, true),
  5123: (bytes, at) => bytes.getUint16(at, true),
  5126: (bytes, at) => bytes.getFloat32(at, true),
};

const VALUE_BYTES = 4; // of each in the section, whatever its type

/// The accessors of the section, which are in the order of the manifest.
function accessorsOf(gltf: Gltf, section: number): Gltf['accessors'] {
  return section < 0 ? [] : gltf.accessors.filter(({ bufferView }) => bufferView === section);
}

/// All values of each vertex one after another; null: there are none. What is not there is NO_VALUE.
export function readScalarValues(glb: Glb, section: number, vertices: number): Float32Array | null {
  const accessors = accessorsOf(glb.gltf, section);
  if (accessors.length === 0) return null;
  if (accessors.length > MOST_VALUES) glb.fail('too many values');
  const stride = VALUE_BYTES * accessors.length;
  const bytes = new DataView(detached(glb.section(section, stride * vertices)));
  const values = new Float32Array(accessors.length * vertices);
  accessors.forEach(({ componentType }, i) => {
    const read = READERS[componentType];
    if (read === undefined) glb.fail('values of an unknown type');
    for (let v = 0; v < vertices; ++v) {
      const value = read(bytes, stride * v + VALUE_BYTES * i);
      if (!Number.isFinite(value)) glb.fail('a value is not finite');
      values[accessors.length * v + i] = value;
    }
  });
  return values;
}
