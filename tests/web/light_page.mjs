// The root of a hierarchy as the page shows it, but by the camera of `meshhier preview`: from the first view, without perspective.
import * as THREE from 'three';
import { HierarchyView } from 'meshhier-viewer';
import { keyOf, Lighting } from '/viewer/scene/lighting.js';
import { rigFor, shownLook } from '/viewer/scene/shown_look.js';

const MARGIN = 0.04; // render/camera.h
const COARSE = { threshold: 1000, restDetail: 1 };

/// Along a direction to the viewer, upright.
function axesOf(back) {
  const up = new THREE.Vector3(0, 1, 0);
  const right = up.clone().cross(back);
  if (right.lengthSq() < 1e-9) right.set(1, 0, 0);
  right.normalize();
  return { right, up: back.clone().cross(right), back };
}

/// Shows all of the root's vertices, as large as the frame takes them.
function cameraOn(view, side) {
  const axes = axesOf(new THREE.Vector3(...view.firstDirection).normalize());
  const box = new THREE.Box3();
  for (const { tile: { positions } } of view.surface)
    for (let v = 0; v < positions.length; v += 3) {
      const at = new THREE.Vector3(positions[v], positions[v + 1], positions[v + 2]).applyMatrix4(view.surfaceMatrix);
      box.expandByPoint(new THREE.Vector3(at.dot(axes.right), at.dot(axes.up), at.dot(axes.back)));
    }
  const [size, middle] = [box.getSize(new THREE.Vector3()), box.getCenter(new THREE.Vector3())];
  const half = Math.max(size.x, size.y) / (1 - 2 * MARGIN) / 2;
  const camera = new THREE.OrthographicCamera(-half, half, half, -half, 0, 4 * size.z + half);
  camera.position.copy(axes.right).multiplyScalar(middle.x).addScaledVector(axes.up, middle.y).addScaledVector(axes.back, box.max.z + half);
  camera.up.copy(axes.up);
  camera.lookAt(camera.position.clone().sub(axes.back));
  camera.updateMatrixWorld();
  return { camera, side };
}

/// Until nothing is left to fetch, and all of it is drawn as it is to look.
async function settled(view, viewport) {
  const camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1e9);
  await view.opened;
  camera.position.copy(view.box.getCenter(new THREE.Vector3())).z += view.box.getSize(new THREE.Vector3()).length();
  for (let now = 0; view.update(camera, viewport, now) || !view.stats().settled; now += 100) await new Promise((resolve) => requestAnimationFrame(resolve));
}

async function pixelsOf(url, width) {
  const bitmap = await createImageBitmap(await (await fetch(url)).blob(), { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  const context = new OffscreenCanvas(width, width).getContext('2d');
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, width, width).data;
}

/// Means over pixels that both cover wholly, and all around them.
function compare(shown, preview, side) {
  const isInside = (data, at) => data[4 * at + 3] === 255;
  let [pixels, sum, most] = [0, 0, 0];
  const bias = [0, 0, 0];
  for (let y = 2; y + 2 < side; ++y)
    for (let x = 2; x + 2 < side; ++x) {
      const around = [-2, -1, 0, 1, 2].flatMap((dy) => [-2, -1, 0, 1, 2].map((dx) => (y + dy) * side + x + dx));
      if (!around.every((at) => isInside(shown, at) && isInside(preview, at))) continue;
      ++pixels;
      for (let c = 0; c < 3; ++c) {
        const by = shown[4 * (y * side + x) + c] - preview[4 * (y * side + x) + c];
        bias[c] += by;
        sum += Math.abs(by);
        most = Math.max(most, Math.abs(by));
      }
    }
  return { pixels, mean: sum / (3 * pixels), most, bias: bias.map((value) => value / pixels) };
}

/// Whether a normal map shades what is drawn.
function hasMap(view) {
  let found = false;
  view.traverse(({ material }) => (found ||= [material].flat().some((one) => one?.normalMap)));
  return found;
}

/// The picture, upright: drawn so many columns and rows farther on, and read from there.
function shifted(renderer, scene, camera, side, [right, down]) {
  camera.setViewOffset(side, side, -right, -down, side, side);
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const from = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, from);
  const picture = new Uint8Array(from.length);
  for (let y = 0; y + down < side; ++y) {
    const row = side * (side - 1 - y - down);
    picture.set(from.subarray(4 * (row + right), 4 * (row + side)), 4 * side * y);
  }
  return picture;
}

/// The mean of four pictures: creases are shaded by how the normal turns, which a GPU tells once for each square of 2 x 2 pixels. A normal
/// map turns within a pixel, and pictures of one view whose squares begin elsewhere differ by 3 of 255 on average.
function drawn(renderer, scene, camera, side) {
  const pictures = [[0, 0], [1, 0], [0, 1], [1, 1]].map((by) => shifted(renderer, scene, camera, side, by));
  return pictures[0].map((_, i) => Math.round(pictures.reduce((sum, picture) => sum + picture[i], 0) / pictures.length));
}

/// `preview`: of the root, `side` pixels wide and high.
window.compareLight = async (url, preview, side) => {
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.toneMapping = THREE.NeutralToneMapping;
  renderer.setClearAlpha(0);
  renderer.setPixelRatio(1);
  renderer.setSize(side, side);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  const view = new HierarchyView(url, { settings: COARSE });
  scene.add(view);
  await settled(view, { width: side, height: side });
  const { camera } = cameraOn(view, side);
  const lighting = new Lighting(scene, camera);
  scene.add(camera);
  const rig = rigFor(view);
  lighting.set(rig, keyOf(rig));
  const look = shownLook(view.look, rig, 1, view);
  view.setLook(look);
  await settled(view, { width: side, height: side });
  const shown = drawn(renderer, scene, camera, side);
  const result = compare(shown, await pixelsOf(preview, side), side);
  const kind = !hasMap(view) ? 'plain' : look.relief > 1 ? 'steep' : 'mapped';
  view.dispose();
  return { ...result, rig, kind };
};
