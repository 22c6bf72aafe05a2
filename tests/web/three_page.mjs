// Shows a tileset with 3d-tiles-renderer and compares it with the mesh it was made from.
import * as THREE from 'three';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { TilesRenderer } from '3d-tiles-renderer/three';
import { GLTFExtensionsPlugin } from '3d-tiles-renderer/three/plugins';
import { loadMesh, takeLight } from './original_mesh.mjs';
import { coveredAround, pixelsOf, signalToNoise, standing } from './pixels.mjs';

const SIZE = 512;
/// How many times a tile's error its `geometricError` is, by default.
const PIXELS_AN_ERROR = 16;
// Frames without anything under way before the picture counts as complete.
const QUIET_FRAMES = 10;
// Within so many milliseconds something is in sight: what has come may be in no count for a while.
const LONGEST = 120_000;

const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE);
renderer.setClearColor(0xffffff);
document.body.append(renderer.domElement);

const ktxLoader = new KTX2Loader().setTranscoderPath('/modules/three/examples/jsm/libs/basis/').detectSupport(renderer);

const camera = new THREE.PerspectiveCamera(40, 1, 1, 2);
const shown = new THREE.Scene();
const original = new THREE.Scene();
for (const scene of [shown, original]) {
  scene.add(new THREE.HemisphereLight(0xffffff, 0x404040, 3));
}

// Distance along the view axis of what is drawn, 0 where nothing is.
const depthTarget = new THREE.WebGLRenderTarget(SIZE, SIZE, {
  type: THREE.FloatType,
  minFilter: THREE.NearestFilter,
  magFilter: THREE.NearestFilter,
});
const depthMaterial = new THREE.ShaderMaterial({
  side: THREE.DoubleSide,
  vertexShader: `
    varying float distance_;
    void main() {
      vec4 p = modelViewMatrix * vec4(position, 1.0);
      distance_ = -p.z;
      gl_Position = projectionMatrix * p;
    }`,
  fragmentShader: 'varying float distance_; void main() { gl_FragColor = vec4(distance_); }',
});

let tiles = null;
let sphere = null;
let failures = [];

function depthOf(scene) {
  scene.overrideMaterial = depthMaterial;
  renderer.setClearColor(0x000000, 0);
  renderer.setRenderTarget(depthTarget);
  renderer.clear();
  renderer.render(scene, camera);
  const pixels = new Float32Array(SIZE * SIZE * 4);
  renderer.readRenderTargetPixels(depthTarget, 0, 0, SIZE, SIZE, pixels);
  renderer.setRenderTarget(null);
  renderer.setClearColor(0xffffff, 1);
  scene.overrideMaterial = null;
  return Float32Array.from({ length: SIZE * SIZE }, (_, i) => pixels[4 * i]);
}

function frame() {
  return new Promise((resolve) => requestAnimationFrame(resolve));
}

/// Around the middle of its box.
function sphereAround(object) {
  const center = new THREE.Box3().setFromObject(object, true).getCenter(new THREE.Vector3());
  let square = 0;
  const point = new THREE.Vector3();
  object.traverse((node) => {
    const positions = node.geometry?.getAttribute('position');
    for (let i = 0; i < (positions?.count ?? 0); ++i) {
      point.fromBufferAttribute(positions, i).applyMatrix4(node.matrixWorld);
      square = Math.max(square, point.distanceToSquared(center));
    }
  });
  return new THREE.Sphere(center, Math.sqrt(square));
}

/// Loads the mesh as 3D Tiles turn it: `up` is the axis of the mesh that points up.
async function loadOriginal(mesh, up) {
  const object = await loadMesh(mesh);
  if (up === 'y') object.rotation.x = Math.PI / 2;
  original.add(object);
  object.updateMatrixWorld(true);
  sphere = sphereAround(object);
}

/// Loads the tileset, and its `mesh`, if one is given to compare with.
async function load({ tileset, mesh, up }) {
  failures = [];
  tiles = new TilesRenderer(tileset);
  tiles.registerPlugin(new GLTFExtensionsPlugin({ meshoptDecoder: MeshoptDecoder, ktxLoader, autoDispose: false }));
  tiles.addEventListener('load-error', (event) => failures.push(String(event.error ?? event.url)));
  tiles.setCamera(camera);
  tiles.setResolution(camera, SIZE, SIZE);
  shown.add(tiles.group);
  if (mesh !== undefined) {
    await loadOriginal(mesh, up);
    return;
  }
  sphere = new THREE.Sphere();
  while (!tiles.getBoundingSphere(sphere)) {
    await frame();
    tiles.update();
  }
}

/// Looks at the model from `direction`. `distance`: in radii of its sphere, from its middle, moved by `middle`, or,
/// if `close`, from the point of the mesh that is nearest to the eye that looks at the middle.
function look({ direction, distance, close = false, target: middle = [0, 0, 0] }) {
  const from = new THREE.Vector3(...direction).normalize();
  let target = new THREE.Vector3(...middle).multiplyScalar(sphere.radius).add(sphere.center);
  if (close) {
    const ray = new THREE.Raycaster(target.clone().addScaledVector(from, 4 * sphere.radius), from.clone().negate());
    target = ray.intersectObjects(original.children, true)[0]?.point ?? target;
  }
  camera.position.copy(target).addScaledVector(from, distance * sphere.radius);
  camera.near = (close ? 0.2 : 0.5) * distance * sphere.radius;
  if (!close) camera.near = Math.max(camera.near, (distance - 1.2) * sphere.radius);
  camera.far = (distance + 3) * sphere.radius;
  camera.up.set(0, 0, 1);
  camera.lookAt(target);
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld(true);
}

/// Refines until nothing is left to do for `errorTarget` pixels.
async function settle(errorTarget) {
  tiles.errorTarget = PIXELS_AN_ERROR * errorTarget;
  const began = performance.now();
  for (let quiet = 0; quiet < QUIET_FRAMES; ) {
    await frame();
    tiles.update();
    renderer.render(shown, camera);
    const { queued = 0, downloading, parsing } = tiles.stats;
    const isComing = queued + downloading + parsing > 0;
    const isThere = tiles.visibleTiles.size > 0 || failures.length > 0 || performance.now() - began > LONGEST;
    quiet = isComing || !isThere ? 0 : quiet + 1;
  }
  const names = [];
  tiles.forEachLoadedModel((scene, tile) => {
    if (tiles.visibleTiles.has(tile)) names.push(new URL(tile.content.uri, location.href).pathname);
  });
  return { visible: names.sort(), failures };
}

/// How the picture differs from that of the original mesh. A hole: a pixel without anything where
/// the original is covered as far as the error reaches, and a pixel more.
function compare(errorTarget) {
  const reach = Math.ceil(errorTarget) + 1;
  const ours = depthOf(shown);
  const theirs = depthOf(original);
  const drawn = { covered: theirs, width: SIZE };
  const differences = [];
  let covered = 0, outline = 0, holes = 0;
  for (let y = 1; y + 1 < SIZE; ++y) {
    for (let x = 1; x + 1 < SIZE; ++x) {
      const i = y * SIZE + x;
      if (theirs[i] > 0) ++covered;
      if (theirs[i] > 0 !== ours[i] > 0) ++outline;
      if (theirs[i] > 0 && ours[i] > 0) differences.push(Math.abs(ours[i] - theirs[i]));
      if (!(ours[i] > 0) && coveredAround(drawn, i, reach)) ++holes;
    }
  }
  differences.sort((a, b) => a - b);
  const at = (part) => differences[Math.floor(part * (differences.length - 1))] ?? Infinity;
  return {
    covered,
    outline: outline / covered,
    holes,
    depth: { median: at(0.5) / sphere.radius, most: at(0.99) / sphere.radius },
  };
}

/// The picture of the original mesh, instead of the tileset's.
function showOriginal() {
  renderer.render(original, camera);
}

/// How near the tileset's picture is to that of the original mesh, both without light, in decibels where both cover pixels, and which
/// part of the covered pixels only one of them does.
function comparePictures() {
  const covered = [depthOf(shown), depthOf(original)];
  const pictures = [shown, original].map((scene) => {
    takeLight(scene);
    renderer.render(scene, camera);
    return pixelsOf(renderer.domElement);
  });
  return signalToNoise(pictures, covered);
}

/// Tells what stands in the tileset's picture (pixels.mjs).
function stand() {
  const covered = depthOf(shown);
  renderer.render(shown, camera);
  return standing({ covered, width: SIZE }, pixelsOf(renderer.domElement));
}

function rayThrough([x, y]) {
  const caster = new THREE.Raycaster();
  caster.setFromCamera(new THREE.Vector2((2 * x) / SIZE - 1, 1 - (2 * y) / SIZE), camera);
  return caster;
}

function raysThrough(places) {
  return places.map((place) => {
    const { origin, direction } = rayThrough(place).ray;
    return { from: origin.toArray(), direction: direction.toArray() };
  });
}

/// Returns the properties of the things at places of the picture; null where nothing is.
function pickAll(places) {
  return Promise.all(places.map(async (place) => {
    const [hit] = rayThrough(place).intersectObject(tiles.group, true);
    if (hit === undefined) return null;
    const { meshFeatures, structuralMetadata } = hit.object.userData;
    const ids = await meshFeatures.getFeaturesAsync(hit.faceIndex, hit.barycoord);
    const [{ propertyTable }] = meshFeatures.getFeatureInfo();
    return structuralMetadata.getPropertyTableData([propertyTable], ids)[0];
  }));
}

/// Shows the tileset's colours without light from now on.
function showColours() {
  tiles.forEachLoadedModel((scene) => takeLight(scene));
  tiles.addEventListener('load-model', ({ scene }) => takeLight(scene));
}

window.view = { showColours, raysThrough, pickAll, load, look, settle, compare, comparePictures, showOriginal, stand };
