// SPDX-License-Identifier: MIT
// Parts of a picture by a renderer of three: on its own canvas, so that they look as the page does.
import { Vector2, type WebGLRenderer } from 'three';
import type { ViewCamera } from '../scene/projection.js';
import type { DrawPart } from './screenshot.js';

/// `draw`: draws the scene with the camera. Between two parts the canvas has its size, and shows what it did.
export function partDrawer(renderer: WebGLRenderer, camera: ViewCamera, draw: () => void): DrawPart {
  return ({ width, height }, part) => {
    const pixels = new Uint8Array(4 * part.width * part.height);
    const [ratio, size] = [renderer.getPixelRatio(), renderer.getSize(new Vector2())];
    renderer.setPixelRatio(1);
    renderer.setSize(part.width, part.height, false);
    camera.setViewOffset(width, height, part.x, part.y, part.width, part.height);
    draw();
    const gl = renderer.getContext();
    gl.readPixels(0, 0, part.width, part.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    camera.clearViewOffset();
    renderer.setPixelRatio(ratio);
    renderer.setSize(size.x, size.y, false);
    draw();
    return pixels;
  };
}
