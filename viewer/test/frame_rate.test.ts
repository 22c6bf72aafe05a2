// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { FrameRate } from '../src/cut/frame_rate.js';

interface Device {
  base: number;
  perVertex: number;
  /// Frames end only at multiples of this; 0: at any time.
  display?: number;
  jitter?: (frame: number) => number;
}

interface Shown {
  at: number;
  took: number;
  vertices: number;
}

const TILE = 8192; // what is shown comes in tiles

/// Runs a controller on a device that would show `wanted` vertices, for so many seconds.
function run(rate: FrameRate, device: Device, wanted: number, seconds: number, tile = TILE): Shown[] {
  const frames: Shown[] = [];
  for (let at = 0; at < 1000 * seconds; ) {
    const allowed = Math.max(tile, Math.floor(rate.budget / tile) * tile);
    const vertices = Math.min(wanted, allowed);
    const work = (device.base + vertices * device.perVertex) * (device.jitter?.(frames.length) ?? 1);
    const took = device.display ? Math.ceil(work / device.display) * device.display : work;
    frames.push({ at, took, vertices });
    rate.frame(took, vertices, vertices < wanted);
    at += took;
  }
  return frames;
}

function meanRate(frames: readonly Shown[]): number {
  return (1000 * frames.length) / frames.reduce((sum, { took }) => sum + took, 0);
}

function after(frames: readonly Shown[], milliseconds: number): Shown[] {
  return frames.filter(({ at }) => at >= milliseconds);
}

/// In pieces of a second.
function seconds(frames: readonly Shown[]): number[] {
  const last = Math.floor(frames.at(-1)!.at / 1000);
  const first = Math.ceil(frames[0].at / 1000);
  return Array.from({ length: last - first }, (_, i) =>
    meanRate(frames.filter(({ at }) => at >= 1000 * (first + i) && at < 1000 * (first + i + 1))));
}

const slow: Record<string, Device> = {
  'slow': { base: 2, perVertex: 1e-4 },
  'very slow': { base: 5, perVertex: 3e-4 },
  'slow by itself': { base: 20, perVertex: 5e-5 },
  'uneven': { base: 3, perVertex: 2e-4, jitter: (frame) => 1 + 0.08 * Math.sin(1.7 * frame) },
};

describe('FrameRate', () => {
  it.each(Object.entries(slow))('settles within two seconds on a device that is %s', (_name, device) => {
    const late = after(run(new FrameRate(30), device, 5e6, 10), 2000);
    for (const rate of seconds(late)) expect(Math.abs(rate / 30 - 1)).toBeLessThan(0.15);
  });

  it.each([10, 24, 60])('holds %i frames a second', (target) => {
    const late = after(run(new FrameRate(target), { base: 2, perVertex: 1e-4 }, 5e6, 10), 2000);
    for (const rate of seconds(late)) expect(Math.abs(rate / target - 1)).toBeLessThan(0.15);
  });

  it('does not go to and fro', () => {
    const late = after(run(new FrameRate(30), { base: 2, perVertex: 1e-4 }, 5e6, 20), 2000);
    const changes = late.filter(({ vertices }, i) => i > 0 && vertices !== late[i - 1].vertices).length;
    expect(changes).toBeLessThan(12);
  });

  it('shows all of it where the device is fast enough', () => {
    const frames = run(new FrameRate(30), { base: 1, perVertex: 1e-6 }, 1e6, 3);
    expect(frames.at(-1)!.vertices).toBe(1e6);
  });

  it('comes back when the device does', () => {
    const rate = new FrameRate(30);
    run(rate, { base: 2, perVertex: 1e-3 }, 2e6, 3);
    const frames = run(rate, { base: 2, perVertex: 1e-5 }, 2e6, 3);
    expect(frames.at(-1)!.vertices).toBe(2e6);
  });

  it.each([500, 8192, 40_000, 90_000])('stays with what it shows in tiles of %i vertices', (tile) => {
    const late = after(run(new FrameRate(30), { base: 4, perVertex: 1.5e-4 }, 5e6, 30, tile), 2000);
    const turns = late.filter(({ vertices }, i) => i > 0 && vertices !== late[i - 1].vertices).length;
    expect(turns).toBeLessThan(14);
  });

  it('does not take vertices away where they are not what takes the time', () => {
    const frames = run(new FrameRate(30), { base: 80, perVertex: 2e-6 }, 1e6, 10);
    expect(after(frames, 3000).every(({ vertices }) => vertices > 900_000)).toBe(true);
  });

  it('is not put out by a frame that takes long now and then', () => {
    const device: Device = { base: 2, perVertex: 1e-5, jitter: (frame) => (frame % 10 === 9 ? 20 : 1) };
    const frames = run(new FrameRate(30), device, 1e6, 10);
    expect(frames.every(({ vertices }) => vertices > 900_000)).toBe(true);
  });

  it("finds at the display's own rate what it can show", () => {
    const rate = new FrameRate(60);
    rate.budget = 50_000;
    const late = after(run(rate, { base: 2, perVertex: 1e-5, display: 1000 / 60 }, 5e6, 120), 60_000);
    expect(late.at(-1)!.vertices).toBeGreaterThan(300_000);
    expect(meanRate(late)).toBeGreaterThan(60 * 0.85);
  });
});
