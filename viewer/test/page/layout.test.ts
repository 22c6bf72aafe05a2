// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { ballOf, cellMatrix, dragged, fitAt, fitOf, multiply, towardsViewer, turnTo, USUAL_TURN, type Matrix } from '../../page/gallery/layout.js';
import { directionOf } from '../../src/hierarchy/first_view.js';

function project(matrix: Matrix, [x, y, z]: number[]): number[] {
  const at = (row: number): number => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row];
  return [at(0) / at(3), at(1) / at(3), at(2) / at(3)];
}

describe('a ball', () => {
  it('holds the box', () => {
    expect(ballOf(new Float32Array([1, 2, 3, 3, 5, 9]))).toEqual({ centre: [2, 3.5, 6], radius: 3.5 });
  });

  it('is never flat nor infinite', () => {
    expect(ballOf(new Float32Array()).radius).toBe(1);
    expect(ballOf(new Float32Array([5, 5, 5])).radius).toBe(1);
    expect(ballOf(new Float32Array([-3e38, 0, 0, 3e38, 0, 0])).radius).toBeLessThan(Infinity);
  });
});

describe('a turned outline', () => {
  const ball = { centre: [5, 6, 7], radius: 2 } as const;

  it.each([0.5, 1, 2])('stays within its cell of aspect %d', (aspect) => {
    for (let yaw = 0; yaw < 7; yaw += 0.3) {
      const matrix = cellMatrix(ball, 'y', { yaw, pitch: yaw / 7 }, aspect);
      for (const corner of [[7, 6, 7], [5, 8, 7], [5, 6, 9], [3, 6, 7]])
        for (const value of project(matrix, corner)) expect(Math.abs(value)).toBeLessThanOrEqual(1.03);
    }
  });

  it('stands upright', () => {
    const top = project(cellMatrix(ball, 'z', { yaw: 1, pitch: 0 }, 1), [5, 6, 9]);
    expect(top[1]).toBeGreaterThan(0.8);
    expect(top[0]).toBeCloseTo(0);
  });

  it('shows its front in front', () => {
    const matrix = cellMatrix(ball, 'y', { yaw: 0, pitch: 0 }, 1);
    expect(project(matrix, [5, 6, 9])[2]).toBeLessThan(project(matrix, [5, 6, 5])[2]);
  });

  it.each([[0, 0], [90, 0], [213.75, 13], [-30, -40], [0, 90]])('is seen first from azimuth %d and elevation %d, as the model is', (azimuth, elevation) => {
    const view = { azimuth, elevation };
    const [x, y, z] = directionOf(view);
    const matrix = cellMatrix({ centre: [0, 0, 0], radius: 1 }, 'y', turnTo(view), 1);
    const nearest = project(matrix, [x, y, z]);
    expect(Math.abs(nearest[0])).toBeLessThan(0.02);
    expect(Math.abs(nearest[1])).toBeLessThan(0.02);
    expect(nearest[2]).toBeCloseTo(-1);
    towardsViewer(turnTo(view)).forEach((value, axis) => { expect(value).toBeCloseTo([x, y, z][axis], 2); });
  });

  it('is seen from the usual side where the hierarchy says none', () => {
    expect(turnTo(null)).toBe(USUAL_TURN);
  });

  it.each([0.5, 1, 2])('fills a cell of aspect %d at first, as a preview does, and less when it is turned', (aspect) => {
    const lines = new Float32Array([4, 5, 7, 6, 5, 7, 5, 5.5, 7.5]);
    const around = ballOf(lines);
    const first = { yaw: 0.3, pitch: 0.2 };
    const fit = fitOf(lines, around, 'z', first);
    const across = (turn: typeof first): number => {
      const matrix = cellMatrix(around, 'z', turn, aspect, fitAt(fit, first, turn));
      const places = [0, 3, 6].map((i) => project(matrix, [...lines.subarray(i, i + 3)]));
      const size = (axis: number): number => Math.max(...places.map((p) => p[axis])) - Math.min(...places.map((p) => p[axis]));
      for (const place of places) expect(Math.max(Math.abs(place[0]), Math.abs(place[1]))).toBeLessThan(1.03);
      return Math.max(size(0) * Math.max(aspect, 1), size(1) * Math.max(1 / aspect, 1)) / 2;
    };
    expect(across(first)).toBeCloseTo(0.92, 5);
    for (let yaw = 0.3; yaw < 7; yaw += 0.2) across({ yaw, pitch: 0.2 });
    expect(fitAt(fit, first, { yaw: 2, pitch: 0 }).zoom).toBe(1);
    expect(fitOf(new Float32Array(), around, 'y', first).zoom).toBe(1);
  });

  it('follows the pointer', () => {
    const before = project(cellMatrix(ball, 'y', { yaw: 0, pitch: 0 }, 1), [5, 6, 9]);
    const after = project(cellMatrix(ball, 'y', dragged({ yaw: 0, pitch: 0 }, 20, 10, 200), 1), [5, 6, 9]);
    expect(after[0]).toBeGreaterThan(before[0]);
    expect(after[1]).toBeLessThan(before[1]);
  });

  it('never turns upside down', () => {
    expect(dragged({ yaw: 0, pitch: 0 }, 0, 1e6, 200).pitch).toBeLessThan(Math.PI / 2);
    expect(dragged({ yaw: 0, pitch: 0 }, 0, -1e6, 200).pitch).toBeGreaterThan(-Math.PI / 2);
  });
});

it('matrices are multiplied', () => {
  const move = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1];
  const scale = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];
  expect(multiply(scale, move).slice(12)).toEqual([2, 4, 6, 1]);
});
