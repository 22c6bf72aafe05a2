// SPDX-License-Identifier: MIT
// Chooses what a tile draws along its seams in a cut (docs/file_format.md, sections 4.5 and 4.6).
import { placeOf, verticesAt } from '../hierarchy/copies.js';
import { HierarchyProblem } from '../hierarchy/problem.js';
import { valueWidth } from '../hierarchy/scalar_values.js';
import type { Tile } from '../hierarchy/tile.js';
import { keyOf, tilePath, type Tree } from '../hierarchy/tree.js';
import type { Normals } from '../hierarchy/vertex_values.js';

/// The tiles of a cut, by key.
export type ShownTiles = ReadonlyMap<number, Tile>;

/// Where a neighbour is shown: 0 at the tile's own level, n as its ancestor n levels up.
const FINER = -1;
const UNKNOWN = -2;

type Values = Float32Array | Normals | Uint8Array;

/// Copies the values of a vertex to another one, `width` each.
function copyValues<Kind extends Values>(from: Kind, source: number, to: Kind, target: number, width: number): void {
  for (let k = 0; k < width; ++k) to[width * target + k] = from[width * source + k];
}

/// Returns the square of the distance of two vertices, of four values each.
function difference<Kind extends Values>(a: Kind, i: number, b: Kind, j: number): number {
  let sum = 0;
  for (let k = 0; k < 4; ++k) sum += (a[4 * i + k] - b[4 * j + k]) ** 2;
  return sum;
}

/// Measures a vertex's distance from what is looked for.
type Distance = (vertex: number) => number;

/// Returns the nearest of several vertices: each distance decides between those that are equally near by those before; then the first in order.
function nearest(vertices: readonly number[], ...distances: readonly Distance[]): number {
  return vertices.reduce((found, vertex) => {
    const deciding = distances.find((distance) => distance(vertex) !== distance(found));
    return deciding !== undefined && deciding(vertex) < deciding(found) ? vertex : found;
  });
}

export class Seam {
  /// Keys of neighbour i and its ancestors up to below the common one stand at `keyStarts[i]` and after.
  private readonly keys: Float64Array;
  private readonly keyStarts: Uint32Array;
  private readonly chainStarts: Uint32Array;
  private readonly neighbourOf: Uint32Array;
  private readonly coarser: Int8Array;
  private readonly shown: (Tile | null)[];
  /// The vertex of `shown` that each ghost is.
  private readonly vertices: Uint16Array;
  /// Values of ghosts and all behind them, as in the file: they move and come back. Null where the file has none.
  private readonly givenNormals: Normals | null;
  private readonly givenColours: Uint8Array | null;
  private readonly givenValues: Float32Array | null;
  /// Values of a vertex.
  private readonly width: number;
  /// A ghost was no vertex of its tile: the last one stood in, so that the surface stays whole.
  isDamaged = false;

  /// Throws if the tile's ghosts have not the chains that the tree asks for.
  constructor(
    private readonly tile: Tile,
    tree: Tree,
  ) {
    const count = tile.neighbours.length;
    this.keyStarts = new Uint32Array(count + 1);
    this.chainStarts = new Uint32Array(count + 1);
    this.neighbourOf = new Uint32Array(tile.ghosts);
    this.coarser = new Int8Array(count).fill(UNKNOWN);
    this.shown = new Array<Tile | null>(count).fill(null);
    this.vertices = new Uint16Array(tile.ghosts);
    this.givenNormals = tile.normalsFrom === 'viewer' ? null : tile.normals.slice(4 * tile.own);
    this.givenColours = tile.colours?.slice(4 * tile.own) ?? null;
    this.width = valueWidth(tile);
    this.givenValues = tile.values?.slice(this.width * tile.own) ?? null;
    this.keys = this.placeChains(tree);
    if (this.chainStarts[count] !== tile.chains.length) this.fail('its chains are not all there');
  }

  /// Bytes that this holds besides the tile.
  get bytes(): number {
    const starts = this.keyStarts.byteLength + this.chainStarts.byteLength;
    const given = (this.givenNormals?.byteLength ?? 0) + (this.givenColours?.byteLength ?? 0) + (this.givenValues?.byteLength ?? 0);
    return this.keys.byteLength + starts + given + 9 * this.coarser.length + 6 * this.vertices.length;
  }

  private fail(what: string): never {
    throw new HierarchyProblem(tilePath(this.tile), what);
  }

  private placeChains(tree: Tree): Float64Array {
    const { level, index, neighbours, ghostStarts } = this.tile;
    const keys: number[] = [];
    neighbours.forEach((neighbour, i) => {
      if (neighbour === index || neighbour >= this.nodesOn(level, tree)) this.fail('a neighbour that is no node');
      const common = tree.commonLevel(level, index, neighbour);
      for (let l = level; l > common; --l) keys.push(keyOf(l, tree.ancestor(level, neighbour, l)));
      this.keyStarts[i + 1] = keys.length;
      const ghosts = ghostStarts[i + 1] - ghostStarts[i];
      this.chainStarts[i + 1] = this.chainStarts[i] + ghosts * (level - common);
      this.neighbourOf.fill(i, ghostStarts[i], ghostStarts[i + 1]);
    });
    return Float64Array.from(keys);
  }

  private nodesOn(level: number, tree: Tree): number {
    return level === tree.lastLevel ? tree.partitions : 2 ** level;
  }

  /// Looks up where the neighbours are shown; true if that differs from last time.
  look(cut: ShownTiles): boolean {
    let changed = false;
    for (let i = 0; i < this.coarser.length; ++i) {
      const coarser = this.find(cut, i);
      changed ||= coarser !== this.coarser[i];
      this.coarser[i] = coarser;
      this.shown[i] = coarser === FINER ? null : cut.get(this.keys[this.keyStarts[i] + coarser])!;
    }
    return changed;
  }

  private find(cut: ShownTiles, neighbour: number): number {
    const start = this.keyStarts[neighbour];
    const levels = this.keyStarts[neighbour + 1] - start;
    for (let up = 0; up < levels; ++up) if (cut.has(this.keys[start + up])) return up;
    return FINER;
  }

  /// Holds no other tile any longer; the next look is a change.
  forget(): void {
    this.coarser.fill(UNKNOWN);
    this.shown.fill(null);
  }

  /// Gives the ghosts the places and attributes of the vertices that they are in the cut last looked at, and puts the
  /// border triangles to draw behind the interior ones. Returns their number.
  resolve(): number {
    for (let i = 0; i < this.shown.length; ++i) this.resolveGhosts(i);
    const { border, indices, interiorCount } = this.tile;
    let end = 3 * interiorCount;
    for (let t = 0; t < border.length; t += 3) {
      if (!this.isDrawn(this.place(border[t]), this.place(border[t + 1]), this.place(border[t + 2]))) continue;
      for (let corner = 0; corner < 3; ++corner) indices[end++] = border[t + corner];
    }
    return end / 3 - interiorCount;
  }

  private resolveGhosts(neighbour: number): void {
    const from = this.shown[neighbour];
    if (from === null) return;
    const { own, ghostStarts, chains } = this.tile;
    const levels = this.keyStarts[neighbour + 1] - this.keyStarts[neighbour];
    const isCoarser = this.coarser[neighbour] > 0;
    let entry = this.chainStarts[neighbour] + this.coarser[neighbour];
    for (let ghost = ghostStarts[neighbour]; ghost < ghostStarts[neighbour + 1]; ++ghost, entry += levels) {
      const vertex = Math.min(chains[entry], from.own - 1);
      this.isDamaged ||= vertex !== chains[entry];
      this.vertices[ghost] = vertex;
      for (const target of verticesAt(this.tile, own + ghost)) this.moveVertex(from, vertex, target, isCoarser);
    }
  }

  /// A texture coordinate stays the tile's own.
  private moveVertex(from: Tile, place: number, target: number, isCoarser: boolean): void {
    copyValues(from.positions, place, this.tile.positions, target, 3);
    if (isCoarser) this.takeLook(from, place, target);
    else this.keepLook(from, place, target);
  }

  /// That of the file, where it has one.
  private keepLook(from: Tile, place: number, target: number): void {
    const { own, normals, colours, values } = this.tile;
    if (this.givenNormals) copyValues(this.givenNormals, target - own, normals, target, 4);
    else copyValues(from.normals, place, normals, target, 4);
    if (colours && this.givenColours) copyValues(this.givenColours, target - own, colours, target, 4);
    if (values && this.givenValues) copyValues(this.givenValues, target - own, values, target, this.width);
  }

  /// That of the vertices there that look most like ours: by how many values differ, so that labels stay on their side, then by
  /// normal, then colour. Normals of a build do not choose the colour: it
  /// is the one that there would be without them.
  private takeLook(from: Tile, place: number, target: number): void {
    const { givenNormals, givenColours } = this;
    const { own, normals, normalsFrom, colours, values } = this.tile;
    const normalTo: Distance = (vertex) => (givenNormals ? difference(givenNormals, target - own, from.normals, vertex) : 0);
    const colourTo: Distance = (vertex) => (givenColours && from.colours ? difference(givenColours, target - own, from.colours, vertex) : 0);
    const valuesTo: Distance = (vertex) => this.differingValues(target, from, vertex);
    const source = nearest(verticesAt(from, place), valuesTo, normalTo, colourTo);
    // Where one of both has a normal map, its vertices' normals are but a frame: ours is nearer to what is shown there.
    const isFrame = this.tile.tangents !== null || from.tangents !== null;
    if (isFrame && givenNormals) copyValues(givenNormals, target - own, normals, target, 4);
    else copyValues(from.normals, source, normals, target, 4);
    const painter = normalsFrom === 'build' ? nearest(verticesAt(from, place), valuesTo, colourTo) : source;
    if (values && from.values) copyValues(from.values, painter, values, target, this.width);
    if (!colours || !givenColours) return;
    if (from.colours) copyValues(from.colours, painter, colours, target, 4);
    else copyValues(givenColours, target - own, colours, target, 4);
  }

  /// How many of the values that the file has of `target` a vertex of `from` does not have.
  private differingValues(target: number, from: Tile, vertex: number): number {
    const { givenValues: given, width } = this;
    let count = 0;
    for (let k = 0; given && from.values && k < width; ++k) {
      if (given[width * (target - this.tile.own) + k] !== from.values[width * vertex + k]) ++count;
    }
    return count;
  }

  private place(vertex: number): number {
    return placeOf(this.tile, vertex);
  }

  private isDrawn(a: number, b: number, c: number): boolean {
    return this.leavesItToUs(a) && this.leavesItToUs(b) && this.leavesItToUs(c) &&
      !this.isSame(a, b) && !this.isSame(b, c) && !this.isSame(c, a);
  }

  /// Tells whether the tile of a corner is shown coarser, or at the same level with a larger number; ours does.
  private leavesItToUs(corner: number): boolean {
    if (corner < this.tile.own) return true;
    const neighbour = this.neighbourOf[corner - this.tile.own];
    const coarser = this.coarser[neighbour];
    return coarser > 0 || (coarser === 0 && this.tile.neighbours[neighbour] > this.tile.index);
  }

  private isSame(one: number, other: number): boolean {
    const { own } = this.tile;
    if (one < own || other < own) return one === other;
    if (this.vertices[one - own] !== this.vertices[other - own]) return false;
    return this.shown[this.neighbourOf[one - own]] === this.shown[this.neighbourOf[other - own]];
  }
}
