// SPDX-License-Identifier: MIT
// Objects of a model in a view: picked, left out, flown to.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { LineBasicMaterial, LineSegments, Points, Scene, Vector3, type BufferGeometry, type WebGLProgramParametersWithUniforms, type WebGLRenderer } from 'three';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { CameraPose, rampColour, type DrawnTile, type Stage } from '../src/index.js';
import type { ObjectTable } from '../src/hierarchy/object_table.js';
import { ObjectShading } from '../src/plugins/object_shading.js';
import { Objects } from '../src/plugins/objects.js';
import { valuesAt } from '../src/tools/values_at.js';
import { shownSurface } from '../src/tools/shown_triangles.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';
import { Session } from './support/session.js';
import { Town } from './support/town.js';

describe.skipIf(!hasProgram)('objects of a view', () => {
  const workshop = new Workshop();
  const town = new Town(12);
  const renderer: object = {};
  const fly = vi.fn<(pose: CameraPose) => void>();
  let directory: string;
  let session: Session;
  let objects: Objects;

  beforeAll(() => {
    const mesh = path.join(workshop.directory, 'town.ply');
    writeFileSync(mesh, town.ply());
    directory = workshop.buildMesh('town', mesh, { up: 'z', partition: { vertices: 800 } });
    town.furnish(directory);
  });
  beforeEach(async () => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    fly.mockClear();
    session = new Session(fetchFrom(directory));
    await session.view.opened;
    objects = new Objects();
    const { view, camera } = session;
    const pose = (): CameraPose => new CameraPose(camera.position.clone(), new Vector3());
    view.registerPlugin(objects);
    const stage: Stage = { view, renderer: renderer as unknown as WebGLRenderer, scene: new Scene(), camera, root: {} as ParentNode, surface: new EventTarget() as HTMLElement, signal: new AbortController().signal, pose, jump: vi.fn(), fly, travel: vi.fn(), redraw: vi.fn(), suspend: vi.fn() };
    view.plugins.enter(stage);
  });
  afterEach(() => {
    session.view.dispose();
    vi.useRealTimers();
  });
  afterAll(() => { workshop.remove(); });

  /// From above a house: z of the input is up.
  async function above(object: number): Promise<void> {
    const [x, y, z] = town.roof(object);
    session.look([x, z + 3, -y], [x + 1e-3, z, -y]);
    session.camera.updateMatrixWorld();
    await session.settle();
  }

  it('are those of the original, by a tap', async () => {
    for (const object of [1, 40, 77, town.rows.length - 1]) {
      await above(object);
      const row = await objects.pick(0, 0);
      expect(row).toEqual({ object, ...town.rows[object] });
      expect(objects.picked).toBe(row);
      expect(objects.shading.uniforms.markedObject.value).toBe(object);
    }
    session.look([0, 300, 0], [0, 400, 0]);
    session.camera.updateMatrixWorld();
    expect(await objects.pick(0, 0)).toBeNull();
    expect(objects.shading.uniforms.markedObject.value).toBe(-1);
  });

  it('are found by name, and flown to', async () => {
    await above(1);
    expect(await objects.chooseNamed('street 03/house 05')).toMatchObject({ object: 1 + 3 * 12 + 5 });
    objects.go();
    const { position, target } = fly.mock.calls[0][0];
    expect(target.distanceTo(new Vector3(6.5, 0, -10.5))).toBeLessThan(2.5);
    expect(position.y).toBeGreaterThan(1);
    expect(await objects.chooseNamed('street 03/house 99')).toBeNull();
    objects.go();
    expect(fly).toHaveBeenCalledTimes(1);
  });

  it('that are left out are not picked', async () => {
    const object = 30;
    await above(object);
    await objects.draw({ hidden: [town.rows[object].name, 'no such house'] });
    expect(await objects.pick(0, 0)).toMatchObject({ object: 0, name: '' }); // the ground below
    await objects.draw({ hidden: [] });
    expect(await objects.pick(0, 0)).toMatchObject({ object });
    await objects.draw({ only: ['street 05/'] });
    expect(await objects.pick(0, 0)).toBeNull();
    expect([objects.shading.draws(1 + 5 * 12), objects.shading.draws(6 * 12), objects.shading.draws(object)]).toEqual([true, true, false]);
    await objects.draw({ hidden: ['street 05/house 00'] });
    expect([objects.shading.draws(1 + 5 * 12), objects.shading.draws(2 + 5 * 12)]).toEqual([false, true]);
  });

  it('that are left out are in no pass, and in nothing that is measured', async () => {
    const { view } = session;
    const street = 'street 05/';
    await above(1);
    const wires = new LineBasicMaterial();
    expect([view.leaveOut(wires), view.omits]).toEqual([false, null]);
    const all = trianglesOf(view.surface);
    await objects.draw({ hidden: [street] });
    await session.settle();
    expect(view.leaveOut(wires)).toBe(true);
    const shader = { uniforms: {}, vertexShader: '#include <project_vertex>', fragmentShader: '' } as WebGLProgramParametersWithUniforms;
    wires.onBeforeCompile(shader, renderer as unknown as WebGLRenderer);
    expect(shader.vertexShader).toContain('leftOutObjects');
    expect(shader.uniforms.leavesObjectsOut).toBe(objects.shading.uniforms.leavesObjectsOut);
    const left = trianglesOf(shownSurface(view));
    expect(left.filter((object) => object > 60 && object <= 72)).toEqual([]);
    expect(left).toEqual(all.filter((object) => object <= 60 || object > 72));
    view.setLook({ wires: true, points: true });
    await session.frame();
    const parts = session.meshes().flatMap(({ children }) => children).filter((part) => part instanceof LineSegments || part instanceof Points);
    expect(parts.length).toBeGreaterThan(1);
    for (const { geometry } of parts) expect((geometry as BufferGeometry).hasAttribute('object')).toBe(true);
    await objects.draw({ shown: [`${street}house 03`] });
    expect([objects.shading.draws(64), objects.shading.draws(65)]).toEqual([true, false]);
  });

  /// The object of each triangle that is drawn.
  function trianglesOf(surface: readonly DrawnTile[]): number[] {
    return surface.flatMap(({ tile, triangles }) => Array.from({ length: triangles }, (_, i) => valuesAt(tile, tile.indices[3 * i])[0]));
  }

  it('have colours by a property', async () => {
    await above(1);
    await objects.colourBy('storeys');
    expect(objects.legend).toMatchObject({ property: { name: 'storeys' }, range: [1, 5], values: [] });
    const bytes = objects.shading.uniforms.objectColours.value!.image.data as Uint8Array;
    const colourOf = (object: number): number[] => [...bytes.slice(4 * object, 4 * object + 4)];
    const withStoreys = (storeys: number): number => town.rows.findIndex(({ values }) => values[0] === storeys);
    expect([colourOf(0), colourOf(withStoreys(1)), colourOf(withStoreys(5))]).toEqual([[0, 0, 0, 0], [...rampColour('viridis', 0), 255], [...rampColour('viridis', 1), 255]]);
    objects.colourRange([5, 1]);
    expect([objects.legend?.range, objects.legend?.whole, colourOf(withStoreys(1))]).toEqual([[5, 1], [1, 5], [...rampColour('viridis', 1), 255]]);
    await objects.colourBy('storeys', 'viridis', [0, 2]);
    expect([objects.legend?.range, colourOf(withStoreys(1)).length, colourOf(withStoreys(4))]).toEqual([[0, 2], 4, [...rampColour('viridis', 1), 255]]);
    await objects.colourBy('school');
    expect(objects.legend?.values.map(({ value, count }) => [value, count])).toEqual([[false, 130], [true, 14]]);
    await objects.colourBy('no such property');
    expect(objects.legend).toBeNull();
    await objects.colourBy('school');
    await objects.colourBy(null);
    expect([objects.legend, objects.shading.uniforms.coloursObjects.value]).toEqual([null, false]);
  });

  it('keep their colours along the same ramp when another table comes', async () => {
    await above(1);
    objects.drawn();
    await objects.colourBy('storeys', 'turbo', [2, 4]);
    const before = objects.shading.uniforms.objectColours.value!.image.data as Uint8Array;
    const told = new Promise((resolve) => { objects.addEventListener('change', resolve); });
    vi.spyOn(session.view, 'objects', 'get').mockReturnValue(Object.create(session.view.objects) as ObjectTable);
    objects.drawn();
    await told;
    expect(objects.legend?.range).toEqual([2, 4]);
    const after = objects.shading.uniforms.objectColours.value!.image.data as Uint8Array;
    expect(after).not.toBe(before);
    expect(after).toEqual(before);
  });

  it('tell what could not be read', async () => {
    const problem = vi.fn();
    const other = new Session(async (url, init) => (url.includes('objects.bin') ? new Response(null, { status: 404 }) : fetchFrom(directory)(url, init)));
    const alone = new Objects();
    other.view.registerPlugin(alone);
    alone.addEventListener('problem', problem);
    await other.view.opened;
    await other.settle();
    expect(await alone.chooseNamed('street 03/house 05')).toBeNull();
    expect(problem.mock.calls[0][0]).toMatchObject({ message: expect.stringContaining('objects.bin') as string });
    other.view.dispose();
  });

  it('cost nothing until one is picked', async () => {
    await above(1);
    const [mesh] = session.meshes();
    expect(mesh.geometry.attributes.object).toBeUndefined();
    await objects.pick(0, 0);
    await session.frame();
    expect(session.meshes().every(({ geometry }) => geometry.attributes.object !== undefined)).toBe(true);
  });
});

describe('objects that are left out', () => {
  it('have a texel each, up to the last of all there may be', () => {
    const shading = new ObjectShading();
    shading.leaveOut([{ begin: 5, end: 7, isOut: true }, { begin: 2 ** 24 - 1, end: 2 ** 24, isOut: true }], 2 ** 24);
    expect([4, 5, 6, 7, 2 ** 24 - 2, 2 ** 24 - 1].map((object) => shading.draws(object))).toEqual([true, false, false, true, true, false]);
    const { image } = shading.uniforms.leftOutObjects.value!;
    expect([image.width, image.height]).toEqual([4096, 4096]);
    shading.leaveOut([], 2 ** 24);
    expect(shading.draws(5)).toBe(true);
    shading.dispose();
  });
});
