// SPDX-License-Identifier: MIT
// What the manifest tells of objects.bin and object_words.bin (docs/file_format.md, sections 2 and 9).
import type { JsonValue } from '../json_value.js';

export const OBJECTS_FILE = 'objects.bin';
const WORDS_FILE = 'object_words.bin';
export const MOST_OBJECTS = 2 ** 24;
const MOST_PROPERTIES = 64;

/// Magic and version; and behind the directory its sizes and checksum.
export const HEAD_BYTES = 12;
export const END_BYTES = 24;
/// The format allows four times as much: the directory of 16 million objects has about a MB.
export const MOST_DIRECTORY = 2 ** 26;

export const PROPERTY_TYPES = ['number', 'boolean', 'text', 'date'] as const;
export type ObjectPropertyType = (typeof PROPERTY_TYPES)[number];

export interface ObjectProperty {
  readonly name: string;
  readonly type: ObjectPropertyType;
}

/// What is known of a table.
export interface TableFacts {
  readonly file: string;
  readonly bytes: number;
  readonly count: number;
  readonly properties: readonly ObjectProperty[];
  readonly directory: { readonly bytes: number; readonly checksum: bigint };
}

export interface ObjectFacts extends TableFacts {
  /// The table of their names' words; null: there is none.
  readonly words: TableFacts | null;
}

function readTableFacts(table: JsonValue, file: string): TableFacts {
  const bytes = table.at('bytes').count(HEAD_BYTES + END_BYTES);
  const directory = table.at('directory');
  return {
    file: table.at('file').oneOf(file),
    bytes,
    count: table.at('count').count(1, MOST_OBJECTS),
    properties: table.at('properties').items().slice(0, MOST_PROPERTIES).map((item) => ({ name: item.at('name').text(), type: item.at('type').oneOf(...PROPERTY_TYPES) })),
    directory: { bytes: directory.at('bytes').count(1, Math.min(MOST_DIRECTORY, bytes - HEAD_BYTES - END_BYTES)), checksum: BigInt(`0x${directory.at('checksum').checksum()}`) },
  };
}

/// Reads `objects` of a manifest.
export function readObjectFacts(objects: JsonValue): ObjectFacts {
  return { ...readTableFacts(objects, OBJECTS_FILE), words: objects.has('words') ? readTableFacts(objects.at('words'), WORDS_FILE) : null };
}
