// SPDX-License-Identifier: MIT
// Picking on real hierarchies: on what is drawn, and on the original.
import { readdirSync } from 'node:fs';
import path from 'node:path';
import { BufferAttribute, PerspectiveCamera, Triangle, Vector3 } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import type { Fetch } from '../../src/hierarchy/bytes.js';
import { Places } from '../../src/tools/places.js';
import { HierarchyView } from '../../src/index.js';
import { UPS } from '../../src/scene/standing.js';
import { Coordinates } from '../../src/tools/coordinates.js';
import { pickOriginal } from '../../src/tools/original.js';
import { Picker, rayThrough } from '../../src/tools/pick.js';
import { pickedPoint } from '../../src/tools/picked_point.js';
import { RayProbe, type Ray } from '../../src/tools/ray.js';
import { shownBound } from '../../src/tools/shown_bound.js';
import { add, distanceOf, subtract, type Vector } from '../../src/tools/vectors.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';
import { readPly, type PlyMesh } from '../support/ply.js';
import { random } from '../support/random.js';

const VIEWPORT = { width: 400, height: 300 };
const PARTITIONS = { partition: { vertices: 200 } };

/// A settled view.
async function settledView(fetch: Fetch, from: Vector, settings = { threshold: 1 }): Promise<{ view: HierarchyView; camera: PerspectiveCamera }> {
  const view = new HierarchyView('', { fetch, settings: { restDetail: 1, ...settings } });
  const camera = new PerspectiveCamera(45, VIEWPORT.width / VIEWPORT.height, 1e-3, 1e9);
  await view.opened;
  const middle = view.box.getCenter(new Vector3());
  camera.position.copy(middle).add(new Vector3(...from));
  camera.lookAt(middle);
  for (let now = 0; !view.stats().settled; now += 100) {
    view.update(camera, VIEWPORT, now);
    await new Promise((resolve) => setImmediate(resolve));
  }
  return { view, camera };
}

/// The first triangle of all that a ray meets, in the tiles' coordinates.
function nearest(mesh: PlyMesh, ray: Ray): number {
  const probe = new RayProbe(ray);
  let least = Infinity;
  for (let i = 0; i < mesh.corners.length; i += 3)
    least = Math.min(least, probe.hits(mesh.positions, mesh.corners[i], mesh.corners[i + 1], mesh.corners[i + 2]));
  return least;
}

/// From a point to all of a mesh's surface.
function distanceToMesh({ positions, corners }: PlyMesh, point: Vector): number {
  const [at, closest] = [new Vector3(...point), new Vector3()];
  const triangle = new Triangle();
  let least = Infinity;
  for (let i = 0; i < corners.length; i += 3) {
    triangle.setFromAttributeAndIndices(new BufferAttribute(positions, 3), corners[i], corners[i + 1], corners[i + 2]);
    least = Math.min(least, triangle.closestPointToPoint(at, closest).distanceTo(at));
  }
  return least;
}

function bitsOf(point: ArrayLike<number>): string {
  return [...new BigUint64Array(Float64Array.from(point).buffer)].join();
}

function vertexBits({ positions }: PlyMesh): Set<string> {
  return new Set(Array.from({ length: positions.length / 3 }, (_, v) => bitsOf(positions.subarray(3 * v, 3 * v + 3))));
}

function places(count: number, seed: number): [number, number][] {
  const next = random(seed);
  return Array.from({ length: count }, () => [1.2 * next() - 0.6, 1.2 * next() - 0.6]);
}

describe.skipIf(!hasProgram)('picking', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });
  const { signal } = new AbortController();
  const meshOf = (name: string): PlyMesh => readPly(path.join(workshop.directory, `${name}.ply`));
  const torus = (up: 'y' | 'z' = 'y'): string =>
    workshop.build(`torus_${up}`, ['surface', '--triangles', '12000', '--shape', 'torus'], { ...PARTITIONS, up });

  it.each(['y', 'z'] as const)('finds on the original the vertices of the PLY, bit for bit (up: %s)', async (up) => {
    const { view, camera } = await settledView(fetchFrom(torus(up)), [1, 2, 4]);
    const mesh = meshOf(`torus_${up}`);
    const known = vertexBits(mesh);
    let hits = 0;
    for (const [right, upwards] of places(60, 5)) {
      const ray = rayThrough(camera, right, upwards, view.surfaceMatrix);
      const hit = await pickOriginal(view.source!, ray, { signal });
      const least = nearest(mesh, ray);
      expect(hit === null).toBe(least === Infinity);
      if (hit === null) continue;
      expect(hit.distance).toBeCloseTo(least, 12);
      ++hits;
      const picked = pickedPoint(hit, view.manifest!, true);
      expect(picked).toMatchObject({ isOriginal: true, isExact: true, isVertex: true, globe: null });
      expect(known.has(bitsOf(picked.point))).toBe(true);
      expect(distanceOf(picked.normal, [0, 0, 0])).toBeCloseTo(1, 12);
      expect(pickedPoint(hit, view.manifest!, false)).toMatchObject({ isExact: false, isVertex: false, bound: 0 });
    }
    expect(hits).toBeGreaterThan(10);
    view.dispose();
  });

  it.each(UPS)('finds the same vertices where the model stands otherwise and is stretched (up: %s)', async (up) => {
    const { view, camera } = await settledView(fetchFrom(torus('z')), [1, 2, 4]);
    view.setStanding({ up, stretch: 7 });
    const middle = view.box.getCenter(new Vector3());
    camera.position.set(0.6, 0.5, 0.6).multiplyScalar(view.box.min.distanceTo(view.box.max)).add(middle);
    camera.lookAt(middle);
    view.update(camera, VIEWPORT, 1e6);
    const known = vertexBits(meshOf('torus_z'));
    const found = await Promise.all(places(60, 5).map(([right, height]) => pickOriginal(view.source!, rayThrough(camera, right, height, view.surfaceMatrix), { signal })));
    const picked = found.filter((hit) => hit !== null).map((hit) => pickedPoint(hit, view.manifest!, true));
    expect(picked.length).toBeGreaterThan(3);
    for (const { point, isExact } of picked) expect([isExact, known.has(bitsOf(point))]).toEqual([true, true]);
    const world = new Places(view);
    const [{ point, local }] = picked;
    expect(world.toWorld(point).distanceTo(new Vector3(...local).applyMatrix4(view.surfaceMatrix))).toBe(0);
    expect(distanceOf(world.toInput(world.toWorld(point)), point)).toBeLessThan(1e-12);
    expect(world.toWorld(add(point, view.upwards)).sub(world.toWorld(point)).toArray()).toEqual([0, 7, 0].map((value) => expect.closeTo(value, 9) as number));
    view.dispose();
  });

  it('asks for few partitions, the ones beneath the point', async () => {
    const asked: string[] = [];
    const directory = torus();
    const { view, camera } = await settledView(fetchFrom(directory, asked), [1, 2, 4], { threshold: 1000 });
    asked.length = 0;
    const ray = places(60, 5).map(([right, up]) => rayThrough(camera, right, up, view.surfaceMatrix)).find((each) => new Picker().pick(view.surface, each))!;
    expect(await pickOriginal(view.source!, ray, { signal })).not.toBeNull();
    const last = `tiles/0${view.source!.tree.lastLevel}`;
    expect(asked.every((url) => url.includes(last))).toBe(true);
    expect(asked.length).toBeLessThan(readdirSync(path.join(directory, last)).length / 4);
    expect(await pickOriginal(view.source!, ray, { signal, mostTiles: 0 })).toBeNull();
    view.dispose();
  });

  it('finds on what is drawn the triangles that are drawn', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [0.2, 0.3, 1.2]);
    expect(new Set(view.surface.map(({ node }) => node.level)).size).toBeGreaterThan(1); // a cut of several levels
    const picker = new Picker();
    for (const [right, up] of places(100, 9)) {
      const ray = rayThrough(camera, right, up, view.surfaceMatrix);
      const all = view.surface.map(({ tile: { positions, indices }, triangles }) => nearest({ positions: Float64Array.from(positions), corners: Uint32Array.from(indices.subarray(0, 3 * triangles)) }, ray));
      expect(picker.pick(view.surface, ray)?.distance ?? Infinity).toBe(Math.min(...all));
    }
    view.dispose();
  });

  it('passes what is cut away', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [0, 0, 4]);
    const ray = rayThrough(camera, 0.35, 0, view.surfaceMatrix);
    const front = new Picker().pick(view.surface, ray)!;
    const keeps = (point: Vector): boolean => point[2] < front.point[2] - 0.01;
    const behind = new Picker().pick(view.surface, ray, keeps)!;
    expect(behind.distance).toBeGreaterThan(front.distance);
    expect((await pickOriginal(view.source!, ray, { signal, keeps }))!.distance).toBeGreaterThan(front.distance);
    expect(new Picker().pick(view.surface, ray, () => false)).toBeNull();
    view.dispose();
  });

  it('keeps no more trees than it may, and none of tiles that are gone', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [1, 2, 4], { threshold: 0.1 });
    const all = new Picker();
    const few = new Picker(20_000);
    for (const [right, up] of places(60, 2)) {
      const ray = rayThrough(camera, right, up, view.surfaceMatrix);
      expect(few.pick(view.surface, ray)).toEqual(all.pick(view.surface, ray));
      expect(few.bytes).toBeLessThanOrEqual(20_000);
    }
    expect(all.bytes).toBeGreaterThan(20_000);
    expect(all.pick([], rayThrough(camera, 0, 0, view.surfaceMatrix))).toBeNull();
    expect(all.bytes).toBe(0);
    view.dispose();
  });

  it('knows a bound of how far what is shown is from the original, where levels meet too', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [1.5, 0.3, 0.2], { threshold: 2 });
    expect(new Set(view.surface.map(({ node }) => node.level)).size).toBeGreaterThan(1);
    const mesh = meshOf('torus_y');
    const { index } = view.source!;
    const picker = new Picker();
    let [coarse, largest] = [0, 0];
    for (const [right, up] of places(80, 9)) {
      const hit = picker.pick(view.surface, rayThrough(camera, right, up, view.surfaceMatrix));
      if (hit === null) continue;
      const bound = shownBound(hit.node, view.surface, (node) => index.record(node)!.bound);
      const picked = pickedPoint(hit, view.manifest!, false, bound);
      if (picked.isOriginal) continue;
      ++coarse;
      const off = distanceToMesh(mesh, picked.point);
      expect(off).toBeLessThanOrEqual(picked.bound);
      largest = Math.max(largest, off / picked.bound);
    }
    expect(coarse).toBeGreaterThan(20);
    expect(largest).toBeGreaterThan(0.01); // it is a bound of something
    expect(shownBound({ level: 0, index: 0 }, view.surface, () => 0)).toBe(Infinity);
    view.dispose();
  });

  it('tells coordinates of doubles as near as they are stored, and does not call them exact', async () => {
    const directory = workshop.build('far', ['surface', '--triangles', '6000', '--double', '--offset', '691000.1', '5335000.2', '500.3'], PARTITIONS);
    const { view, camera } = await settledView(fetchFrom(directory), [0, 0, 4]);
    const mesh = meshOf('far');
    const hit = (await pickOriginal(view.source!, rayThrough(camera, 0.1, 0.1, view.surfaceMatrix), { signal }))!;
    const picked = pickedPoint(hit, view.manifest!, true);
    expect(picked).toMatchObject({ isOriginal: true, isExact: false });
    let least = Infinity;
    for (let v = 0; v < mesh.positions.length; v += 3) least = Math.min(least, distanceOf(picked.point, [mesh.positions[v], mesh.positions[v + 1], mesh.positions[v + 2]]));
    expect(least).toBeLessThan(1e-6);
    expect(picked.bound).toBeGreaterThan(0);
    expect(least).toBeLessThanOrEqual(picked.bound);
    view.dispose();
  });

  it('meets nothing that is nearer than the near plane', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [0, 0, 4]);
    const pick = async (): Promise<number[]> => {
      const ray = rayThrough(camera, 0.35, 0.1, view.surfaceMatrix);
      return [new Picker().pick(view.surface, ray)!, (await pickOriginal(view.source!, ray, { signal }))!].map(({ distance }) => distance);
    };
    const [shown, original] = await pick();
    camera.near = Math.max(shown, original) * 1.01;
    camera.updateProjectionMatrix();
    for (const distance of await pick()) expect(distance).toBeGreaterThan(camera.near);
    view.dispose();
  });

  it('follows a view that was moved, turned and scaled', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [0, 0, 4]);
    const before = new Picker().pick(view.surface, rayThrough(camera, 0.35, 0.1, view.surfaceMatrix))!;
    const world = new Vector3(...before.point);
    view.position.set(5, 6, 7);
    view.rotation.set(0.1, 0.2, 0.3);
    view.scale.setScalar(10);
    view.updateWorldMatrix(true, true);
    camera.position.applyMatrix4(view.matrixWorld);
    camera.quaternion.premultiply(view.quaternion);
    camera.updateMatrixWorld();
    const after = new Picker().pick(view.surface, rayThrough(camera, 0.35, 0.1, view.surfaceMatrix))!;
    expect(distanceOf(after.point, world.toArray())).toBeLessThan(1e-9);
    expect(after.distance).toBeCloseTo(before.distance, 9);
    view.dispose();
  });

  it('stops when it is told to', async () => {
    const { view, camera } = await settledView(fetchFrom(torus()), [0, 0, 4]);
    const ending = new AbortController();
    const slow: Fetch = (_, init) => new Promise((_resolve, reject) => { init?.signal?.addEventListener('abort', () => { reject(new Error('stopped')); }); });
    const source = { ...view.source!, load: async () => { await slow('', { signal: ending.signal }); throw new Error('never'); } };
    const picking = pickOriginal(source, rayThrough(camera, 0.35, 0, view.surfaceMatrix), { signal: ending.signal });
    await new Promise((resolve) => setImmediate(resolve));
    ending.abort();
    await expect(picking).rejects.toThrow('stopped');
    view.dispose();
  });
});

describe('a point of a placed model', () => {
  it('has its place on the globe', () => {
    const manifest = { origin: [1, 2, 3], place: [0, 0, 0], up: 'z', transform: [0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 6378137, 0, 0, 1], worstRounding: 0, partitions: 1, source: { doublePrecision: false } } as const;
    const hit = { node: { level: 0, index: 0 }, point: [0, 0, 4], normal: [0, 0, 1], corner: [0, 0, 5], distance: 1, between: [], atCorner: [] } as const;
    expect(pickedPoint(hit, manifest, false).globe?.height).toBeCloseTo(7, 5);
    expect(pickedPoint(hit, manifest, true).point).toEqual(add([1, 2, 3], [0, 0, 5]));
    expect(new Coordinates(manifest).fromInput([1, 2, 8])).toEqual(subtract([1, 2, 8], [1, 2, 3]));
  });
});
