// Transcodes KTX2 with what browsers have for it, for a program that speaks to it as storage/io/worker_pool.h says. Its argument: the folder of images/ktx2.
//
//   question   number of the format, as Basis Universal counts them; level; byte count; a KTX2
//   answer     the level in that format, or why it cannot be
//
// Formats below 0x1000 are Basis Universal's; 0x1000 asks ktx-parse: the answer is what it has read, as JSON.
import { readSync, writeSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const PROTOCOL = 1;
const [INPUT, OUTPUT] = [0, 1];
const PARSED = 0x1000;

const modules = pathToFileURL(`${process.argv[2]}/node_modules/`);
const { default: createBasis } = await import(new URL('ktx2-encoder/dist/basis/basis_encoder.js', modules));
const { read: parse } = await import(new URL('ktx-parse/dist/ktx-parse.modern.js', modules));

function take(count) {
  const bytes = Buffer.alloc(count);
  for (let at = 0; at < count; ) {
    const more = readSync(INPUT, bytes, at, count - at, null);
    if (more === 0) return null;
    at += more;
  }
  return bytes;
}

function give(bytes) {
  for (let at = 0; at < bytes.length; ) at += writeSync(OUTPUT, bytes, at, bytes.length - at);
}

function words(...values) {
  const bytes = Buffer.alloc(4 * values.length);
  values.forEach((value, i) => bytes.writeUInt32LE(value, 4 * i));
  return bytes;
}

function transcoded(basis, format, level, bytes) {
  const file = new basis.KTX2File(new Uint8Array(bytes));
  try {
    if (!file.isValid() || !file.startTranscoding()) throw new Error('it is no KTX2 of Basis Universal, or broken');
    const made = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, 0, format));
    if (!file.transcodeImage(made, level, 0, 0, format, 0, -1, -1)) throw new Error('it is broken');
    return made;
  } finally {
    file.close();
    file.delete();
  }
}

function parsed(bytes) {
  const container = parse(new Uint8Array(bytes));
  container.levels = container.levels.map((level) => level.uncompressedByteLength);
  return Buffer.from(JSON.stringify(container, (_, value) => (value instanceof Uint8Array ? Buffer.from(value).toString() : value)));
}

const silent = () => {};
const basis = await createBasis({ print: silent, printErr: silent });
basis.initializeBasis();
give(words(PROTOCOL));
for (let head = take(12); head !== null; head = take(12)) {
  const [format, level, count] = [0, 4, 8].map((at) => head.readUInt32LE(at));
  const bytes = take(count);
  if (bytes === null) break;
  let [status, answer] = [0, bytes];
  try {
    answer = format === PARSED ? parsed(bytes) : transcoded(basis, format, level, bytes);
  } catch (error) {
    [status, answer] = [1, Buffer.from(error instanceof Error ? error.message : String(error))];
  }
  give(words(status, answer.length));
  give(answer);
}
