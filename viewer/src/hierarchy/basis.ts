// SPDX-License-Identifier: MIT
// Pictures of KTX2 (Basis Universal: ETC1S, UASTC) as the device keeps them: blocks of 4 x 4 texels, with all smaller pictures.
import { chooseFormat, deviceFormats, type DeviceFormats, type TexelFormat } from './device_formats.js';
import type { Size } from './picture_size.js';

export interface Level extends Size {
  readonly data: Uint8Array<ArrayBuffer>;
}

/// `levels`: the largest first; none once they are on the GPU alone.
export interface CompressedTexels {
  readonly format: TexelFormat;
  readonly levels: Level[];
}

interface LevelInfo {
  readonly origWidth: number;
  readonly origHeight: number;
}

interface Ktx2File {
  isValid(): number;
  isUASTC(): number;
  isETC1S(): number;
  getHasAlpha(): number;
  getLevels(): number;
  getFaces(): number;
  getLayers(): number;
  startTranscoding(): number;
  getImageLevelInfo(level: number, layer: number, face: number): LevelInfo;
  getImageTranscodedSizeInBytes(level: number, layer: number, face: number, format: number): number;
  transcodeImage(into: Uint8Array, level: number, layer: number, face: number, format: number, flags: number, channel0: number, channel1: number): number;
  close(): void;
  delete(): void;
}

interface Basis {
  readonly KTX2File: new (bytes: Uint8Array) => Ktx2File;
  initializeBasis(): void;
}

interface Transcoder {
  readonly createBasis: (options: { wasmBinary: ArrayBuffer }) => Promise<Basis>;
  readonly WASM: string;
}

/// The transcoder's numbers of the formats.
const TARGETS: Readonly<Record<TexelFormat, number>> = { etc2: 0, etc2_alpha: 1, bc1: 2, bc3: 3, bc7: 6, astc: 10, rgba: 13 };
const BYTES: Readonly<Record<TexelFormat, number>> = { etc2: 0.5, etc2_alpha: 1, bc1: 0.5, bc3: 1, bc7: 1, astc: 1, rgba: 4 };

/// Returns the bytes of a texel on the GPU.
export function texelBytes(format: TexelFormat): number {
  return BYTES[format];
}

let url: string | undefined;
let loaded: Promise<Basis> | null = null;

/// Where the transcoder is a script of its own: its URL, for this page and its workers.
export function setTranscoderUrl(to: string | undefined): void {
  url = to;
}

export function transcoderUrl(): string | undefined {
  return url;
}

async function unpacked(base64: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

async function load(): Promise<Basis> {
  const module: unknown = url === undefined ? await import('./basis_transcoder.js') : await import(/* @vite-ignore */ url);
  const { createBasis, WASM } = module as Transcoder;
  const basis = await createBasis({ wasmBinary: await unpacked(WASM) });
  basis.initializeBasis();
  return basis;
}

/// Only pages with such pictures load it.
async function transcoder(): Promise<Basis> {
  loaded ??= load();
  try {
    return await loaded;
  } catch (problem) {
    loaded = null; // the line may come back
    throw problem;
  }
}

const halved = (side: number, level: number): number => Math.max(1, side >> level);

function levelOf(file: Ktx2File, level: number, { width, height }: Size, target: number): Level | null {
  const { origWidth, origHeight } = file.getImageLevelInfo(level, 0, 0);
  if (origWidth !== halved(width, level) || origHeight !== halved(height, level)) return null;
  const data = new Uint8Array(file.getImageTranscodedSizeInBytes(level, 0, 0, target));
  return file.transcodeImage(data, level, 0, 0, target, 0, -1, -1) ? { width: origWidth, height: origHeight, data } : null;
}

function transcodeFile(file: Ktx2File, size: Size, device: DeviceFormats): CompressedTexels | null {
  if (!file.isValid() || !(file.isETC1S() || file.isUASTC()) || file.getFaces() !== 1 || file.getLayers() > 1) return null;
  const format = chooseFormat(device, Boolean(file.isETC1S()), Boolean(file.getHasAlpha()));
  const count = file.getLevels();
  if (count !== 1 + Math.floor(Math.log2(Math.max(size.width, size.height))) || !file.startTranscoding()) return null;
  const levels: Level[] = [];
  for (let level = 0; level < count; ++level) {
    const one = levelOf(file, level, size, TARGETS[format]);
    if (one === null) return null;
    levels.push(one);
  }
  return { format, levels };
}

/// Null of what is broken. Rejects if the transcoder does not load, or breaks down.
export async function transcode(bytes: Uint8Array, size: Size, device: DeviceFormats = deviceFormats()): Promise<CompressedTexels | null> {
  const { KTX2File } = await transcoder();
  try {
    const file = new KTX2File(bytes);
    const texels = transcodeFile(file, size, device);
    file.close();
    file.delete();
    return texels;
  } catch (problem) {
    loaded = null; // what broke down in it may have left it in a bad state
    throw problem;
  }
}
