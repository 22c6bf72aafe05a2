// SPDX-License-Identifier: MIT
// A house of two storeys as if scanned from within, in metres, y up: rooms with a door between them, stairs, furniture.
//
//     z                ground                      upper
//     8  +--+--------------+------------+   +---------+  +-------------+
//        |##|              |            |   |            |   (door)    |
//     6  |##|              |            |   +---------+  +-------------+
//     5  |                 |         +--|   |                       .--|
//     4  |               (door)      |st|   |                       |  |   st: stairs, up along z
//        |    table        |         |ai|   |   bed          railing|  |
//     1  |                 |         +rs|   |                       '--|
//     0  +-----------------+------------+   +--------------------------+
//        0        x        6         9  10

export const HOUSE = {
  size: [10, 8],
  floors: [0, 2.8],
  ceilings: [2.5, 5.3],
  /// In plan: least x, least z, most x, most z.
  wall: { ground: [5.9, 0, 6.1, 8], upper: [0, 5.9, 10, 6.1] },
  door: { ground: [5.9, 3.5, 6.1, 4.5], upper: [2, 5.9, 3, 6.1], height: 2.1 },
  table: [2, 2, 3.5, 3],
  cupboard: [0, 5, 0.6, 7],
  bed: [1, 1, 3, 3],
  colours: { floor: [60, 190, 60], ceiling: [60, 60, 220], wall: [210, 200, 190] },
  stairs: { plan: [9, 1, 10, 4.92], steps: 14, rise: 0.2, tread: 0.28 },
};


class Mesh {
  positions = [];
  corners = [];
  colours = [];

  /// `cell`: the longest side of a square.
  constructor(cell) {
    this.cell = cell;
  }

  /// A parallelogram whose front is where `along` × `up` points to.
  face(corner, along, up, colour) {
    const length = (v) => Math.hypot(...v);
    const [columns, rows] = [along, up].map((v) => Math.max(1, Math.ceil(length(v) / this.cell - 1e-9)));
    const first = this.positions.length / 3;
    for (let v = 0; v <= rows; ++v)
      for (let u = 0; u <= columns; ++u) {
        this.positions.push(...corner.map((start, axis) => start + along[axis] * (u / columns) + up[axis] * (v / rows)));
        this.colours.push(...colour);
      }
    for (let v = 0; v < rows; ++v)
      for (let u = 0; u < columns; ++u) {
        const a = first + v * (columns + 1) + u;
        this.corners.push(a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1);
      }
  }

  /// Level, in plan.
  floor([x0, z0, x1, z1], y) {
    if (x1 > x0 && z1 > z0) this.face([x0, y, z1], [x1 - x0, 0, 0], [0, 0, z0 - z1], HOUSE.colours.floor);
  }

  ceiling([x0, z0, x1, z1], y) {
    if (x1 > x0 && z1 > z0) this.face([x0, y, z0], [x1 - x0, 0, 0], [0, 0, z1 - z0], HOUSE.colours.ceiling);
  }

  /// Upright, from one place in plan to another; its front is to the left of the way.
  wall([x0, z0], [x1, z1], [low, high]) {
    this.face([x0, low, z0], [x1 - x0, 0, z1 - z0], [0, high - low, 0], HOUSE.colours.wall);
  }

  /// Walls around, seen from outside of it.
  around([x0, z0, x1, z1], heights) {
    this.wall([x0, z1], [x1, z1], heights);
    this.wall([x1, z1], [x1, z0], heights);
    this.wall([x1, z0], [x0, z0], heights);
    this.wall([x0, z0], [x0, z1], heights);
  }

  /// The same, seen from within.
  within([x0, z0, x1, z1], heights) {
    this.wall([x1, z1], [x0, z1], heights);
    this.wall([x1, z0], [x1, z1], heights);
    this.wall([x0, z0], [x1, z0], heights);
    this.wall([x0, z1], [x0, z0], heights);
  }

  box(plan, [low, high]) {
    this.around(plan, [low, high]);
    this.floor(plan, high);
    this.ceiling(plan, low);
  }
}

/// A rectangle without a smaller one in it.
function without([x0, z0, x1, z1], [a, b, c, d]) {
  return [[x0, z0, x1, b], [x0, d, x1, z1], [x0, b, a, d], [c, b, x1, d]];
}

/// A wall across a storey, with a door in it.
function partition(mesh, [x0, z0, x1, z1], [a, b, c, d], floor, ceiling) {
  const lintel = floor + HOUSE.door.height;
  const parts = x1 - x0 < z1 - z0 ? [[x0, z0, x1, b], [x0, d, x1, z1]] : [[x0, z0, a, z1], [c, z0, x1, z1]];
  for (const part of parts) mesh.around(part, [floor, ceiling]);
  mesh.around([a, b, c, d], [lintel, ceiling]);
  mesh.ceiling([a, b, c, d], lintel);
}

/// The outside of the walls and a flat roof.
function addOutside(mesh) {
  const [x, z] = HOUSE.size;
  mesh.around([-0.2, -0.2, x + 0.2, z + 0.2], [-0.3, 5.6]);
  mesh.floor([-0.2, -0.2, x + 0.2, z + 0.2], 5.6);
}

function addStairs(mesh) {
  const { plan: [x0, z0, x1], steps, rise, tread } = HOUSE.stairs;
  for (let i = 0; i < steps; ++i) {
    const [from, to] = [z0 + tread * i, z0 + tread * (i + 1)];
    mesh.wall([x1, from], [x0, from], [rise * i, rise * (i + 1)]); // seen from below, along z
    mesh.floor([x0, from, x1, to], rise * (i + 1));
    mesh.wall([x0, from], [x0, to], [0, rise * (i + 1)]);
  }
}

/// `positions`: x, y, z; `corners`: three a triangle. `outside`: its walls are seen from outside, too. `cell`: the longest side of a square, metres.
export function house({ outside = false, cell = 0.5 } = {}) {
  const mesh = new Mesh(cell);
  const [x, z] = HOUSE.size;
  const { floors, ceilings, wall, door, stairs } = HOUSE;
  const all = [0, 0, x, z];
  const well = stairs.plan;
  for (const storey of [0, 1]) mesh.within(all, [floors[storey], ceilings[storey]]);
  mesh.floor(all, floors[0]);
  for (const part of without(all, well)) {
    mesh.ceiling(part, ceilings[0]);
    mesh.floor(part, floors[1]);
  }
  mesh.within(well, [ceilings[0], floors[1]]);
  mesh.ceiling(all, ceilings[1]);
  partition(mesh, wall.ground, door.ground, floors[0], ceilings[0]);
  partition(mesh, wall.upper, door.upper, floors[1], ceilings[1]);
  addStairs(mesh);
  mesh.box([8.95, 1, 9, 4.92], [floors[1], floors[1] + 1]); // the railing
  mesh.box(HOUSE.table, [0.7, 0.75]);
  mesh.box(HOUSE.cupboard, [0, 2]);
  mesh.box(HOUSE.bed, [floors[1], floors[1] + 0.5]);
  if (outside) addOutside(mesh);
  return mesh;
}

export function plyOf({ positions, corners, colours }) {
  const rows = (values) => Array.from({ length: values.length / 3 }, (_, i) => values.slice(3 * i, 3 * i + 3).join(' '));
  const faces = rows(corners).map((row) => `3 ${row}`);
  const header = ['ply', 'format ascii 1.0', `element vertex ${positions.length / 3}`, ...['x', 'y', 'z'].map((axis) => `property float ${axis}`), ...['red', 'green', 'blue'].map((channel) => `property uchar ${channel}`), `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header'];
  const tints = rows(colours);
  return `${[...header, ...rows(positions).map((row, i) => `${row} ${tints[i]}`), ...faces].join('\n')}\n`;
}
