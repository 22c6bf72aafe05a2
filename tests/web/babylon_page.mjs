// Loads single tiles with Babylon.js, and tells what it has of them.
import { ArcRotateCamera } from '@babylonjs/core/Cameras/arcRotateCamera.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { HemisphericLight } from '@babylonjs/core/Lights/hemisphericLight.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { MeshoptCompression } from '@babylonjs/core/Meshes/Compression/meshoptCompression.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/loaders/glTF/glTFFileLoader.js';
import '@babylonjs/loaders/glTF/2.0/glTFLoader.js';
import '@babylonjs/loaders/glTF/2.0/Extensions/EXT_meshopt_compression.js';
import '@babylonjs/loaders/glTF/2.0/Extensions/EXT_texture_webp.js';
import '@babylonjs/loaders/glTF/2.0/Extensions/KHR_materials_unlit.js';
import '@babylonjs/loaders/glTF/2.0/Extensions/KHR_mesh_quantization.js';
import { pixelsOf } from './pixels.mjs';

// Its own default is on a server of its makers.
MeshoptCompression.Configuration = { decoder: { url: '/modules/meshoptimizer/meshopt_decoder.js' } };

const canvas = document.getElementById('scene');
const engine = new Engine(canvas, true, { preserveDrawingBuffer: true });
engine.setSize(512, 512);
const scene = new Scene(engine);
scene.clearColor = new Color4(0, 0, 0, 1);
new HemisphericLight('light', new Vector3(0, 1, 0), scene);
const camera = new ArcRotateCamera('camera', -Math.PI / 3, Math.PI / 3, 1, Vector3.Zero(), scene);

let container = null;

function lookAt({ min, max }) {
  const radius = Vector3.Distance(min, max) / 2;
  camera.target = min.add(max).scale(0.5);
  camera.radius = 3 * radius;
  camera.minZ = 0.01 * radius;
  camera.maxZ = 10 * radius;
}

/// Loads one tile instead of the one before, and draws it.
async function load(url) {
  container?.dispose();
  container = await LoadAssetContainerAsync(url, scene);
  container.addAllToScene();
  const bounds = scene.getWorldExtends();
  lookAt(bounds);
  await scene.whenReadyAsync();
  scene.render();
  const pixels = pixelsOf(canvas);
  const sum = (count) => container.meshes.reduce((total, mesh) => total + count(mesh), 0);
  return {
    vertices: sum((mesh) => mesh.getTotalVertices()),
    indices: sum((mesh) => mesh.getTotalIndices()),
    bounds: [bounds.min.asArray(), bounds.max.asArray()],
    covered: pixels.filter((value, i) => i % 4 === 0 && value > 5).length / (pixels.length / 4),
  };
}

/// Shows the tile's colours without light.
async function showColours() {
  for (const material of container.materials) material.unlit = true;
  await scene.whenReadyAsync();
  scene.render();
}

window.view = { load, showColours };
