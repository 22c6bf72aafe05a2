// SPDX-License-Identifier: MIT
// A host of one file, of which it sends parts.
import type { Fetch } from '../../src/hierarchy/bytes.js';

export interface HostHabits {
  /// Answers with the whole file.
  knowsNoRanges?: boolean;
  /// Pages of other origins see none of it.
  hidesHeaders?: boolean;
  /// Sends so many bytes at a time.
  pieces?: number;
}

export class RangedHost {
  /// "first-end" of each part that was asked for, "whole" or "HEAD".
  readonly asked: string[] = [];
  tag = '"1"';
  sentBytes = 0;
  /// The next answer has it, instead of the right one.
  next: ((right: Response) => Response) | null = null;

  constructor(
    public file: Uint8Array<ArrayBuffer>,
    private readonly habits: HostHabits = {},
  ) {}

  readonly fetch: Fetch = (_, init) => {
    init?.signal?.throwIfAborted();
    const right = this.answer(init ?? {});
    const { next } = this;
    this.next = null;
    return Promise.resolve(next === null ? right : next(right));
  };

  private answer({ method, headers }: RequestInit): Response {
    const own: Record<string, string> = { 'Content-Length': String(this.file.length) };
    if (!this.habits.hidesHeaders) own.ETag = this.tag;
    if (method === 'HEAD') {
      this.asked.push('HEAD');
      return new Response(null, { headers: own });
    }
    const range = /^bytes=(\d+)-(\d+)$/.exec(new Headers(headers).get('Range') ?? '');
    if (range === null || this.habits.knowsNoRanges) {
      this.asked.push('whole');
      return new Response(this.body(this.file), { headers: own });
    }
    const [first, end] = [Number(range[1]), Math.min(Number(range[2]) + 1, this.file.length)];
    this.asked.push(`${first}-${end}`);
    if (first >= end) return new Response(null, { status: 416 });
    own['Content-Length'] = String(end - first);
    if (!this.habits.hidesHeaders) own['Content-Range'] = `bytes ${first}-${end - 1}/${this.file.length}`;
    return new Response(this.body(this.file.subarray(first, end)), { status: 206, headers: own });
  }

  private body(bytes: Uint8Array<ArrayBuffer>): ReadableStream<Uint8Array> {
    const step = this.habits.pieces ?? Infinity;
    let at = 0;
    return new ReadableStream({
      pull: (stream) => {
        const piece = bytes.slice(at, Math.min(at + step, bytes.length));
        at += piece.length;
        this.sentBytes += piece.length;
        if (piece.length > 0) stream.enqueue(piece);
        if (at === bytes.length) stream.close();
      },
    });
  }
}
