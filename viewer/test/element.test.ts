// SPDX-License-Identifier: MIT
import { PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { formatCamera, parseCamera } from '../src/element/viewer_element.js';
import { defineViewer, MeshhierViewerElement } from '../src/element/index.js';
import { moveByKey } from '../src/element/keyboard.js';

describe('the element', () => {
  it('can be imported where there are no elements', () => {
    expect(() => { defineViewer(); }).not.toThrow();
    expect(MeshhierViewerElement.observedAttributes).toContain('src');
  });

  it('has a camera that comes back', () => {
    const place = { position: [1, -2.5, 3e8], target: [0, 0, 1e-3] } as const;
    expect(parseCamera(formatCamera(place))).toEqual(place);
  });

  it.each([null, '', '1,2,3', '1,2,3,4,5,6,7', '1,2,3,1,2,3', '1,2,3,4,5,x', '1,,3,4,5,6', '1e999,0,0,0,0,0', '1e300,1,0,1e300,0,0'])('has no camera of %s', (text) => {
    expect(parseCamera(text)).toBeNull();
  });
});

/// A camera on the z axis after some keys, and what it looks at.
function pressed(...keys: (string | { key: string; shiftKey?: boolean; ctrlKey?: boolean })[]): { camera: PerspectiveCamera; target: Vector3; meant: boolean[] } {
  const [camera, target] = [new PerspectiveCamera(), new Vector3()];
  camera.position.set(0, 0, 10);
  const none = { shiftKey: false, ctrlKey: false, altKey: false, metaKey: false };
  const meant = keys.map((key) => moveByKey(camera, target, { ...none, ...(typeof key === 'string' ? { key } : key) }));
  return { camera, target, meant };
}

describe('keys', () => {
  it('turn around what is looked at', () => {
    const { camera, target } = pressed('ArrowRight');
    expect(camera.position.x).toBeGreaterThan(0);
    expect(camera.position.length()).toBeCloseTo(10);
    expect(target.length()).toBe(0);
  });

  it('never turn it upside down', () => {
    const { camera } = pressed(...Array<string>(50).fill('ArrowUp'));
    expect(camera.position.y).toBeGreaterThan(9.9);
    expect(camera.position.z).toBeGreaterThan(0);
  });

  it('go closer and farther', () => {
    expect(pressed('+').camera.position.z).toBeLessThan(10);
    expect(pressed('+', '-').camera.position.z).toBeCloseTo(10);
  });

  it('move both with Shift', () => {
    const { camera, target } = pressed({ key: 'ArrowRight', shiftKey: true });
    expect(target.x).toBeGreaterThan(0);
    expect(camera.position.x).toBeCloseTo(target.x);
  });

  it('mean nothing else', () => {
    const { camera, meant } = pressed('a', 'Enter', 'toString', { key: 'ArrowLeft', ctrlKey: true });
    expect(meant).toEqual([false, false, false, false]);
    expect(camera.position.toArray()).toEqual([0, 0, 10]);
  });
});
