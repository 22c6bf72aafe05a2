// A square with a picture of four colours, one in each corner, so that it shows whether a picture is lit, flipped or turned.
//
//   node textured_square.mjs FOLDER      writes textured.obj, .mtl and .png there
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

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folder = process.argv[2];
  writeFileSync(path.join(folder, 'textured.obj'), square());
  writeFileSync(path.join(folder, 'textured.mtl'), 'newmtl square\nmap_Kd textured.png\n');
  writeFileSync(path.join(folder, 'textured.png'), png(TEXELS, TEXELS, colourAt));
}
