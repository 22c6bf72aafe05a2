// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { TileStore, type ResidentTile, type StoreHost, type Wanted } from '../src/cut/tile_store.js';
import { HierarchyProblem } from '../src/hierarchy/problem.js';
import type { Tile } from '../src/hierarchy/tile.js';
import type { TileRecord } from '../src/hierarchy/tile_index.js';
import { Tree, keyOf, type Node } from '../src/hierarchy/tree.js';
import { random } from './support/random.js';

const tree = new Tree(32);
const BYTES = 100;
const RECORD: TileRecord = { own: 1, ghosts: 0, copies: 0, splits: 0, interior: 0, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false, error: 0, bound: 0, min: [0, 0, 0], max: [0, 0, 0], bytes: 1, checksum: 0n };

function tile({ level, index }: Node): Tile {
  const empty = { positions: new Float32Array(3), copyOf: new Uint16Array(0), normals: new Int16Array(4), normalsFrom: 'viewer' as const, splitOf: new Uint16Array(0), colours: null, values: null, coloursTint: false, texcoords: null, picture: null, indices: new Uint16Array(0) };
  const seams = { border: new Uint16Array(0), neighbours: new Uint32Array(0), ghostStarts: new Uint32Array(0), chains: new Uint16Array(0) };
  return { level, index, own: 1, ghosts: 0, interiorCount: 0, cone: { axis: [0, 0, 1], cosine: -1 }, closed: false, insideOut: false, box: [0, 0, 0, 0, 0, 0], zUp: false, firstView: null,
    normalMap: null,
    tangents: null, ...empty, ...seams };
}

interface Call {
  node: Node;
  signal: AbortSignal;
  resolve: (tile: Tile) => void;
  reject: (problem: Error) => void;
}

/// A host whose files come when the test says.
class SlowHost implements StoreHost {
  calls: Call[] = [];
  readonly held = new Set<number>();
  problems = 0;
  bytes = BYTES;
  async load(node: Node, _record: TileRecord, signal: AbortSignal): Promise<Tile> {
    return new Promise((resolve, reject) => {
      this.calls.push({ node, signal, resolve, reject });
    });
  }
  bytesOf(): number {
    return this.bytes;
  }
  came({ key }: ResidentTile): void {
    this.held.add(key);
  }
  gone({ key }: ResidentTile): void {
    this.held.delete(key);
  }
  failed(): void {
    ++this.problems;
  }
  async answerAll(): Promise<void> {
    for (const { node, resolve } of this.calls.splice(0)) resolve(tile(node));
    await new Promise((resolve) => setTimeout(resolve));
  }
}

function store(host: SlowHost, budget: number, requests = 4): TileStore {
  const made = new TileStore(host, () => tree, budget, requests);
  made.addRoot(tile({ level: 0, index: 0 }), tree);
  return made;
}

function wanted(...nodes: Node[]): Wanted[] {
  return nodes.map((node) => ({ node, record: RECORD, loadingBytes: 2 * BYTES }));
}

function key({ level, index }: Node): number {
  return keyOf(level, index);
}

const [LEFT, RIGHT] = tree.children({ level: 0, index: 0 });

describe('TileStore', () => {
  it('does not give a tile that cannot be drawn yet, and does not ask for it again', async () => {
    const host = new SlowHost();
    const waiting = new Set([key(LEFT)]);
    const tiles = store(Object.assign(host, { awaits: (one: number) => waiting.has(one) }), 1e6);
    expect(tiles.want(wanted(LEFT, RIGHT), 1)).toBe(2);
    await host.answerAll();
    expect(tiles.want(wanted(LEFT, RIGHT), 2)).toBe(1);
    expect(host.calls).toHaveLength(0);
    expect([tiles.has(key(LEFT)), tiles.has(key(RIGHT)), tiles.residentCount]).toEqual([false, true, 3]);
    waiting.clear();
    expect(tiles.want(wanted(LEFT, RIGHT), 3)).toBe(0);
    expect(tiles.has(key(LEFT))).toBe(true);
  });

  it('asks in order, for as many at a time as it may, parents first', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6, 2);
    const below = tree.children(LEFT);
    expect(tiles.want(wanted(LEFT, RIGHT, ...below), 1)).toBe(4);
    expect(host.calls.map(({ node }) => node)).toEqual([LEFT, RIGHT]);
    await host.answerAll();
    expect(tiles.want(wanted(LEFT, RIGHT, ...below), 2)).toBe(2);
    expect(host.calls.map(({ node }) => node)).toEqual(below);
    await host.answerAll();
    expect(tiles.want(wanted(LEFT, RIGHT, ...below), 3)).toBe(0);
  });

  it('aborts what nobody wants any more, after a while', () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6);
    tiles.want(wanted(LEFT, RIGHT), 0);
    tiles.want(wanted(RIGHT), 100);
    expect(tiles.pending).toBe(2);
    tiles.want(wanted(RIGHT), 400);
    expect(tiles.pending).toBe(1);
    expect(host.calls[0].signal.aborted).toBe(true);
    expect(tiles.aborted).toBe(1);
  });

  it('drops what was of no use for the longest time, never what is, and never a parent before its children', async () => {
    const host = new SlowHost();
    const tiles = store(host, 7 * BYTES, 8);
    const old = tree.children(LEFT);
    const young = tree.children(RIGHT);
    tiles.want(wanted(LEFT, RIGHT), 1);
    await host.answerAll();
    tiles.want(wanted(LEFT, RIGHT, ...old), 2);
    await host.answerAll();
    for (let round = 3; round < 6; ++round) {
      tiles.want(wanted(LEFT, RIGHT, ...young), round);
      await host.answerAll();
    }
    expect(young.every((node) => tiles.has(key(node)))).toBe(true);
    expect(old.some((node) => tiles.has(key(node)))).toBe(false);
    expect([LEFT, RIGHT].every((node) => tiles.has(key(node)))).toBe(true);
    expect(tiles.peakBytes).toBeLessThanOrEqual(7 * BYTES);
  });

  it('never passes its budget, whatever is asked for and whatever fails', async () => {
    const host = new SlowHost();
    const budget = 9 * BYTES;
    const tiles = store(host, budget, 5);
    const next = random(3);
    for (let now = 1; now < 3000; now += 1 + Math.floor(200 * next())) {
      const path: Node[] = [];
      for (let node: Node = { level: 0, index: 0 }; path.length < 6 && next() < 0.85; ) {
        const children = tree.children(node);
        if (children.length === 0) break;
        path.push(...children);
        node = children[next() < 0.5 ? 0 : 1];
      }
      tiles.want(wanted(...path), now);
      for (const { node, resolve, reject } of host.calls.splice(0, Math.floor(4 * next())))
        if (next() < 0.2) reject(new Error('lost'));
        else resolve(tile(node));
      await new Promise((resolve) => setTimeout(resolve));
      expect(tiles.usedBytes).toBeLessThanOrEqual(budget);
      expect([...tiles.residents()].map((each) => each.key).sort()).toEqual([...host.held].sort());
      const isComing = (node: Node): boolean => host.calls.some((call) => key(call.node) === key(node) && !call.signal.aborted);
      for (const { node } of tiles.residents()) {
        const above = tree.parent(node);
        if (above !== null) expect(tiles.has(key(above)) || isComing(above)).toBe(true);
      }
    }
    expect(tiles.peakBytes).toBeLessThanOrEqual(budget);
    expect(host.problems).toBeGreaterThan(0);
  });

  it('tries a file that failed again, later, gives up, and forgets that after a while', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6);
    let asked = 0;
    for (let now = 1; now < 40_000; now += 1000) {
      tiles.want(wanted(LEFT), now);
      asked += host.calls.length;
      for (const { reject } of host.calls.splice(0)) reject(new Error('gone'));
      await new Promise((resolve) => setTimeout(resolve));
    }
    expect(asked).toBe(4);
    expect(tiles.isGivenUp(key(LEFT), 40_000)).toBe(true);
    expect(tiles.want(wanted(LEFT), 40_000)).toBe(0);
    expect(tiles.want(wanted(LEFT), 300_000)).toBe(1);
    expect(host.calls).toHaveLength(1);
    expect(tiles.usedBytes).toBe(3 * BYTES);
  });

  it('asks by itself for what the host could not give, and at once when another tile has come, but that once only', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6);
    const fails = async (now: number): Promise<number> => {
      tiles.want(wanted(LEFT), now);
      const asked = host.calls.length;
      for (const { reject } of host.calls.splice(0)) reject(new HierarchyProblem('a.glb', 'down', true));
      await new Promise((resolve) => setTimeout(resolve));
      return asked;
    };
    for (const now of [0, 2000, 6000, 14_000]) expect(await fails(now)).toBe(1); // after 2, 4 and 8 seconds
    expect(tiles.isGivenUp(key(LEFT), 20_000)).toBe(true);
    expect(tiles.nextTry).toBe(34_000);
    tiles.want(wanted(RIGHT), 20_000);
    await host.answerAll();
    expect(tiles.has(key(RIGHT))).toBe(true);
    expect(await fails(20_100)).toBe(1); // the host is back
    tiles.want(wanted(LEFT), 22_200);
    await host.answerAll();
    expect([tiles.has(key(LEFT)), tiles.nextTry]).toEqual([true, Infinity]);
  });

  it('that is frozen keeps what it has, and asks for nothing', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6);
    tiles.want(wanted(LEFT), 1);
    await host.answerAll();
    tiles.want(wanted(LEFT, RIGHT), 2);
    const [call] = host.calls;
    tiles.freeze();
    expect([call.signal.aborted, tiles.pending, tiles.has(key(LEFT))]).toEqual([true, 0, true]);
    expect(tiles.want(wanted(LEFT, RIGHT), 3)).toBe(0);
    expect(host.calls).toHaveLength(1);
  });

  it('makes room when tiles take more than before, and counts what is left', async () => {
    const host = new SlowHost();
    const tiles = store(host, 6 * BYTES);
    tiles.want(wanted(LEFT, RIGHT), 1);
    await host.answerAll();
    tiles.want(wanted(LEFT, RIGHT), 2);
    host.bytes = 2.75 * BYTES;
    tiles.recount();
    tiles.want(wanted(RIGHT), 3);
    tiles.keepWithin(3);
    expect([...host.held].sort((a, b) => a - b)).toEqual([keyOf(0, 0), key(RIGHT)]);
    expect(tiles.usedBytes).toBe(5.5 * BYTES);
    expect(tiles.peakBytes).toBe(5.5 * BYTES);
  });

  it('drops what was lost with all below it, and asks again', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6, 8);
    const below = tree.children(LEFT);
    tiles.want(wanted(LEFT, RIGHT), 1);
    await host.answerAll();
    tiles.want(wanted(LEFT, RIGHT, ...below), 2);
    await host.answerAll();
    tiles.dropLost(({ level, index }) => level === 1 && index === LEFT.index);
    expect([...host.held].sort((a, b) => a - b)).toEqual([keyOf(0, 0), key(RIGHT)]);
    expect(tiles.usedBytes).toBe(2 * BYTES);
    expect(tiles.want(wanted(LEFT, RIGHT, ...below), 3)).toBe(3);
    expect(host.calls.map(({ node }) => node)).toEqual([LEFT, ...below]);
  });

  it('holds nothing after its end', async () => {
    const host = new SlowHost();
    const tiles = store(host, 1e6);
    tiles.want(wanted(LEFT, RIGHT), 1);
    await host.answerAll();
    tiles.want(wanted(LEFT, RIGHT, ...tree.children(LEFT)), 2);
    const [call] = host.calls;
    tiles.dispose();
    await host.answerAll();
    expect(call.signal.aborted).toBe(true);
    expect(host.held.size).toBe(0);
  });
});
