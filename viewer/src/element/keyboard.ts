// SPDX-License-Identifier: MIT
// Keys that move a camera around what it looks at.
import { Spherical, Vector3, type PerspectiveCamera } from 'three';

const TURN = 0.16; // radians
const PAN = 0.08; // of the distance
const ZOOM = 1.25;
const STEEPEST = 0.01; // radians from straight up or down

const TURNS: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const ZOOMS: Readonly<Record<string, number>> = { '+': 1 / ZOOM, '=': 1 / ZOOM, '-': ZOOM, _: ZOOM };

type Press = Pick<KeyboardEvent, 'key' | 'shiftKey' | 'ctrlKey' | 'altKey' | 'metaKey'>;

function orbit(camera: PerspectiveCamera, target: Vector3, [right, down]: readonly [number, number], zoom: number): void {
  const around = new Spherical().setFromVector3(camera.position.clone().sub(target));
  around.theta += right * TURN;
  around.phi = Math.min(Math.max(around.phi + down * TURN, STEEPEST), Math.PI - STEEPEST);
  around.radius *= zoom;
  camera.position.setFromSpherical(around).add(target);
}

function pan(camera: PerspectiveCamera, target: Vector3, [right, down]: readonly [number, number]): void {
  const step = PAN * camera.position.distanceTo(target);
  const move = new Vector3(right * step, -down * step, 0).applyQuaternion(camera.quaternion);
  camera.position.add(move);
  target.add(move);
}

/// Moves `camera`, and `target` with Shift. False: the key means nothing.
export function moveByKey(camera: PerspectiveCamera, target: Vector3, press: Press): boolean {
  const { key } = press;
  const turn = Object.hasOwn(TURNS, key) ? TURNS[key] : undefined;
  const zoom = Object.hasOwn(ZOOMS, key) ? ZOOMS[key] : undefined;
  if ((turn === undefined && zoom === undefined) || press.ctrlKey || press.altKey || press.metaKey) return false;
  if (turn !== undefined && press.shiftKey) pan(camera, target, turn);
  else orbit(camera, target, turn ?? [0, 0], zoom ?? 1);
  return true;
}
