// A square with a picture of four colours, one in each corner, so that it shows whether a picture is lit, flipped or turned.
//
//   node textured_square.mjs FOLDER      writes textured.obj, .mtl and .png there; and the square with the same colours at its vertices,
//                                        as each format has them: coloured_bytes.ply, coloured_floats.obj, coloured_light.glb; in materials:
//                                        coloured_parts.glb, coloured_kd.obj
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { png } from './png.mjs';

const STEPS = 60; // along a side: enough triangles for several levels of small tiles
const TEXELS = 512;

/// As the square's front is seen.
export const CORNERS = [
  { name: 'upper left', right: -1, up: 1, colour: [200, 60, 40] },
  { name: 'upper right', right: 1, up: 1, colour: [60, 160, 70] },
  { name: 'lower left', right: -1, up: -1, colour: [50, 80, 190] },
  { name: 'lower right', right: 1, up: -1, colour: [220, 200, 90] },
];

function colourAt(x, y) {
  const [right, up] = [x < TEXELS / 2 ? -1 : 1, y < TEXELS / 2 ? 1 : -1];
  return CORNERS.find((corner) => corner.right === right && corner.up === up).colour;
}

/// From -1 to 1 in x and y, its front towards z.
function square() {
  const lines = ['mtllib textured.mtl', 'usemtl square'];
  const number = (x, y) => 1 + x + y * (STEPS + 1);
  for (let y = 0; y <= STEPS; ++y)
    for (let x = 0; x <= STEPS; ++x) lines.push(`v ${(2 * x) / STEPS - 1} ${(2 * y) / STEPS - 1} 0`, `vt ${x / STEPS} ${y / STEPS}`);
  const face = (...corners) => lines.push(`f ${corners.map((v) => `${v}/${v}`).join(' ')}`);
  for (let y = 0; y < STEPS; ++y)
    for (let x = 0; x < STEPS; ++x) face(number(x, y), number(x + 1, y), number(x + 1, y + 1), number(x, y + 1));
  return `${lines.join('\n')}\n`;
}

function light(byte) {
  const value = byte / 255;
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
}

/// A quarter of the square: places, and corners of triangles.
function quarter({ right, up }) {
  const side = STEPS / 2 + 1;
  const places = [];
  for (let y = 0; y < side; ++y)
    for (let x = 0; x < side; ++x) places.push([(right * x) / (side - 1), (up * y) / (side - 1), 0]);
  const triangles = [];
  for (let y = 0; y + 1 < side; ++y) {
    for (let x = 0; x + 1 < side; ++x) {
      const a = x + y * side;
      const square = [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]];
      triangles.push(...square.map(([i, j, k]) => (right * up > 0 ? [i, j, k] : [i, k, j])));
    }
  }
  return { places, triangles };
}

const QUARTERS = CORNERS.map((corner) => ({ ...corner, ...quarter(corner) }));

/// Places and colours, then triangles, of all quarters as lines of text.
function lines(place, triangle) {
  const vertices = QUARTERS.flatMap(({ places, colour }) => places.map((p) => place(p, colour)));
  let first = 0;
  const faces = QUARTERS.flatMap(({ places, triangles, name }) => {
    const begin = first;
    first += places.length;
    return triangles.map((t, i) => triangle(t.map((v) => v + begin), i === 0 ? name : null));
  });
  return { vertices, faces };
}

function ply() {
  const { vertices, faces } = lines((p, colour) => [...p, ...colour].join(' '), (t) => [3, ...t].join(' '));
  const colours = ['red', 'green', 'blue'].map((name) => `property uchar ${name}`);
  const header = ['ply', 'format ascii 1.0', `element vertex ${vertices.length}`, ...['x', 'y', 'z'].map((name) => `property float ${name}`),
    ...colours, `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header'];
  return `${[...header, ...vertices, ...faces].join('\n')}\n`;
}

function obj() {
  const { vertices, faces } = lines(
    (p, colour) => `v ${[...p, ...colour.map((byte) => byte / 255)].join(' ')}`,
    (t) => `f ${t.map((v) => v + 1).join(' ')}`);
  return `${[...vertices, ...faces].join('\n')}\n`;
}

function objWithMaterials() {
  const material = (name) => (name ? `usemtl ${name.replace(' ', '_')}\n` : '');
  const { vertices, faces } = lines((p) => `v ${p.join(' ')}`, (t, name) => `${material(name)}f ${t.map((v) => v + 1).join(' ')}`);
  return `${['mtllib coloured_kd.mtl', ...vertices, ...faces].join('\n')}\n`;
}

function mtl() {
  return CORNERS.map(({ name, colour }) => `newmtl ${name.replace(' ', '_')}\nKd ${colour.map((byte) => byte / 255).join(' ')}\n`).join('');
}

/// `areParts`: colours are factors of materials, else of vertices.
function glb(areParts) {
  const views = [];
  const chunks = [];
  let size = 0;
  const accessor = (array, componentType, type, more) => {
    const bytes = Buffer.from(array.buffer);
    views.push({ buffer: 0, byteOffset: size, byteLength: bytes.length });
    chunks.push(bytes);
    size += bytes.length;
    return { bufferView: views.length - 1, componentType, type, count: array.length / { SCALAR: 1, VEC3: 3 }[type], ...more };
  };
  const accessors = [];
  const add = (...given) => accessors.push(accessor(...given)) - 1;
  const materials = [];
  const primitives = QUARTERS.map(({ places, triangles, colour }) => {
    const along = (axis) => places.map((p) => p[axis]);
    const box = { min: [0, 1, 2].map((axis) => Math.min(...along(axis))), max: [0, 1, 2].map((axis) => Math.max(...along(axis))) };
    const attributes = { POSITION: add(Float32Array.from(places.flat()), 5126, 'VEC3', box) };
    if (!areParts) attributes.COLOR_0 = add(Float32Array.from(places.flatMap(() => colour.map(light))), 5126, 'VEC3', {});
    const baseColorFactor = [...(areParts ? colour.map(light) : [1, 1, 1]), 1];
    const material = materials.push({ pbrMetallicRoughness: { baseColorFactor, metallicFactor: 0 } }) - 1;
    return { attributes, indices: add(Uint32Array.from(triangles.flat()), 5125, 'SCALAR', {}), material };
  });
  const json = JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives }], materials, accessors,
    bufferViews: views, buffers: [{ byteLength: size }],
  });
  const text = Buffer.from(json.padEnd(Math.ceil(json.length / 4) * 4));
  const word = (...values) => Buffer.from(Uint32Array.from(values).buffer);
  return Buffer.concat([word(0x46546c67, 2, 28 + text.length + size, text.length, 0x4e4f534a), text, word(size, 0x004e4942), ...chunks]);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folder = process.argv[2];
  writeFileSync(path.join(folder, 'textured.obj'), square());
  writeFileSync(path.join(folder, 'textured.mtl'), 'newmtl square\nmap_Kd textured.png\n');
  writeFileSync(path.join(folder, 'textured.png'), png(TEXELS, TEXELS, colourAt));
  writeFileSync(path.join(folder, 'coloured_bytes.ply'), ply());
  writeFileSync(path.join(folder, 'coloured_floats.obj'), obj());
  writeFileSync(path.join(folder, 'coloured_light.glb'), glb(false));
  writeFileSync(path.join(folder, 'coloured_parts.glb'), glb(true));
  writeFileSync(path.join(folder, 'coloured_kd.obj'), objWithMaterials());
  writeFileSync(path.join(folder, 'coloured_kd.mtl'), mtl());
}
