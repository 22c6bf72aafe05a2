// Writes a steeple as a PLY to standard output: a pyramid three times as high as wide at its foot, in
// the middle of which the origin is. Its east side is red, its north side green, the others grey.
//
//   node steeple.mjs y|z [EAST NORTH]      which axis points up: east is x, north -z or y; where the middle of its foot is, 0 0
const HALF = 50, HEIGHT = 300;
const STEPS = 24;  // along a side: enough triangles for several levels of small tiles
const SIDES = [  // the outward direction of each, in z-up coordinates, and its colour
  { out: [1, 0], colour: [255, 0, 0] },
  { out: [0, 1], colour: [0, 255, 0] },
  { out: [-1, 0], colour: [160, 160, 160] },
  { out: [0, -1], colour: [160, 160, 160] },
];

const [up, east = 0, north = 0] = [process.argv[2], ...process.argv.slice(3).map(Number)];
const vertices = [], faces = [];

function put([fromEast, fromNorth, z], colour) {
  const [x, y] = [fromEast + east, fromNorth + north];
  const turned = up === 'z' ? [x, y, z] : [x, z, -y];
  vertices.push([...turned, ...colour].join(' '));
}

// Row by row from the foot; the last row is the tip. `s`: from the left corner to the right one, seen
// from outside.
for (const { out: [x, y], colour } of SIDES) {
  const first = vertices.length;
  for (let row = 0; row <= STEPS; ++row) {
    const half = HALF * (1 - row / STEPS);
    for (let i = 0; i <= STEPS - row; ++i) {
      const s = row === STEPS ? 0 : 2 * (i / (STEPS - row)) - 1;
      put([half * (x - s * y), half * (y + s * x), (HEIGHT * row) / STEPS], colour);
    }
  }
  for (let row = 0, here = first; row < STEPS; ++row) {
    const above = here + STEPS - row + 1;
    for (let i = 0; i < STEPS - row; ++i) {
      faces.push([here + i, here + i + 1, above + i]);
      if (i > 0) faces.push([here + i, above + i, above + i - 1]);
    }
    here = above;
  }
}

const header = [
  'ply', 'format ascii 1.0', `element vertex ${vertices.length}`,
  ...['x', 'y', 'z'].map((name) => `property double ${name}`),
  ...['red', 'green', 'blue'].map((name) => `property uchar ${name}`),
  `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header',
];
console.log([...header, ...vertices, ...faces.map((face) => `3 ${face.join(' ')}`)].join('\n'));
