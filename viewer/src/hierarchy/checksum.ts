// SPDX-License-Identifier: MIT
// XXH3-64 with seed 0, the checksum of all files of a hierarchy (docs/file_format.md). Algorithm: Yann Collet, "xxHash fast digest
// algorithm", the specification of XXH3.
//
// Long inputs are summed in 32-bit halves, which engines keep in registers; BigInt takes what is done once.

const SECRET = Uint8Array.from(
  ('b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671fcb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c' +
    '3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364' +
    'eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e')
    .match(/../g)!,
  (digits) => parseInt(digits, 16),
);
const SECRET_VIEW = new DataView(SECRET.buffer);
const SECRET_WORDS = Uint32Array.from({ length: SECRET.length / 4 }, (_, i) => SECRET_VIEW.getUint32(4 * i, true));

const PRIME32_1 = 0x9e3779b1;
const PRIME32_2 = 0x85ebca77n;
const PRIME32_3 = 0xc2b2ae3dn;
const PRIME64_1 = 0x9e3779b185ebca87n;
const PRIME64_2 = 0xc2b2ae3d27d4eb4fn;
const PRIME64_3 = 0x165667b19e3779f9n;
const PRIME64_4 = 0x85ebca77c2b2ae63n;
const PRIME64_5 = 0x27d4eb2f165667c5n;
const MIX_1 = 0x165667919e3779f9n;
const MIX_2 = 0x9fb21c651e98df25n;
const START = [PRIME32_3, PRIME64_1, PRIME64_2, PRIME64_3, PRIME64_4, PRIME32_2, PRIME64_5, BigInt(PRIME32_1)];

const STRIPE = 64; // bytes
const STRIPES = 16; // of a block
const BLOCK = STRIPE * STRIPES;
const LANES = 8;
const SHORT = 240; // longer inputs are summed in stripes
const LAST_SECRET = SECRET.length - STRIPE - 7;
const MERGE_SECRET = 11;

const MASK = 2n ** 64n - 1n;

function u64(value: bigint): bigint {
  return value & MASK;
}

function read64(view: DataView, at: number): bigint {
  return view.getBigUint64(at, true);
}

function secret64(at: number): bigint {
  return read64(SECRET_VIEW, at);
}

/// The halves of the product of two, on each other.
function folded(a: bigint, b: bigint): bigint {
  const product = a * b;
  return u64(product) ^ (product >> 64n);
}

/// All bits of the result depend on all bits.
function avalanche(hash: bigint): bigint {
  const mixed = u64((hash ^ (hash >> 37n)) * MIX_1);
  return mixed ^ (mixed >> 32n);
}

function shortAvalanche(hash: bigint): bigint {
  let mixed = u64((hash ^ (hash >> 33n)) * PRIME64_2);
  mixed = u64((mixed ^ (mixed >> 29n)) * PRIME64_3);
  return mixed ^ (mixed >> 32n);
}

function swapped(value: bigint): bigint {
  const view = new DataView(new ArrayBuffer(8));
  view.setBigUint64(0, value);
  return view.getBigUint64(0, true);
}

function rotated(value: bigint, by: bigint): bigint {
  return u64(value << by) | (value >> (64n - by));
}

/// Returns the checksum of at most 16 bytes.
function tiny(view: DataView): bigint {
  const length = view.byteLength;
  if (length === 0) return shortAvalanche(secret64(56) ^ secret64(64));
  if (length <= 3) {
    const bytes = (view.getUint8(0) << 16) | (view.getUint8(length >> 1) << 24) | view.getUint8(length - 1) | (length << 8);
    const key = BigInt((SECRET_WORDS[0] ^ SECRET_WORDS[1]) >>> 0);
    return shortAvalanche(BigInt(bytes >>> 0) ^ key);
  }
  if (length <= 8) {
    const [first, last] = [view.getUint32(0, true), view.getUint32(length - 4, true)];
    let hash = (BigInt(last) + (BigInt(first) << 32n)) ^ secret64(8) ^ secret64(16);
    hash ^= rotated(hash, 49n) ^ rotated(hash, 24n);
    hash = u64(hash * MIX_2);
    hash = u64((hash ^ ((hash >> 35n) + BigInt(length))) * MIX_2);
    return hash ^ (hash >> 28n);
  }
  const low = read64(view, 0) ^ secret64(24) ^ secret64(32);
  const high = read64(view, length - 8) ^ secret64(40) ^ secret64(48);
  return avalanche(u64(BigInt(length) + swapped(low) + high + folded(low, high)));
}

function mixed16(view: DataView, at: number, secret: number): bigint {
  return folded(read64(view, at) ^ secret64(secret), read64(view, at + 8) ^ secret64(secret + 8));
}

/// Returns the checksum of 17 to 128 bytes.
function small(view: DataView): bigint {
  const length = view.byteLength;
  let sum = BigInt(length) * PRIME64_1;
  for (let pair = (length - 1) >> 5; pair >= 0; --pair) {
    sum += mixed16(view, 16 * pair, 32 * pair);
    sum += mixed16(view, length - 16 * (pair + 1), 32 * pair + 16);
  }
  return avalanche(u64(sum));
}

/// Returns the checksum of 129 to 240 bytes.
function middling(view: DataView): bigint {
  const length = view.byteLength;
  const rounds = length >> 4;
  let sum = BigInt(length) * PRIME64_1;
  for (let round = 0; round < 8; ++round) sum += mixed16(view, 16 * round, 16 * round);
  sum = avalanche(u64(sum));
  for (let round = 8; round < rounds; ++round) sum += mixed16(view, 16 * round, 16 * (round - 8) + 3);
  sum += mixed16(view, length - 16, 136 - 17);
  return avalanche(u64(sum));
}

/// Eight sums of 64 bits, each as its halves: low, high.
type Sums = Uint32Array;

/// Adds stripes of `words`, from the word `at` on, the first with the secret's first bytes.
function addStripes(sums: Sums, words: Uint32Array, at: number, stripes: number, secret: Uint32Array): void {
  for (let lane = 0; lane < LANES; ++lane) {
    let [low, high, low2, high2] = [0, 0, 0, 0]; // of this lane, and of its neighbour; exact as floats
    for (let stripe = 0, word = at + 2 * lane, key = 2 * lane; stripe < stripes; ++stripe, word += STRIPE / 4, key += 2) {
      const dataLow = words[word];
      const dataHigh = words[word + 1];
      const a = dataLow ^ secret[key];
      const b = dataHigh ^ secret[key + 1];
      const [a0, a1, b0, b1] = [a & 0xffff, a >>> 16, b & 0xffff, b >>> 16];
      const cross = Math.imul(a0, b1) >>> 0;
      const middle = (Math.imul(a1, b0) >>> 0) + (Math.imul(a0, b0) >>> 16) + (cross & 0xffff);
      low += Math.imul(a, b) >>> 0;
      high += (Math.imul(a1, b1) >>> 0) + Math.floor(middle / 65536) + (cross >>> 16);
      low2 += dataLow;
      high2 += dataHigh;
    }
    add(sums, lane, low, high);
    add(sums, lane ^ 1, low2, high2);
  }
}

function add(sums: Sums, lane: number, low: number, high: number): void {
  const all = sums[2 * lane] + low;
  sums[2 * lane] = all % 2 ** 32;
  sums[2 * lane + 1] = (sums[2 * lane + 1] + high + Math.floor(all / 2 ** 32)) % 2 ** 32;
}

/// Mixes the sums behind each whole block.
function scramble(sums: Sums): void {
  const prime = BigInt(PRIME32_1);
  const key = (SECRET.length - STRIPE) / 4;
  for (let lane = 0; lane < LANES; ++lane) {
    const high = sums[2 * lane + 1];
    const low = (sums[2 * lane] ^ (high >>> 15) ^ SECRET_WORDS[key + 2 * lane]) >>> 0;
    const product = BigInt(low) * prime;
    sums[2 * lane] = Number(product & 0xffffffffn);
    sums[2 * lane + 1] = Math.imul((high ^ SECRET_WORDS[key + 2 * lane + 1]) >>> 0, PRIME32_1) + Number(product >> 32n);
  }
}

/// The words of bytes, wherever these begin; what is behind the last whole word is left out.
function wordsOf(bytes: Uint8Array): Uint32Array {
  const aligned = bytes.byteOffset % 4 === 0 ? bytes : bytes.slice();
  return new Uint32Array(aligned.buffer, aligned.byteOffset, aligned.length >> 2);
}

function long(bytes: Uint8Array): bigint {
  const sums = new Uint32Array(START.flatMap((start) => [Number(start & 0xffffffffn), Number(start >> 32n)]));
  const words = wordsOf(bytes);
  const blocks = Math.floor((bytes.length - 1) / BLOCK);
  for (let block = 0; block < blocks; ++block) {
    addStripes(sums, words, (block * BLOCK) / 4, STRIPES, SECRET_WORDS);
    scramble(sums);
  }
  addStripes(sums, words, (blocks * BLOCK) / 4, Math.floor((bytes.length - 1 - blocks * BLOCK) / STRIPE), SECRET_WORDS);
  addStripes(sums, wordsOf(bytes.slice(-STRIPE)), 0, 1, wordsOf(SECRET.slice(LAST_SECRET)));
  let hash = BigInt(bytes.length) * PRIME64_1;
  const sum = (lane: number): bigint => (BigInt(sums[2 * lane + 1]) << 32n) | BigInt(sums[2 * lane]);
  for (let pair = 0; pair < LANES / 2; ++pair) {
    const secret = MERGE_SECRET + 16 * pair;
    hash += folded(sum(2 * pair) ^ secret64(secret), sum(2 * pair + 1) ^ secret64(secret + 8));
  }
  return avalanche(u64(hash));
}

/// XXH3-64 of bytes. Requires a device that stores numbers with the lowest byte first, as all do that draw in browsers.
export function checksum(bytes: Uint8Array): bigint {
  if (bytes.length > SHORT) return long(bytes);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  return bytes.length <= 16 ? tiny(view) : bytes.length <= 128 ? small(view) : middling(view);
}

/// As manifests write it: sixteen digits.
export function digitsOf(sum: bigint): string {
  return sum.toString(16).padStart(16, '0');
}
