// SPDX-License-Identifier: MIT
// A picture as a PNG file, row by row: what is in memory are a few rows and the file.
// Needs CompressionStream (Chrome 80, Firefox 113, Safari 16.4).

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
const POLYNOMIAL = 0xedb88320;
const DEPTH = 8;
const RGBA = 6;
const UP = 2; // the filter: each byte less the one above it

const REMAINDERS = Uint32Array.from({ length: 256 }, (_, byte) => {
  let rest = byte;
  for (let bit = 0; bit < 8; ++bit) rest = rest & 1 ? POLYNOMIAL ^ (rest >>> 1) : rest >>> 1;
  return rest;
});

function crc(bytes: Uint8Array): number {
  let rest = 0xffffffff;
  for (const byte of bytes) rest = REMAINDERS[(rest ^ byte) & 255] ^ (rest >>> 8);
  return (rest ^ 0xffffffff) >>> 0;
}

function chunk(type: string, content: Uint8Array): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(12 + content.length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, content.length);
  for (let i = 0; i < 4; ++i) bytes[4 + i] = type.charCodeAt(i);
  bytes.set(content, 8);
  view.setUint32(8 + content.length, crc(bytes.subarray(4, 8 + content.length)));
  return bytes;
}

function header(width: number, height: number): Uint8Array<ArrayBuffer> {
  const content = new Uint8Array(13);
  const view = new DataView(content.buffer);
  view.setUint32(0, width);
  view.setUint32(4, height);
  content.set([DEPTH, RGBA], 8);
  return chunk('IHDR', content);
}

const INCH = 0.0254; // metres

/// Pixels of a metre on both axes: programs print the picture so large.
function density(dotsPerInch: number): Uint8Array<ArrayBuffer> {
  const content = new Uint8Array(9);
  const view = new DataView(content.buffer);
  for (const at of [0, 4]) view.setUint32(at, Math.round(dotsPerInch / INCH));
  content[8] = 1; // the unit is the metre
  return chunk('pHYs', content);
}

export class PngWriter {
  private readonly parts: Uint8Array<ArrayBuffer>[];
  private readonly packer = new CompressionStream('deflate');
  private readonly writer = this.packer.writable.getWriter();
  private readonly done: Promise<void>;
  private above: Uint8Array;
  private rows = 0;

  constructor(
    private readonly width: number,
    private readonly height: number,
    dotsPerInch: number | null = null,
  ) {
    this.parts = [Uint8Array.from(SIGNATURE), header(width, height), ...(dotsPerInch === null ? [] : [density(dotsPerInch)])];
    this.above = new Uint8Array(4 * width);
    this.done = this.collect();
    this.done.catch(() => undefined); // finish() tells
  }

  private async collect(): Promise<void> {
    const reader = (this.packer.readable as ReadableStream<Uint8Array>).getReader();
    for (let next = await reader.read(); !next.done; next = await reader.read()) this.parts.push(chunk('IDAT', next.value));
  }

  /// Whole rows of r, g, b, a, the uppermost first.
  async write(rows: Uint8Array): Promise<void> {
    const bytes = 4 * this.width;
    const count = rows.length / bytes;
    const filtered = new Uint8Array(rows.length + count);
    for (let row = 0; row < count; ++row) {
      const now = rows.subarray(row * bytes, (row + 1) * bytes);
      const at = row * (bytes + 1);
      filtered[at] = UP;
      for (let i = 0; i < bytes; ++i) filtered[at + 1 + i] = now[i] - this.above[i];
      this.above = now;
    }
    this.above = this.above.slice();
    this.rows += count;
    await this.writer.write(filtered);
  }

  /// Once all rows are written.
  async finish(): Promise<Blob> {
    if (this.rows !== this.height) throw new RangeError(`${this.rows} rows of ${this.height}`);
    await this.writer.close();
    await this.done;
    return new Blob([...this.parts, chunk('IEND', new Uint8Array(0))], { type: 'image/png' });
  }
}
