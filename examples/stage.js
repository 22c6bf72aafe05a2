// SPDX-License-Identifier: MIT
// A scene of three with light, a camera that the pointer turns, and a canvas as large as the window.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

export const renderer = new THREE.WebGLRenderer({ antialias: true, stencil: true });
export const scene = new THREE.Scene();
export const camera = new THREE.PerspectiveCamera(45);

renderer.setPixelRatio(devicePixelRatio);
document.body.append(renderer.domElement);
scene.background = new THREE.Color('#1c2530');
const light = new THREE.DirectionalLight('#ffffff', 2.2);
light.position.set(-1, 1, 2); // the camera takes it along: from the left, above and behind it
camera.add(light);
scene.add(camera, new THREE.AmbientLight('#ffffff', 0.4));

function fitWindow() {
  renderer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
}
addEventListener('resize', fitWindow);
fitWindow();

/// Looks at all of a sphere, from the front and above.
export function frame({ center, radius }, up) {
  const distance = (2.6 * radius) / Math.min(1, camera.aspect);
  const front = Math.abs(up.y) > 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(0, -1, 0).projectOnPlane(up);
  camera.up.copy(up);
  camera.near = 1e-3 * radius;
  camera.far = 100 * radius;
  camera.position.copy(center).addScaledVector(front.normalize().addScaledVector(up, 0.4).normalize(), distance);
  camera.updateProjectionMatrix();
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.copy(center);
  controls.update();
}
