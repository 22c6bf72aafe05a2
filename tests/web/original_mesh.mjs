// Meshes as three.js itself reads their files, for pages that compare hierarchies with what they were made from.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MTLLoader } from 'three/addons/loaders/MTLLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { PLYLoader } from 'three/addons/loaders/PLYLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

async function loadPly(url) {
  const geometry = await new PLYLoader().loadAsync(url);
  if (geometry.getAttribute('normal') === undefined) geometry.computeVertexNormals();
  return new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ vertexColors: geometry.getAttribute('color') !== undefined }));
}

async function loadObj(url) {
  const library = /^mtllib +(.+?)\s*$/m.exec(await (await fetch(url)).text())?.[1];
  const loader = new OBJLoader();
  if (library !== undefined) {
    const folder = url.slice(0, url.lastIndexOf('/') + 1);
    const materials = await new MTLLoader().setPath(folder).loadAsync(library);
    materials.preload();
    loader.setMaterials(materials);
  }
  const object = await loader.loadAsync(url);
  for (const material of materialsOf(object)) {
    if (material.map) material.color.set(0xffffff); // Kd stands for a picture that is not there
  }
  return object;
}

async function loadGltf(url) {
  const { scene } = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync(url);
  return scene;
}

/// All pictures that were begun are there.
function pictures() {
  return new Promise((resolve, reject) => {
    THREE.DefaultLoadingManager.onLoad = resolve;
    THREE.DefaultLoadingManager.onError = (url) => reject(new Error(`${url} cannot be loaded`));
  });
}

/// An object of the mesh in a PLY, OBJ or glTF file, with its pictures. Both sides of its triangles are drawn.
export async function loadMesh(url) {
  const loaders = { ply: loadPly, obj: loadObj, gltf: loadGltf, glb: loadGltf };
  const all = pictures();
  const object = await loaders[url.slice(url.lastIndexOf('.') + 1)](url);
  await all;
  for (const material of materialsOf(object)) material.side = THREE.DoubleSide;
  return object;
}

function materialsOf(object) {
  const found = new Set();
  object.traverse((node) => [node.material ?? []].flat().forEach((material) => found.add(material)));
  return found;
}

/// The material's colours without light. What blends is drawn as a mask: tiles have no order.
function unlitOf({ map, color, vertexColors, alphaTest, transparent, opacity }) {
  return new THREE.MeshBasicMaterial({
    map, color, vertexColors, opacity,
    alphaTest: transparent ? opacity / 2 : alphaTest,
    side: THREE.DoubleSide,
  });
}

/// Draws an object without light from now on.
export function takeLight(object) {
  object.traverse((node) => {
    if (Array.isArray(node.material)) node.material = node.material.map(unlitOf);
    else if (node.material !== undefined) node.material = unlitOf(node.material);
  });
}
