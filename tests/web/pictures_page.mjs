// Draws the pictures of the README: levels side by side, and a cut that mixes levels.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { HierarchyView, tilePath } from 'meshhier-viewer';

const GOLDEN = 0.618034; // colours of neighbours in a list lie far apart
/// From coarse to fine.
const LEVEL_COLOURS = [0x4f8fd0, 0x58b8b0, 0x93c95f, 0xf0cf55, 0xee8f4d, 0xdf5b55];
const LONGEST_WAIT = 240_000; // milliseconds

function makeScene() {
  const scene = new THREE.Scene();
  const sky = new THREE.HemisphereLight(0xffffff, 0x606060, 1.7);
  const sun = new THREE.DirectionalLight(0xffffff, 1.5);
  sun.position.set(-1, 2, 3);
  scene.add(sky, sun);
  return scene;
}

function makeRenderer(figure, width, height) {
  document.querySelector(`#${figure}`).style.display = 'block';
  const canvas = document.querySelector(`#${figure} canvas`);
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  renderer.setClearColor(0xffffff, 1);
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  return renderer;
}

/// Stands `distance` radii from `target`, which is relative to the middle of the model, in radii.
function placeCamera(camera, box, { direction, distance, target }) {
  const { center, radius } = box.getBoundingSphere(new THREE.Sphere());
  const at = new THREE.Vector3(...target).multiplyScalar(radius).add(center);
  camera.position.copy(at).add(new THREE.Vector3(...direction).setLength(distance * radius));
  camera.near = 0.01 * distance * radius;
  camera.far = (distance + 4) * radius;
  camera.lookAt(at);
  camera.updateProjectionMatrix();
}

function surfaceMaterial(colour) {
  return new THREE.MeshStandardMaterial({
    color: colour, roughness: 0.8, side: THREE.DoubleSide, flatShading: true,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4,
  });
}

// ---- levels

/// A tile as any glTF viewer shows it, in a colour of its own.
async function loadTile(loader, url, index, wires) {
  const { scene } = await loader.loadAsync(url);
  const colour = new THREE.Color().setHSL((index * GOLDEN + 0.58) % 1, 0.5, 0.62);
  const meshes = [];
  scene.traverse((object) => object.isMesh && meshes.push(object));
  for (const mesh of meshes) {
    mesh.material = surfaceMaterial(colour);
    if (wires !== null) mesh.add(new THREE.LineSegments(new THREE.WireframeGeometry(mesh.geometry), wires));
  }
  return scene;
}

/// `tiles`: the indices of the level's tiles; `wires`: how dark they are, 0 to 1.
async function loadLevel(url, { level, tiles, wires: opacity }) {
  const loader = new GLTFLoader();
  const scene = makeScene();
  const wires = opacity > 0 ? new THREE.LineBasicMaterial({ color: 0x101418, transparent: true, opacity, depthWrite: false }) : null;
  for (const index of tiles) scene.add(await loadTile(loader, `${url}/${tilePath({ level, index })}`, index, wires));
  return scene;
}

async function drawLevels({ url, levels, size: [width, height], angle, pose }) {
  const renderer = makeRenderer('levels', width * levels.length, height);
  renderer.setScissorTest(true);
  const camera = new THREE.PerspectiveCamera(angle, width / height, 1, 2);
  for (const [place, level] of levels.entries()) {
    const scene = await loadLevel(url, level);
    if (place === 0) placeCamera(camera, new THREE.Box3().setFromObject(scene), pose);
    renderer.setViewport(place * width, 0, width, height);
    renderer.setScissor(place * width, 0, width, height);
    renderer.render(scene, camera);
    const label = document.createElement('div');
    label.textContent = level.label;
    document.querySelector('#levels figcaption').append(label);
  }
}

// ---- the cut

/// Fine levels have warm colours, coarse ones cold.
function levelColour(level, levels) {
  const place = levels.length > 1 ? levels.indexOf(level) / (levels.length - 1) : 1;
  return new THREE.Color(LEVEL_COLOURS[Math.round(place * (LEVEL_COLOURS.length - 1))]);
}

/// Tiles of a level are a little lighter or darker.
function paintByLevel(view, levels) {
  view.traverse((object) => {
    if (!object.resident || !object.visible) return;
    const { level, index } = object.resident.node;
    const nearest = Math.min(Math.max(level, levels[0]), levels.at(-1)); // those out of view may be of other levels
    object.material.color.copy(levelColour(nearest, levels)).multiplyScalar(0.88 + 0.24 * ((index * GOLDEN) % 1));
  });
}

function showLegend(levels, counts) {
  for (const level of levels) {
    const entry = document.createElement('span');
    const box = document.createElement('i');
    box.style.background = levelColour(level, levels).getStyle();
    entry.append(box, `level ${level}: ${counts[level]} tile${counts[level] === 1 ? '' : 's'}`);
    document.querySelector('#cut figcaption').append(entry);
  }
}

/// Resolves when nothing is left to fetch or refine.
async function settle(view, camera, viewport) {
  for (let clock = 0; !view.stats().settled; clock += 50) {
    if (clock > LONGEST_WAIT) throw new Error(`does not settle: ${JSON.stringify(view.stats())}`);
    view.update(camera, viewport, clock);
    await new Promise((resolve) => setTimeout(resolve, 4));
  }
}

/// Returns the levels in view, ascending, and the tiles in view of each.
async function drawCut({ url, size: [width, height], angle, threshold, pose }) {
  const renderer = makeRenderer('cut', width, height);
  const camera = new THREE.PerspectiveCamera(angle, width / height, 1, 2);
  const scene = makeScene();
  const view = new HierarchyView(url, { settings: { threshold }, look: { colours: 'plain', shading: 'flat', wires: true } });
  scene.add(view);
  await view.opened;
  placeCamera(camera, view.box, pose);
  await settle(view, camera, { width, height });
  const counts = {};
  for (const { level } of view.shown) counts[level] = (counts[level] ?? 0) + 1;
  const levels = Object.keys(counts).map(Number).sort((a, b) => a - b);
  paintByLevel(view, levels);
  renderer.render(scene, camera);
  showLegend(levels, counts);
  return { levels, counts, triangles: view.stats().triangles };
}

window.view = { drawLevels, drawCut };
