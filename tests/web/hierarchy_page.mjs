// The viewer's library in a three scene that is not its own: what is drawn, fetched and held, frame by frame.
import * as THREE from 'three';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';
import { HierarchyView, tilePath } from 'meshhier-viewer';
import { coveredAround } from './pixels.mjs';
import { random } from './random.mjs';

const renderer = new THREE.WebGLRenderer({ antialias: false });
renderer.setClearColor(0xffffff, 1);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(40, 1, 1, 2);
const shown = new THREE.Scene();
const original = new THREE.Scene();
for (const scene of [shown, original]) {
  const light = new THREE.HemisphereLight(0xffffff, 0x202020, 3);
  light.position.set(1, 1, 0.5);
  scene.add(light);
}

const viewport = { width: 0, height: 0 };
let view = null;
let sphere = null;
let mesh = null;
let problems = [];
/// Milliseconds of a clock that tests can turn.
let clock = 0;

function setSize(size) {
  Object.assign(viewport, { width: size, height: size });
  renderer.setPixelRatio(1);
  renderer.setSize(size, size);
}

/// Turns (x, y, z) to (x, z, -y) for meshes that stand so.
async function loadOriginal(url, up) {
  const geometry = await new PLYLoader().loadAsync(url);
  geometry.deleteAttribute('color');
  mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ side: THREE.DoubleSide, flatShading: true }));
  if (up === 'z') mesh.rotation.x = -Math.PI / 2;
  original.add(mesh);
}

function render(scene) {
  renderer.render(scene, camera);
}

/// One frame: true if there was something new to draw.
function frame(now) {
  const isNew = view.update(camera, viewport, now);
  render(shown);
  return isNew;
}

function nextFrame() {
  return new Promise((resolve) => requestAnimationFrame(resolve));
}

function pose({ direction, distance, target = [0, 0, 0] }) {
  const at = new THREE.Vector3(...target).multiplyScalar(sphere.radius).add(sphere.center);
  const away = distance * sphere.radius;
  camera.position.copy(at).add(new THREE.Vector3(...direction).setLength(away));
  camera.up.set(0, 1, 0.0001).normalize();
  camera.lookAt(at);
  const far = camera.position.distanceTo(sphere.center) + 1.1 * sphere.radius;
  camera.near = Math.max(far / 10_000, away - 2.2 * sphere.radius);
  camera.far = far;
  camera.updateProjectionMatrix();
}

/// Goes on until nothing is left to refine. The clock of the view jumps over the time in which it waits whether the camera
/// moves on.
async function settle() {
  const began = performance.now();
  for (;;) {
    frame((clock += 50));
    if (view.stats().settled) break;
    if (performance.now() - began > 240_000) throw new Error(`does not settle: ${JSON.stringify(view.stats())}`);
    await new Promise((resolve) => setTimeout(resolve, view.stats().moving ? 0 : 4));
  }
  return { ...view.stats(), took: performance.now() - began };
}

/// A target of floats, and what is drawn into it of a scene with one material.
const measured = new THREE.WebGLRenderTarget(1, 1, { type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter });

function measure(scene, material, from = camera) {
  const { width, height } = viewport;
  measured.setSize(width, height);
  renderer.setRenderTarget(measured);
  scene.overrideMaterial = material;
  renderer.clear();
  renderer.render(scene, from);
  scene.overrideMaterial = null;
  const pixels = new Float32Array(4 * width * height);
  renderer.readRenderTargetPixels(measured, 0, 0, width, height, pixels);
  renderer.setRenderTarget(null);
  return Float32Array.from({ length: width * height }, (_, i) => pixels[4 * i]);
}

/// All that was asked for has come, as it does within the time that the view's clock jumps over.
async function arrived() {
  const began = performance.now();
  do await new Promise((resolve) => setTimeout(resolve));
  while (view.stats().pending > 0 && performance.now() - began < 60_000);
}

const VERTEX = `varying float depth;
  void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    depth = -p.z;
    gl_Position = projectionMatrix * p;
  }`;

/// Distance along the view's axis; 1 where nothing is, and the clear colour is white.
const depthMaterial = new THREE.ShaderMaterial({
  side: THREE.DoubleSide,
  vertexShader: VERTEX,
  fragmentShader: 'varying float depth; void main() { gl_FragColor = vec4(-depth, 0.0, 0.0, 1.0); }',
});

/// All triangles at a pixel: how many more show their front than their back, beside the clear colour's 1.
const crossingMaterial = new THREE.ShaderMaterial({
  side: THREE.DoubleSide,
  depthTest: false,
  depthWrite: false,
  blending: THREE.CustomBlending,
  blendSrc: THREE.OneFactor,
  blendDst: THREE.OneFactor,
  vertexShader: VERTEX,
  fragmentShader: 'void main() { gl_FragColor = vec4(gl_FrontFacing ? 1.0 : -1.0, 0.0, 0.0, 1.0); }',
});

/// Looks at the whole of the model from the side where the other camera is. Rasterizers that cut a triangle off at the end of
/// the picture move its edges a little: here nothing is cut off.
const judge = new THREE.PerspectiveCamera(40, 1, 1, 2);

function placeJudge() {
  const { center, radius } = sphere;
  judge.position.copy(camera.position).sub(center).setLength(3.2 * radius).add(center);
  judge.near = 2 * radius;
  judge.far = 5 * radius;
  judge.lookAt(center);
  judge.updateProjectionMatrix();
}

/// Pixels where a ray enters the surface, anywhere in the cut, more or less often than it leaves: there is a crack. Not one of
/// a closed mesh.
function cracks() {
  placeJudge();
  return measure(shown, crossingMaterial, judge).reduce((sum, count) => sum + (count === 1 ? 0 : 1), 0);
}

/// Pixels from an edge that are not compared.
const EDGE = 3;

/// Where one part of the surface ends before another: neighbours further from each other than a surface as steep as this.
const STEEPEST = 8;

/// Marks what the original certainly covers: not next to where its silhouette, or that of one of its parts, runs.
function innerPart() {
  const { width, height } = viewport;
  const depth = measure(original, depthMaterial);
  const step = (STEEPEST * 2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
  const continues = (i, j) => depth[j] <= 0 && Math.abs(depth[i] - depth[j]) <= -step * depth[i];
  const covered = Uint8Array.from(depth, (value, i) =>
    value <= 0 && (i % width === 0 || continues(i, i - 1)) && (i < width || continues(i, i - width)) ? 1 : 0);
  return { width, covered };
}

function isInside(i, reach) {
  const { width, height } = viewport;
  const [x, y] = [i % width, Math.floor(i / width)];
  return x >= reach && y >= reach && x < width - reach && y < height - reach;
}

/// Pixels of the background although the original covers all within `reach` of them. Closer to the picture's end nobody
/// knows.
function holes(reach) {
  const whole = innerPart();
  const ours = measure(shown, depthMaterial);
  const found = [];
  for (let i = 0; i < ours.length; ++i) if (ours[i] > 0 && isInside(i, reach) && coveredAround(whole, i, reach)) found.push(i);
  return { holes: found.length, cracks: cracks(), covered: whole.covered.reduce((sum, each) => sum + each, 0) };
}

/// How far the picture's surface is from the original's, in pixels, where both have one: the 99th percentile.
function deviation() {
  const { height } = viewport;
  const pixel = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
  const whole = innerPart();
  const [ours, theirs] = [measure(shown, depthMaterial), measure(original, depthMaterial)];
  const apart = [];
  for (let i = 0; i < ours.length; ++i)
    if (isInside(i, EDGE) && coveredAround(whole, i, EDGE) && ours[i] <= 0) apart.push(Math.abs(ours[i] - theirs[i]) / (-theirs[i] * pixel));
  apart.sort((a, b) => a - b);
  return { compared: apart.length, pixels: apart[Math.floor(0.99 * apart.length)] ?? Infinity };
}

/// The picture in grey, with several samples a pixel, of both sides of triangles or of one.
function shade(side) {
  const { width, height } = viewport;
  const target = new THREE.WebGLRenderTarget(width, height, { samples: 4 });
  shown.traverse((object) => {
    if (object.isMesh) Object.assign(object.material, { side, needsUpdate: true });
  });
  renderer.setRenderTarget(target);
  render(shown);
  const pixels = new Uint8Array(4 * width * height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
  renderer.setRenderTarget(null);
  target.dispose();
  return Uint8Array.from({ length: width * height }, (_, i) => pixels[4 * i + 1]);
}

/// Levels of grey, out of 256, that nobody sees along an edge.
const UNSEEN = 48;

/// Pixels of the finished picture that backs of a closed mesh change although its front hides them.
function backs() {
  const [both, front, back] = [THREE.DoubleSide, THREE.FrontSide, THREE.BackSide].map(shade);
  shade(THREE.DoubleSide);
  const differing = (one) => both.reduce((sum, grey, i) => sum + (Math.abs(grey - one[i]) > UNSEEN ? 1 : 0), 0);
  return Math.min(differing(front), differing(back));
}

let opened = null;

async function openView({ url, size, settings = {}, look = {} }) {
  setSize(size);
  problems = [];
  view = new HierarchyView(url, { settings, look });
  view.addEventListener('problem', ({ message }) => problems.push(message));
  shown.add(view);
  await view.opened;
  sphere = view.box.getBoundingSphere(new THREE.Sphere());
}

window.view = {
  async open(what) {
    opened = what;
    await openView(what);
    const manifest = await (await fetch(`${what.url}/hierarchy.json`)).json();
    if (what.original) await loadOriginal(what.original, manifest.up);
  },
  /// The same hierarchy again, with nothing fetched yet.
  async reopen(changes = {}) {
    view.dispose();
    await openView({ ...opened, ...changes });
  },
  /// Bytes of the script's heap, after what is of no use was collected.
  heap() {
    globalThis.gc?.();
    return performance.memory.usedJSHeapSize;
  },
  pose,
  settle,
  set: (settings) => view.setSettings(settings),
  look: (look) => view.setLook(look),
  /// Goes on by a frame, whatever is there by now.
  async frame() {
    await nextFrame();
    frame((clock += 16));
    return view.stats();
  },
  holes,
  deviation,
  backs,
  /// Fetches what is in view as a client does that keeps nothing; how long that takes.
  async fetchWhole() {
    const files = view.shown.map((node) => `${opened.url}/${tilePath(node)}`);
    const began = performance.now();
    const next = async () => {
      for (let file = files.pop(); file !== undefined; file = files.pop()) await (await fetch(file, { cache: 'no-store' })).arrayBuffer();
    };
    await Promise.all(Array.from({ length: 6 }, next));
    return performance.now() - began;
  },
  stats: () => ({ ...view.stats(), problems }),
  /// Circles for so many `seconds` of a clock that stands for a slow GPU: each frame takes `base` milliseconds, and
  /// `perTriangle` more for each triangle. What each frame took and showed.
  async circle({ seconds, base, perTriangle, distance }) {
    const frames = [];
    let took = base;
    for (let at = 0; at < 1000 * seconds; at += took) {
      await nextFrame();
      await arrived();
      pose({ direction: [Math.cos(at / 4000), 0.3, Math.sin(at / 4000)], distance });
      frame((clock += took));
      const { triangles, vertexBudget } = view.stats();
      took = base + triangles * perTriangle;
      frames.push({ at, took, triangles, vertexBudget });
    }
    return frames;
  },
  /// `steps` looks from anywhere at anything, `milliseconds` of the view's time apart: what is held at the most.
  async wander({ steps, milliseconds, seed }) {
    const next = random(seed);
    let geometries = 0;
    let mostTiles = 0;
    for (let step = 0; step < steps; ++step) {
      const around = () => 2 * next() - 1;
      pose({ direction: [around(), around(), around()], distance: 0.05 + 2.5 * next() ** 2, target: [around() / 2, around() / 2, around() / 2] });
      for (let rest = 0; rest < 3; ++rest) {
        clock += milliseconds / 3;
        await arrived();
        frame(clock);
        mostTiles = Math.max(mostTiles, view.stats().residentTiles);
      }
      geometries = Math.max(geometries, renderer.info.memory.geometries);
    }
    return { ...view.stats(), geometries, mostTiles, problems };
  },
  close() {
    view.dispose();
    mesh?.removeFromParent();
    mesh?.geometry.dispose();
    mesh = null;
    render(shown);
    return { ...renderer.info.memory };
  },
};
