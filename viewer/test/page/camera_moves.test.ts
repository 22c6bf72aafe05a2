// SPDX-License-Identifier: MIT
import { Box3, PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { CameraPose } from '../../src/scene/camera_pose.js';
import { between, depthOf, depthRange, pan, retarget, turn, VIEW_ANGLE, wholeView, zoom } from '../../page/view/camera_moves.js';

const POSE = new CameraPose(new Vector3(1, 2, 8), new Vector3(0, 1, 0));
const BOX = new Box3(new Vector3(-1, -2, -3), new Vector3(4, 5, 6));

function seen(pose: CameraPose, point: Vector3, aspect = 1): Vector3 {
  const camera = new PerspectiveCamera((VIEW_ANGLE * 180) / Math.PI, aspect, 0.01, 1000);
  camera.position.copy(pose.position);
  camera.lookAt(pose.target);
  camera.updateMatrixWorld();
  return point.clone().project(camera);
}

function near(a: Vector3, b: Vector3): void {
  expect(a.distanceTo(b)).toBeLessThan(1e-9);
}

describe('a turn', () => {
  it('keeps target and distance', () => {
    const turned = turn(POSE, 0.7, -0.3);
    near(turned.target, POSE.target);
    expect(turned.distance).toBeCloseTo(POSE.distance, 12);
  });

  it('never goes over the top', () => {
    const top = turn(POSE, 0, 100);
    expect(top.forward.y).toBeGreaterThan(-1);
    near(turn(top, 0.5, 0).target, POSE.target);
  });

  it('can be undone', () => { near(turn(turn(POSE, 0.4, 0.1), -0.4, -0.1).position, POSE.position); });
});

describe('a pan', () => {
  it('moves what lies at its depth by parts of the picture', () => {
    const point = POSE.target;
    const moved = pan(POSE, 0.1, 0.25, depthOf(POSE, point));
    const place = seen(moved, point);
    expect(place.x).toBeCloseTo(-0.2, 9);
    expect(place.y).toBeCloseTo(-0.5, 9);
  });
});

describe('a zoom', () => {
  it('keeps its point where it is in the picture', () => {
    const point = new Vector3(1, 0.5, 1);
    const closer = zoom(POSE, point, 0.01);
    const [before, after] = [seen(POSE, point), seen(closer, point)];
    expect(after.x).toBeCloseTo(before.x, 6);
    expect(after.y).toBeCloseTo(before.y, 6);
    expect(closer.distance).toBeCloseTo(POSE.distance * 0.01, 12);
  });
});

it('another target at the same line of sight is the same picture', () => {
  const other = retarget(POSE, 0.5);
  near(other.position, POSE.position);
  near(other.forward, POSE.forward);
  expect(other.distance).toBeCloseTo(0.5, 12);
});

describe('the whole view', () => {
  it.each([0.4, 1, 2.5])('has all of the box in a picture of aspect %d, and fills it', (aspect) => {
    const pose = wholeView(BOX, aspect);
    let most = 0;
    for (const x of [-1, 4]) for (const y of [-2, 5]) for (const z of [-3, 6]) {
      const place = seen(pose, new Vector3(x, y, z), aspect);
      most = Math.max(most, Math.abs(place.x), Math.abs(place.y));
    }
    expect(most).toBeLessThan(1);
    expect(most).toBeGreaterThan(0.85);
  });

  it('is one even of a single point', () => {
    const point = new Box3(new Vector3(5, 5, 5), new Vector3(5, 5, 5));
    expect(wholeView(point, 1).distance).toBeGreaterThan(0);
  });
});

it('near and far plane hold the box, or what is near the target', () => {
  const outside = depthRange(wholeView(BOX, 1), BOX);
  expect(outside.near).toBeGreaterThan(0.1);
  const inside = depthRange(new CameraPose(new Vector3(1, 1, 1), new Vector3(1, 1, 0.999)), BOX);
  expect(inside.near).toBeCloseTo(0.00002, 9);
  expect(inside.far).toBeGreaterThan(5);
});

it('a way begins and ends where it should', () => {
  const end = zoom(turn(POSE, 2, 0.2), new Vector3(1, 1, 1), 0.001);
  near(between(POSE, end, 0).position, POSE.position);
  near(between(POSE, end, 1).position, end.position);
  expect(between(POSE, end, 0.5).distance).toBeCloseTo(POSE.distance * Math.sqrt(0.001), 9);
});
