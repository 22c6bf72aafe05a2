// SPDX-License-Identifier: MIT
// A tile in a three scene: its triangles, and on request its edges and vertices.
import { Box3, BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, InterleavedBuffer, InterleavedBufferAttribute, LineSegments, Mesh, MeshBasicMaterial, Points, Sphere, Texture, Vector3 } from 'three';
import type { Intersection, Material, Raycaster } from 'three';
import type { ResidentTile } from '../cut/tile_store.js';
import { BITMAP_TEXEL_BYTES, bytesOfTexel } from '../hierarchy/picture.js';
import { valueWidth } from '../hierarchy/scalar_values.js';
import { placeOf, type Indices } from '../hierarchy/copies.js';
import type { Tile } from '../hierarchy/tile.js';
import type { TileRecord } from '../hierarchy/tile_index.js';
import type { Seam } from '../cut/seam.js';
import { surfaceKey, surfaceMaterial, type Painting, type SharedMaterials, type SurfaceMaterial } from './materials.js';
import type { Look } from './settings.js';
import type { DrawnTile } from './surface.js';
import { memoryOfPicture, pictureMemory, tileTexture } from './tile_texture.js';

const TEXCOORD_BYTES = 8;
const TANGENT_BYTES = 4;

/// Bytes of a tile with what draws it: each array here and on the GPU, but for what only seams need; of its picture and its normal map one copy.
export function memoryOf(tile: Tile, seam: Seam, wires: boolean): number {
  const { level, copyOf, splitOf, positions, normals, colours, values, texcoords, tangents, picture, normalMap, indices, border, neighbours, ghostStarts, chains } = tile;
  const drawn = positions.byteLength + normals.byteLength + (colours?.byteLength ?? 0) + (values?.byteLength ?? 0) + (texcoords?.byteLength ?? 0) + (tangents?.byteLength ?? 0) + indices.byteLength;
  const seams = copyOf.byteLength + splitOf.byteLength + border.byteLength + neighbours.byteLength + ghostStarts.byteLength + chains.byteLength + seam.bytes;
  const pictures = [picture, normalMap].reduce((sum, each) => sum + (each ? memoryOfPicture(each, level) : 0), 0);
  return 2 * (drawn + (wires ? 2 * indices.byteLength : 0)) + seams + pictures;
}

/// Returns the bytes that are drawn of a vertex: its position, normal, colour and values, if any; not its texture coordinate, which is there if there is a picture.
export function vertexBytesOf(tile: Tile): number {
  return 12 + 4 * tile.normals.BYTES_PER_ELEMENT + (tile.colours ? 4 : 0) + 4 * valueWidth(tile);
}

/// Bytes that a texel takes on the GPU, of all that a tile shows there.
export interface TexelBytes {
  /// Holds for tiles without a normal map; `mapped` for those that have one.
  readonly plain: number;
  readonly mapped: number;
}

/// As the root has them: all tiles' pictures are stored alike, and all their maps. What it lacks may take most.
export function texelBytesOf({ picture, normalMap }: Tile): TexelBytes {
  const [ofPicture, ofMap] = [picture, normalMap].map((each) => each && bytesOfTexel(each));
  return { plain: ofPicture ?? BITMAP_TEXEL_BYTES, mapped: (ofPicture ?? 0) + (ofMap ?? BITMAP_TEXEL_BYTES) };
}

/// A tile's record does not tell these.
export interface UnrecordedSizes {
  readonly level: number;
  readonly vertexBytes: number;
  readonly wires: boolean;
  readonly texelBytes: TexelBytes;
}

/// The same from counts alone; not less.
export function mostMemory(
  record: Omit<TileRecord, 'error' | 'bound' | 'min' | 'max' | 'bytes' | 'checksum'>,
  { level, vertexBytes, wires, texelBytes }: UnrecordedSizes,
): number {
  const { own, ghosts, copies, splits, interior, border, pictureWidth: width, pictureHeight: height, hasNormalMap } = record;
  const vertices = own + ghosts + copies + splits;
  const indexBytes = vertices > 65535 ? 4 : 2;
  const indices = 3 * (interior + border) * indexBytes;
  const drawn = vertices * (vertexBytes + (width > 0 ? TEXCOORD_BYTES + TANGENT_BYTES : 0)) + indices;
  // A ghost takes its chain, its neighbour's number, start and keys, and what the seam keeps of it; a vertex behind the ghosts takes the last, and its number.
  const seams = 3 * border * indexBytes + ghosts * (10 * level + 48) + (copies + splits) * 16 + 64;
  return 2 * (drawn + (wires ? 2 * indices : 0)) + seams + pictureMemory({ width, height }, hasNormalMap ? texelBytes.mapped : texelBytes.plain, level);
}

/// A place is left out with one of its vertices, and stays with another.
function ownVertices(tile: Tile): Uint32Array {
  const all = tile.positions.length / 3;
  return Uint32Array.from(Array(all).keys()).filter((vertex) => placeOf(tile, vertex) < tile.own);
}

function edgesOf(triangles: Indices, corners: number): Indices {
  const edges = triangles instanceof Uint32Array ? new Uint32Array(2 * triangles.length) : new Uint16Array(2 * triangles.length);
  for (let t = 0, e = 0; t < corners; t += 3)
    for (let k = 0; k < 3; ++k) {
      edges[e++] = triangles[t + k];
      edges[e++] = triangles[t + ((k + 1) % 3)];
    }
  return edges;
}

function paintingOf(tile: Tile): Painting {
  const { level, picture, normalMap } = tile;
  const texture: Texture | null = picture && tileTexture(picture, level);
  const normals: Texture | null = normalMap && tileTexture(normalMap, level, 'directions');
  return { tile, texture, normals };
}

/// Lists what seams change of a tile: all but texture coordinates and tangents, which are its own; `width`: elements of a vertex.
function* changing({ attributes }: BufferGeometry): Iterable<{ readonly values: BufferAttribute | InterleavedBuffer; readonly width: number }> {
  for (const [name, attribute] of Object.entries(attributes)) {
    if (name === 'uv' || name === 'tangent') continue;
    if (attribute instanceof InterleavedBufferAttribute) yield { values: attribute.data, width: attribute.data.stride };
    else yield { values: attribute, width: attribute.itemSize };
  }
}

function upload(values: BufferAttribute | InterleavedBuffer, first: number): void {
  values.clearUpdateRanges();
  values.addUpdateRange(first, values.array.length - first);
  values.needsUpdate = true;
}

export class TileObject extends Mesh<BufferGeometry, SurfaceMaterial> {
  triangles: number;
  private wires: LineSegments | null = null;
  private points: Points | null = null;
  private readonly painting: Painting;
  /// How its surface was made.
  surface: string;
  isResolved = false;

  /// To be drawn once it is resolved; wires and points come with setLook().
  constructor(
    private readonly resident: ResidentTile,
    private look: Look,
    private readonly shared: SharedMaterials,
  ) {
    const { tile } = resident;
    const painting = paintingOf(tile);
    super(new BufferGeometry(), surfaceMaterial(look, painting, shared));
    this.painting = painting;
    this.surface = surfaceKey(look, tile, shared);
    this.geometry.setAttribute('position', new BufferAttribute(tile.positions, 3));
    this.geometry.setAttribute('normal', new BufferAttribute(tile.normals, 4, true));
    if (tile.colours) this.geometry.setAttribute('color', new BufferAttribute(tile.colours, 4, true));
    if (tile.texcoords) this.geometry.setAttribute('uv', new BufferAttribute(tile.texcoords, 2));
    if (tile.tangents) this.geometry.setAttribute('tangent', new BufferAttribute(tile.tangents, 4, true));
    this.geometry.setIndex(new BufferAttribute(tile.indices, 1));
    this.geometry.index!.setUsage(DynamicDrawUsage);
    for (const { values } of changing(this.geometry)) values.setUsage(DynamicDrawUsage);
    this.prepare();
    this.triangles = tile.interiorCount;
    this.matrixAutoUpdate = false;
    // Where depths are equal the last one shows: the same one in whatever order tiles came.
    this.renderOrder = resident.key / Number.MAX_SAFE_INTEGER;
  }

  /// Gives the geometry what shaders look for.
  private prepare(): void {
    this.shared.shadings.prepare(this.geometry, this.resident.tile, this.look);
  }

  /// Ghosts may lie elsewhere than in the file.
  private setBounds(): void {
    const { tile } = this.resident;
    const [a, b, c, d, e, f] = tile.box;
    const box = new Box3(new Vector3(a, b, c), new Vector3(d, e, f));
    const ghost = new Vector3();
    for (let v = tile.own; v < tile.own + tile.ghosts; ++v) box.expandByPoint(ghost.fromArray(tile.positions, 3 * v));
    this.geometry.boundingSphere = box.getBoundingSphere(new Sphere());
  }

  override raycast(raycaster: Raycaster, hits: Intersection[]): void {
    if (this.visible) super.raycast(raycaster, hits);
  }

  /// Holds no more than its triangles until it is shown again.
  hide(): void {
    this.visible = false;
    this.setWires(false);
    this.setPoints(false);
    this.resident.seam.forget();
  }

  /// Those of its picture and its normal map.
  get textures(): Texture[] {
    const { texture, normals } = this.painting;
    return [texture, normals].filter((each) => each !== null);
  }

  /// Makes meshes without vertices that are drawn as this one is, with a normal map and without. None if no light is on it.
  makeSamples(): Mesh<BufferGeometry, SurfaceMaterial>[] {
    if (this.material instanceof MeshBasicMaterial) return [];
    const { look, painting, shared } = this;
    return [new Texture(), null].map((normals) => new Mesh(this.sampleGeometry(normals !== null), surfaceMaterial(look, { ...painting, normals }, shared)));
  }

  private sampleGeometry(hasTangents: boolean): BufferGeometry {
    const geometry = new BufferGeometry();
    const give = (name: string, width: number): void => { geometry.setAttribute(name, new BufferAttribute(new Float32Array(width), width)); };
    for (const [name, { itemSize }] of Object.entries(this.geometry.attributes)) if (name !== 'tangent') give(name, itemSize);
    if (hasTangents) give('tangent', 4);
    return geometry;
  }

  /// Takes the seam over as it is in the cut last looked at.
  resolve(): void {
    const { tile, seam } = this.resident;
    this.isResolved = true;
    this.triangles = tile.interiorCount + seam.resolve();
    this.geometry.setDrawRange(0, 3 * this.triangles);
    if (tile.ghosts > 0) this.uploadGhosts();
    this.setBounds();
    if (this.wires) this.setWires(true);
  }

  /// Tells what is drawn, once it is resolved.
  drawn(): DrawnTile {
    const { node, tile } = this.resident;
    return { node, tile, triangles: this.triangles, sphere: this.geometry.boundingSphere! };
  }

  private uploadGhosts(): void {
    const { tile } = this.resident;
    for (const { values, width } of changing(this.geometry)) upload(values, tile.own * width);
    upload(this.geometry.index!, 3 * tile.interiorCount);
  }

  /// Makes anew only what differs.
  setLook(look: Look): void {
    this.look = look;
    this.prepare();
    const surface = surfaceKey(look, this.resident.tile, this.shared);
    if (this.surface !== surface) {
      this.surface = surface;
      this.material.dispose();
      this.material = surfaceMaterial(look, this.painting, this.shared);
    }
    if (look.wires !== (this.wires !== null)) this.setWires(look.wires);
    if (look.points || this.points !== null) this.setPoints(look.points);
    if (this.wires !== null) this.shareValues(this.wires);
  }

  /// Colours the whole tile.
  paint(colour: Color): void {
    this.material.color.copy(colour);
  }

  private setWires(on: boolean): void {
    this.wires = this.discard(this.wires);
    if (!on) return;
    const geometry = new BufferGeometry();
    for (const name of ['position', 'normal']) geometry.setAttribute(name, this.geometry.attributes[name]);
    geometry.setIndex(new BufferAttribute(edgesOf(this.resident.tile.indices, 3 * this.triangles), 1));
    geometry.setDrawRange(0, 6 * this.triangles);
    geometry.boundingSphere = this.geometry.boundingSphere;
    this.wires = this.place(new LineSegments(geometry, this.shared.wires));
    this.shareValues(this.wires);
  }

  private setPoints(on: boolean): void {
    this.points = this.discard(this.points);
    if (!on) return;
    const geometry = new BufferGeometry();
    for (const name of ['position', 'normal']) geometry.setAttribute(name, this.geometry.attributes[name]);
    const { color } = this.geometry.attributes;
    if (color !== undefined) geometry.setAttribute('color', color);
    if (this.shared.shadings.omits === null) geometry.setDrawRange(0, this.resident.tile.own);
    else geometry.setIndex(new BufferAttribute(ownVertices(this.resident.tile), 1));
    geometry.boundingSphere = this.geometry.boundingSphere;
    this.points = this.place(new Points(geometry, this.pointMaterial()));
    this.shareValues(this.points);
    this.points.renderOrder = 1; // after the wires
  }

  private pointMaterial(): Material {
    const { points, dots } = this.shared;
    if (this.resident.tile.indices.length > 0) return points;
    return this.look.colours === 'vertex' && this.resident.tile.colours !== null ? dots.coloured : dots.plain;
  }

  private place<Part extends LineSegments | Points>(part: Part): Part {
    part.matrixAutoUpdate = false;
    part.raycast = () => undefined; // the triangles are hit
    this.add(part);
    return part;
  }

  /// Shaders that leave parts out look for these.
  private shareValues({ geometry }: LineSegments | Points): void {
    for (const [name, attribute] of Object.entries(this.geometry.attributes)) if (attribute instanceof InterleavedBufferAttribute) geometry.setAttribute(name, attribute);
  }

  /// Attributes are the triangles': they stay.
  private discard(part: LineSegments | Points | null): null {
    for (const name of Object.keys(part?.geometry.attributes ?? {})) part?.geometry.deleteAttribute(name);
    part?.geometry.dispose();
    part?.removeFromParent();
    return null;
  }

  /// Lets go of what it has on the GPU, where it comes again once it is drawn.
  leaveDevice(): void {
    for (const part of [this, this.wires, this.points]) part?.geometry.dispose();
    for (const each of [this.material, ...this.textures]) each.dispose();
  }

  dispose(): void {
    this.setWires(false);
    this.setPoints(false);
    this.leaveDevice();
    this.removeFromParent();
  }
}
