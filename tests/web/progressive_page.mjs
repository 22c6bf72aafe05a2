// Shows a progressive stream as it arrives, and tells what is in the client's two arrays.
import * as THREE from 'three';
import { ProgressiveMesh } from 'meshhier/progressive';
import { pixelsOf } from './pixels.mjs';

const SIZE = 512;

const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE);
renderer.setClearColor(0xffffff);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(40, 1, 1, 2);
const scene = new THREE.Scene();
scene.add(new THREE.HemisphereLight(0xffffff, 0x404040, 3));

let mesh = null;
let url = '';
let geometry = null;

/// The arrays themselves are what is drawn: vertices in their slots, triangles in their places.
function show() {
  const vertices = new THREE.InterleavedBuffer(mesh.values, mesh.width);
  geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.InterleavedBufferAttribute(vertices, 3, 0));
  geometry.setIndex(new THREE.BufferAttribute(mesh.triangles, 1));
  const { min, max } = mesh.index.source.bounds;
  const sphere = new THREE.Sphere();
  new THREE.Box3(new THREE.Vector3(...min), new THREE.Vector3(...max)).getBoundingSphere(sphere);
  sphere.center.sub(new THREE.Vector3(...mesh.index.origin));
  geometry.boundingSphere = sphere;
  const material = new THREE.MeshStandardMaterial({ side: THREE.DoubleSide, flatShading: true });
  scene.add(new THREE.Mesh(geometry, material));
  camera.near = sphere.radius / 10;
  camera.far = sphere.radius * 10;
  camera.updateProjectionMatrix();
  camera.position.copy(sphere.center).add(new THREE.Vector3(0.5, 0.5, 1).setLength(3 * sphere.radius));
  camera.lookAt(sphere.center);
}

/// Returns a checksum of the corners' places, triangle by triangle: two clients that show the same have it in common.
async function digest() {
  const { triangles, values, width } = mesh;
  const places = new Float32Array(3 * triangles.length);
  let count = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    if (triangles[i] === triangles[i + 1]) continue;
    for (let k = 0; k < 3; ++k) {
      const slot = triangles[i + k] * width;
      for (let axis = 0; axis < 3; ++axis) places[count++] = values[slot + axis];
    }
  }
  const sum = await crypto.subtle.digest('SHA-256', new Uint8Array(places.buffer, 0, 4 * count));
  return Array.from(new Uint8Array(sum), (byte) => byte.toString(16).padStart(2, '0')).join('');
}

window.view = {
  async open(at) {
    url = at;
    mesh = await ProgressiveMesh.open(url);
    show();
    return mesh.index.files.length;
  },
  /// Takes the next file and draws; what it did, and when the picture was there.
  async next() {
    const start = performance.now();
    const step = await mesh.next(url);
    geometry.index.needsUpdate = true;
    geometry.attributes.position.data.needsUpdate = true;
    renderer.render(scene, camera);
    renderer.getContext().finish();
    return { ...step, shownAfter: performance.now() - start };
  },
  digest,
  /// How many pixels are drawn.
  covered() {
    const pixels = pixelsOf(renderer.domElement);
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) count += pixels[i] < 250 ? 1 : 0;
    return count;
  },
};
