// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { chooseCut, type ChosenNode, type Limits, type Sources } from '../src/cut/choose_cut.js';
import type { Viewpoint } from '../src/cut/viewpoint.js';
import type { TileRecord } from '../src/hierarchy/tile_index.js';
import { Tree, type Node } from '../src/hierarchy/tree.js';

const OWN = 100;
const BYTES = 1000;
const tree = new Tree(64);

/// A strip from x = 0 to 64, a partition for each 1.
function record({ level, index }: Node): TileRecord {
  const width = 64 / 2 ** level;
  const error = level === tree.lastLevel ? 0 : width / 100;
  return { own: OWN, ghosts: 0, copies: 0, splits: 0, interior: 0, border: 0, pictureWidth: 0, pictureHeight: 0, hasNormalMap: false, error, bound: 0, min: [index * width, 0, 0], max: [(index + 1) * width, 1, 1], bytes: 1, checksum: 0n };
}

/// Sees the strip's x from `from` to `to`, from 10 before its middle.
function look(from: number, to: number): Viewpoint {
  return { eye: [(from + to) / 2, 0.5, 10], planes: [[1, 0, 0, -from], [-1, 0, 0, to]], pixels: 1000, near: 0.1, stretch: [1, 1, 1] };
}

const sources: Sources = {
  tree,
  record,
  bytesOf: () => BYTES,
  isHidden: () => false,
  isLost: () => false,
  wasRefined: () => false,
  mayBeFine: () => true,
};

const ALL: Limits = { threshold: 1, fine: Infinity, vertices: Infinity, mostLevel: Infinity, bytes: Infinity };

function leaves(chosen: ChosenNode): ChosenNode[] {
  return chosen.children.length === 0 ? [chosen] : chosen.children.flatMap(leaves);
}

function cutOf(view: Viewpoint, limits: Limits, given = sources): ChosenNode[] {
  return leaves(chooseCut(given, view, limits).root!);
}

describe('chooseCut', () => {
  const finer = { ...ALL, fine: 0.25 };

  it('goes on to the finer error while triangles are larger than a pixel', () => {
    const few = cutOf(look(20, 22), finer);
    for (const { pixels } of few) expect(pixels).toBeLessThanOrEqual(0.25);
    const many = cutOf(look(20, 22), finer, { ...sources, record: (node) => ({ ...record(node), interior: 1e9 }) });
    expect(many).toEqual(cutOf(look(20, 22), ALL, { ...sources, record: (node) => ({ ...record(node), interior: 1e9 }) }));
  });

  it('goes on so only with what may be finer', () => {
    const [fine, coarse] = [cutOf(look(0, 64), finer), cutOf(look(0, 64), ALL)];
    expect(fine.length).toBeGreaterThan(coarse.length);
    expect(cutOf(look(0, 64), finer, { ...sources, mayBeFine: () => false })).toEqual(coarse);
  });

  it('shows at least as much of all as without the finer error, where room is what limits it', () => {
    for (let bytes = 3 * BYTES; bytes < 60 * BYTES; bytes += BYTES) {
      const [more, less] = [{ ...finer, bytes }, { ...ALL, bytes }].map((limits) => chooseCut(sources, look(0, 64), limits).refined.map(({ key }) => key));
      expect(more.slice(0, less.length)).toEqual(less);
    }
  });

  it('refines what is in view to the threshold, and covers all else coarsely', () => {
    const cut = cutOf(look(20, 22), ALL);
    expect(cut.reduce((sum, { node }) => sum + 64 / 2 ** node.level, 0)).toBe(64);
    for (const { pixels } of cut) expect(pixels).toBeLessThanOrEqual(1);
    expect(cut.filter(({ inView }) => inView).length).toBeGreaterThan(1);
    expect(cut.length).toBeLessThan(16);
  });

  it('spends vertices where the error is largest', () => {
    const few = { ...ALL, vertices: 10 * OWN };
    const choice = chooseCut(sources, look(0, 64), few);
    const cut = leaves(choice.root!);
    expect(choice.limited.vertices).toBe(true);
    expect(cut.filter(({ inView }) => inView).length).toBeLessThanOrEqual(10);
    const least = Math.min(...choice.refined.map(({ pixels }) => pixels));
    for (const { pixels } of cut) expect(pixels).toBeLessThanOrEqual(least);
  });

  it('holds no more than the memory allows', () => {
    const choice = chooseCut(sources, look(0, 64), { ...ALL, bytes: 21 * BYTES });
    expect(choice.limited.bytes).toBe(true);
    expect(1 + 2 * choice.refined.length).toBe(19); // and one on its way takes two more
  });

  it('keeps what was refined a little longer', () => {
    const view = look(0, 64);
    const threshold = 0.99 * Math.min(...chooseCut(sources, view, ALL).refined.map(({ pixels }) => pixels));
    const before = chooseCut(sources, view, { ...ALL, threshold });
    const looser = { ...ALL, threshold: 1.2 * threshold };
    expect(cutOf(view, looser).length).toBeLessThan(leaves(before.root!).length);
    const remembered = { ...sources, wasRefined: (key: number) => before.refined.some((each) => each.key === key) };
    expect(cutOf(view, looser, remembered).length).toBe(leaves(before.root!).length);
    expect(cutOf(view, { ...ALL, threshold: 2 * threshold }, remembered).length).toBeLessThan(leaves(before.root!).length);
  });

  it('leaves alone what cannot be seen', () => {
    const cut = cutOf(look(0, 64), ALL, { ...sources, isHidden: (_key, { min }) => min[0] >= 32 });
    expect(cut.filter(({ record: { min } }) => min[0] >= 32)).toHaveLength(1);
  });

  it('lets the tile above stand for what could not be had, and for all below it', () => {
    const cut = cutOf(look(0, 64), ALL, { ...sources, isLost: ({ level, index }) => level === 2 && index === 1 });
    expect(cut.filter(({ node }) => node.level === 1 && node.index === 0)).toHaveLength(1);
    expect(chooseCut({ ...sources, isLost: ({ level }) => level === 1 }, look(0, 64), ALL).incomplete).toBe(false);
  });

  it('waits for records that have not come', () => {
    const partly = { ...sources, record: (node: Node) => (node.level > 2 ? null : record(node)) };
    const choice = chooseCut(partly, look(0, 64), ALL);
    expect(choice.incomplete).toBe(true);
    expect(leaves(choice.root!)).toHaveLength(4);
    expect(chooseCut({ ...sources, record: () => null }, look(0, 64), ALL).root).toBeNull();
  });
});
