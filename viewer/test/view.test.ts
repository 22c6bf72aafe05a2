// SPDX-License-Identifier: MIT
// The whole library on real hierarchies, from files instead of a host, without a GPU.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { MeshBasicMaterial, Vector3, type Mesh, type MeshStandardMaterial, type WebGLRenderer } from 'three';
import { afterAll, afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Fetch } from '../src/hierarchy/bytes.js';
import type { ViewOptions } from '../src/index.js';
import { unsplitOf } from '../src/hierarchy/copies.js';
import type { Indices } from '../src/hierarchy/copies.js';
import { readTile } from '../src/hierarchy/tile.js';
import { fetchFrom, hasProgram, resealed, withoutQuery, Workshop } from './support/meshhier.js';
import { FakeBitmap, fakeDecode, png } from './support/pictures.js';
import { Session, type Place } from './support/session.js';
import { tileBytes } from './support/tile_bytes.js';

/// Draws: tells whom it draws, and that pictures have come to the GPU.
class Device {
  readonly canvas = new EventTarget();

  draw(meshes: readonly Mesh[]): void {
    for (const mesh of meshes) {
      const { map } = mesh.material as MeshBasicMaterial;
      mesh.onBeforeRender({ domElement: this.canvas, initTexture: () => undefined } as unknown as WebGLRenderer, null!, null!, null!, null!, null!);
      map?.onUpdate?.(map);
    }
  }
}

/// A host of which some answers are others; `hurt` is asked for each file, with how often it was asked for before.
function troubled(known: Fetch, hurt: (url: string, times: number) => Promise<Response> | null): Fetch {
  const asked = new Map<string, number>();
  return (address, init) => {
    const url = withoutQuery(address);
    const times = asked.get(url) ?? 0;
    asked.set(url, times + 1);
    return hurt(url, times) ?? known(url, init);
  };
}

/// The index of those tiles, in one piece.
async function withSplits(answer: Response, times: number): Promise<Response> {
  const bytes = new Uint8Array(await answer.arrayBuffer());
  const view = new DataView(bytes.buffer);
  for (let at = 32; at < bytes.length; at += 120) {
    const [own, ghosts, copies] = [8, 16, 20].map((offset) => view.getUint32(at + offset, true));
    view.setUint32(at + 84, times * (own + ghosts + copies), true);
  }
  return new Response(bytes, { status: answer.status });
}

/// The same tiles, but all normals are one, and each vertex is split once for each of these times.
function split(known: Fetch, times: number): Fetch {
  return resealed(async (url, init) => {
    const answer = await known(url, init);
    if (url.endsWith('/tiles.bin')) return withSplits(answer, times);
    if (!url.endsWith('.glb')) return answer;
    const tile = await readTile(new Uint8Array(await answer.arrayBuffer()), url, null);
    const unsplit = unsplitOf(tile);
    const whole = (corners: Indices): number[] => Array.from(corners, (vertex) => (vertex < unsplit ? vertex : tile.splitOf[vertex - unsplit]));
    const numbers = Array.from({ length: unsplit }, (_, vertex) => vertex);
    const splitOf = numbers.flatMap((vertex) => Array<number>(times).fill(vertex));
    const at = [...numbers, ...splitOf];
    const arrays = { copyOf: [...tile.copyOf], border: whole(tile.border), neighbours: [...tile.neighbours], ghostStarts: [...tile.ghostStarts], chains: [...tile.chains] };
    const positions = at.flatMap((vertex) => [...tile.positions.subarray(3 * vertex, 3 * vertex + 3)]);
    const interior = whole(tile.indices.subarray(0, 3 * tile.interiorCount));
    return new Response(tileBytes({ ...tile, ...arrays, interior, splitOf, positions, codes: at.flatMap(() => [0, 0, 127]), colours: undefined, normals: undefined, picture: undefined, normalMap: undefined, tangents: undefined }) as Uint8Array<ArrayBuffer>);
  });
}

function down(): Promise<Response> {
  return Promise.resolve(new Response(null, { status: 503 }));
}

describe.skipIf(!hasProgram)('HierarchyView', () => {
  const workshop = new Workshop();
  const sessions: Session[] = [];
  beforeEach(() => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
  });
  afterEach(() => {
    for (const { view } of sessions.splice(0)) view.dispose();
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });
  afterAll(() => {
    workshop.remove();
  });

  function begin(fetch: Fetch, options?: ViewOptions): Session {
    const session = new Session(fetch, options);
    sessions.push(session);
    return session;
  }
  const torus = (): string =>
    workshop.build('torus', ['surface', '--triangles', '6000', '--shape', 'torus'], { partition: { vertices: 100 } });
  const largeTorus = (): string =>
    workshop.build('large_torus', ['surface', '--triangles', '24000', '--shape', 'torus'], { partition: { vertices: 100 } });
  const closeUp = (session: Session): void => {
    session.look([1.6, 0.4, 0.6], [0.9, 0.1, 0]);
  };

  it('settles within the error, and draws one cut', async () => {
    const session = begin(fetchFrom(torus()));
    await session.view.opened;
    closeUp(session);
    expect(await session.settle()).toBe(true);
    const { worstError, tiles, failed } = session.view.stats();
    expect(worstError).toBeLessThanOrEqual(1);
    expect(tiles).toBeGreaterThan(4);
    expect(failed).toBe(0);
  });

  it('becomes finer at rest, step by step, each at once and as a whole', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { threshold: 1, restDetail: 4 } });
    await session.view.opened;
    closeUp(session);
    const errors: number[] = [];
    for (let frames = 0; frames < 200 && !session.view.stats().settled; ++frames) {
      await session.frame();
      const { worstError } = session.view.stats();
      if (Number.isFinite(worstError) && worstError !== errors.at(-1)) errors.push(worstError);
    }
    const steps = errors.filter((error) => error <= 1);
    expect(steps).toHaveLength(3);
    for (const [step, most] of [1, 0.5, 0.25].entries()) expect(steps[step]).toBeLessThanOrEqual(most);
    expect(session.view.stats().settled).toBe(true);
  });

  it('is drawn anew only when another cut is', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { threshold: 1 } });
    await session.view.opened;
    closeUp(session);
    await session.frame();
    await session.frame();
    let before = session.cut();
    let [came, drawn] = [0, 0];
    session.view.addEventListener('change', () => { ++came; });
    for (let frames = 0; frames < 100; ++frames) {
      const news = await session.frame();
      const now = session.cut();
      if (!session.view.stats().moving && session.view.manifest !== null && frames > 10) expect(news).toBe(now.join() !== before.join());
      drawn += news ? 1 : 0;
      before = now;
    }
    expect(session.view.stats().settled).toBe(true);
    expect(came).toBeGreaterThan(2 * drawn);
  });

  it('keeps what became finer at rest while the camera moves, and asks for no more of it', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { threshold: 1 } });
    await session.view.opened;
    closeUp(session);
    await session.settle();
    const { tiles, fetchedFiles, pending } = session.view.stats();
    session.camera.position.x += 1e-4;
    await session.frame();
    expect(session.view.stats()).toMatchObject({ moving: true, tiles, fetchedFiles, pending });
    for (let frames = 0; frames < 12; ++frames) {
      await session.frame();
      expect(session.view.stats().tiles).toBe(tiles); // nor does it become coarse when it comes to rest
    }
  });

  it('stays at the error that was asked for where no more is wanted', async () => {
    const [plain, finer] = [1, 4].map((restDetail) => begin(fetchFrom(largeTorus()), { settings: { threshold: 1, restDetail } }));
    for (const session of [plain, finer]) {
      await session.view.opened;
      closeUp(session);
      expect(await session.settle()).toBe(true);
    }
    expect(plain.view.stats().worstError).toBeGreaterThan(0.5);
    expect(finer.view.stats().tiles).toBeGreaterThan(plain.view.stats().tiles);
    finer.view.setSettings({ restDetail: 1 });
    expect(await finer.settle()).toBe(true);
    expect(finer.cut()).toEqual(plain.cut());
  });

  it('stands as it is wished, is refined for it, and stands again as it did', async () => {
    const session = begin(fetchFrom(largeTorus()), { standing: { up: 'z' } });
    await session.view.opened;
    closeUp(session);
    expect(await session.settle()).toBe(true);
    const expectSize = (...wanted: readonly number[]): void => {
      session.view.box.getSize(new Vector3()).toArray().forEach((length, axis) => { expect(length).toBeCloseTo(wanted[axis], 9); });
    };
    const [there, [width, height, depth]] = [session.cut(), session.view.box.getSize(new Vector3()).toArray()];
    session.view.setStanding({ stretch: 4 });
    expectSize(width, 4 * height, depth);
    expect(await session.settle()).toBe(true);
    expect(session.cut().length).toBeGreaterThan(there.length);
    session.view.setStanding({ up: 'y', stretch: 1 });
    expectSize(width, depth, height);
    session.view.setStanding({ up: 'z' });
    expect(await session.settle()).toBe(true);
    expect(session.cut()).toEqual(there);
    expect(() => { session.view.setStanding({ stretch: 0 }); }).toThrow(RangeError);
  });

  it('draws the root before it asks for more of the mesh', async () => {
    const asked: string[] = [];
    const session = begin(fetchFrom(torus(), asked), { settings: { threshold: 0.05 } });
    await session.view.opened;
    while (session.view.manifest === null) await new Promise((resolve) => setImmediate(resolve)); // and the index: only a frame is missing
    closeUp(session);
    const tiles = (): string[] => asked.filter((url) => url.includes('tiles/'));
    await session.frame();
    expect(tiles()).toHaveLength(1);
    expect(session.view.stats()).toMatchObject({ tiles: 1, settled: false });
    await session.frame();
    expect(tiles().length).toBeGreaterThan(1);
  });

  it('tries again, by itself, what failed once', async () => {
    const once = troubled(fetchFrom(torus()), (url, times) => (times === 0 && !url.includes('tiles/00/') ? down() : null));
    const session = begin(once);
    await session.view.opened;
    closeUp(session);
    expect(await session.settle(60)).toBe(true);
    expect(session.view.stats().worstError).toBeLessThanOrEqual(1);
    expect(session.problems.length).toBeGreaterThan(2);
    expect(session.missing).toBe(0);
  });

  it('asks at once for what failed, if it is told to', async () => {
    let isDown = true;
    const session = begin(troubled(fetchFrom(torus()), (url) => (isDown && !url.includes('tiles/00/') && url.endsWith('.glb') ? down() : null)));
    await session.view.opened;
    closeUp(session);
    await session.settle(14); // after three tries it waits for a minute
    expect(session.missing).toBeGreaterThan(0);
    isDown = false;
    session.view.retry();
    expect(await session.settle(10)).toBe(true);
    expect(session.missing).toBe(0);
  });

  it('opens though the root failed at first', async () => {
    const session = begin(troubled(fetchFrom(torus()), (url, times) => (times < 2 && url.includes('tiles/00/') ? down() : null)));
    closeUp(session);
    expect(await session.settle()).toBe(true);
    await session.view.opened;
    expect(session.problems.filter((text) => text.includes('tiles/00/'))).toHaveLength(2);
  });

  it('asks again for a page of the index that failed, though nothing moves', async () => {
    const hierarchy = workshop.build('paged', ['surface', '--triangles', '5600', '--shape', 'torus'], { partition: { vertices: 9 } }); // 711 tiles: two pages
    const session = begin(troubled(fetchFrom(hierarchy), (url, times) => (times === 1 && url.endsWith('tiles.bin') ? down() : null)), { settings: { threshold: 2 } });
    await session.view.opened;
    session.look([1.45, 0.1, 0.05], [1.3, 0, 0.05]);
    expect(await session.settle()).toBe(true);
    expect(session.problems.filter((text) => text.includes('tiles.bin'))).toHaveLength(1);
    expect(session.view.stats().worstError).toBeLessThan(2);
  });

  it('holds no wires of what is not drawn', async () => {
    const session = begin(fetchFrom(torus()), { settings: { threshold: 0.05 }, look: { wires: true, points: true } });
    await session.view.opened;
    const lines = (): number => {
      let count = 0;
      session.view.traverse((object) => { count += 'isLineSegments' in object || 'isPoints' in object ? 1 : 0; });
      return count;
    };
    closeUp(session);
    await session.settle();
    session.look([-1.6, 0.4, 0.6], [-0.9, 0.1, 0]);
    await session.settle();
    expect(session.view.stats().residentTiles).toBeGreaterThan(session.meshes().length);
    expect(lines()).toBe(2 * session.meshes().length);
    session.view.setLook({ wires: false, points: false });
    await session.settle();
    await session.frame();
    expect(lines()).toBe(0);
  });

  it('stays with the root, and says so once, where the manifest is of no use', async () => {
    const odd = troubled(fetchFrom(torus()), (url) =>
      url.endsWith('hierarchy.json') ? Promise.resolve(new Response('{"format":"meshhier","format_version":3}')) : null);
    const session = begin(odd);
    await session.view.opened;
    closeUp(session);
    expect(await session.settle()).toBe(true);
    expect(session.problems).toHaveLength(1);
    expect(session.view.stats().tiles).toBe(1);
  });

  it('settles without a tile that never comes', async () => {
    const never = troubled(fetchFrom(torus()), (url) => (url.includes('tiles/01/000000') ? down() : null));
    const session = begin(never);
    await session.view.opened;
    closeUp(session);
    expect(await session.settle(50)).toBe(true);
    expect(session.view.stats().failed).toBe(4);
    expect(session.view.stats().tiles).toBe(1);
  });

  it('draws a whole cut whatever a ghost says, and tells', async () => {
    const hierarchy = torus();
    const known = fetchFrom(hierarchy);
    const damaged = resealed(troubled(known, (url) => {
      if (!/tiles\/0[45]/.test(url)) return null;
      return known(url).then(async (response) => {
        const bytes = new Uint8Array(await response.arrayBuffer());
        const view = new DataView(bytes.buffer);
        view.setUint16(bytes.length - 4, 32767, true); // in the chains, which come last
        view.setUint16(bytes.length - 2, 32767, true);
        return new Response(bytes);
      });
    }));
    const session = begin(damaged, { settings: { threshold: 0.5 } });
    await session.view.opened;
    closeUp(session);
    expect(await session.settle()).toBe(true);
    expect(session.problems.some((text) => text.includes('ghost'))).toBe(true);
    for (const { geometry } of session.meshes()) {
      const drawn = [...geometry.index!.array].slice(0, geometry.drawRange.count);
      expect(Math.max(...drawn)).toBeLessThan(geometry.attributes.position.count);
    }
  });

  it('refuses a tile that is another one', async () => {
    const hierarchy = torus();
    const known = fetchFrom(hierarchy);
    const mixed = troubled(known, (url) => (url.includes('tiles/01/000000') ? known(url.replace('000000', '000001')) : null));
    const session = begin(mixed);
    await session.view.opened;
    closeUp(session);
    await session.settle(50);
    expect(session.problems[0]).toContain('tiles/01/000000.glb');
  });

  it('says that there is something new when it refines at rest', async () => {
    const session = begin(fetchFrom(torus()));
    await session.view.opened;
    closeUp(session);
    await session.frame();
    let before = session.view.stats().tiles;
    let changes = 0;
    for (let step = 0; step < 60; ++step) {
      const news = await session.frame();
      const { tiles } = session.view.stats();
      if (tiles !== before) expect(news).toBe(true);
      changes += tiles !== before ? 1 : 0;
      before = tiles;
    }
    expect(changes).toBeGreaterThan(1);
  });

  it('asks for no frame once all is there', async () => {
    const session = begin(fetchFrom(torus()));
    await session.view.opened;
    closeUp(session);
    await session.settle();
    let changes = 0;
    session.view.addEventListener('change', () => { ++changes; });
    vi.advanceTimersByTime(10_000);
    expect(changes).toBe(0);
  });

  it('knows its first view with the root tile, as it stands', async () => {
    const { view } = begin(fetchFrom(largeTorus()));
    expect(view.firstDirection).toBeNull();
    await view.opened;
    expect(Math.hypot(...view.firstDirection!)).toBeCloseTo(1);
    expect(view.firstDirection![1]).toBeGreaterThan(0);
    view.setStanding({ up: 'x' });
    expect(view.firstDirection).toBeNull();
  });

  /// At rest, of a view that is opened there; and of one that was elsewhere before.
  async function cutsAt(from: Place, elsewhere: Place, threshold: number): Promise<[string[], string[]]> {
    const [first, second] = [0, 1].map(() => begin(fetchFrom(largeTorus()), { settings: { threshold } }));
    for (const { view } of [first, second]) await view.opened;
    for (const [session, place] of [[second, elsewhere], [first, from], [second, from]] as const) {
      session.look(place, [0.9, 0.1, 0]);
      expect(await session.settle()).toBe(true);
    }
    return [first.cut(), second.cut()];
  }

  it('draws the same at rest, though it was closer before', async () => {
    const [opened, moved] = await cutsAt([1.6, 0.4, 0.6], [1.3, 0.3, 0.4], 2);
    expect(moved).toEqual(opened);
  });

  it('draws the same at rest, though it knew before what looks away', async () => {
    const [opened, moved] = await cutsAt([-2.08, 0.4, 4.55], [-2, 0.4, 4.5], 0.05);
    expect(moved).toEqual(opened);
  });

  it('stays as it came to rest, and fetched nothing for it', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { threshold: 2 } });
    await session.view.opened;
    closeUp(session);
    await session.settle();
    session.look([1.3, 0.3, 0.4], [0.9, 0.1, 0]);
    await session.settle();
    const { fetchedFiles } = session.view.stats();
    closeUp(session);
    await session.settle();
    const there = session.cut();
    for (let times = 0; times < 5; ++times) {
      session.view.setSettings({}); // it chooses again
      await session.frame();
      expect(session.cut()).toEqual(there);
    }
    expect(session.view.stats().fetchedFiles).toBe(fetchedFiles);
  });

  it('keeps what was finer while the camera moves', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { threshold: 2 } });
    await session.view.opened;
    session.look([1.3, 0.3, 0.4], [0.9, 0.1, 0]);
    await session.settle();
    closeUp(session);
    await session.frame();
    const { moving, tiles } = session.view.stats();
    await session.settle();
    expect(moving).toBe(true);
    expect(tiles).toBeGreaterThan(session.view.stats().tiles);
  });

  it('forgets what tiles took once, when memory is what limits it', async () => {
    const session = begin(fetchFrom(largeTorus()), { settings: { memoryBudget: 1_108_000, threshold: 0.2 } });
    await session.view.opened;
    closeUp(session);
    await session.settle();
    const there = session.cut();
    for (const wires of [true, false]) {
      session.view.setLook({ wires });
      await session.settle();
      expect(session.cut().length < there.length).toBe(wires);
    }
    expect(session.cut()).toEqual(there);
  });

  it('keeps to the memory it may take, whatever is to be seen of it', async () => {
    const memoryBudget = 1_000_000;
    const session = begin(fetchFrom(torus()), { settings: { memoryBudget, threshold: 0.05 } });
    await session.view.opened;
    closeUp(session);
    await session.settle();
    expect(session.view.stats().residentBytes).toBeGreaterThan(memoryBudget / 2);
    session.view.setLook({ wires: true, points: true });
    await session.settle();
    session.look([-1.6, 0.4, 0.6], [-0.9, 0.1, 0]);
    await session.settle();
    expect(session.view.stats().residentBytes).toBeLessThanOrEqual(memoryBudget);
    expect(session.view.stats().peakBytes).toBeLessThanOrEqual(memoryBudget);
  });

  it('keeps to that memory with splits too', async () => {
    const memoryBudget = 1_500_000;
    const session = begin(split(fetchFrom(largeTorus()), 4), { settings: { memoryBudget, threshold: 0.05 } });
    await session.view.opened;
    closeUp(session);
    expect(await session.settle()).toBe(true);
    expect(session.view.stats().residentBytes).toBeGreaterThan(memoryBudget / 2);
    expect(session.view.stats().peakBytes).toBeLessThanOrEqual(memoryBudget);
  });

  const textured = (): string => {
    const mesh = path.join(workshop.directory, 'textured.obj');
    writeFileSync(mesh, texturedObj(40));
    writeFileSync(path.join(workshop.directory, 'textured.mtl'), 'newmtl one\nmap_Kd textured.png\n');
    writeFileSync(path.join(workshop.directory, 'textured.png'), png(1024, 1024));
    return workshop.buildMesh('textured', mesh, { partition: { vertices: 100 }, texture: { texels: 128 } });
  };

  it('keeps to that memory with pictures too, shows no tile without its own, and closes all', async () => {
    vi.stubGlobal('createImageBitmap', fakeDecode);
    FakeBitmap.open = 0;
    const hierarchy = textured();
    const wide = begin(fetchFrom(hierarchy), { settings: { threshold: 0.05 } });
    await wide.view.opened;
    wide.look([0.5, 1, 0.5], [0.5, 0, 0.5001]);
    for (const end = { frames: 600 }; end.frames > 0 && !wide.view.stats().settled; --end.frames) {
      await wide.frame();
      for (const { material } of wide.meshes()) expect(material).toMatchObject({ map: { image: { isClosed: false } } });
    }
    expect(wide.view.manifest?.source.textures).toEqual({ images: 1, missingImages: 0 });
    expect(wide.meshes().length).toBeGreaterThan(4);
    expect(wide.meshes().every(({ material }) => material instanceof MeshBasicMaterial)).toBe(true);
    expect(FakeBitmap.open).toBe(wide.view.stats().residentTiles);
    const memoryBudget = Math.max(1e6, Math.round(wide.view.stats().residentBytes / 2));
    const tight = begin(fetchFrom(hierarchy), { settings: { memoryBudget, threshold: 0.05 } });
    await tight.view.opened;
    tight.look([0.5, 1, 0.5], [0.5, 0, 0.5001]);
    expect(await tight.settle()).toBe(true);
    expect(tight.view.stats().peakBytes).toBeLessThanOrEqual(memoryBudget);
    expect(tight.view.stats().residentTiles).toBeLessThan(wide.view.stats().residentTiles);
    for (const { view } of [wide, tight]) view.dispose();
    expect(FakeBitmap.open).toBe(0);
  });

  it('holds no picture twice once it is drawn, and asks again for those that went with the device', async () => {
    vi.stubGlobal('createImageBitmap', fakeDecode);
    FakeBitmap.open = 0;
    const asked: string[] = [];
    const session = begin(fetchFrom(textured(), asked), { settings: { threshold: 0.05 } });
    await session.view.opened;
    session.look([0.5, 1, 0.5], [0.5, 0, 0.5001]);
    await session.settle();
    const device = new Device();
    device.draw(session.meshes());
    const { tiles, residentTiles } = session.view.stats();
    expect(tiles).toBeGreaterThan(4);
    expect(FakeBitmap.open).toBeLessThanOrEqual(residentTiles - tiles);
    const [there, before] = [session.cut(), asked.length];
    device.canvas.dispatchEvent(new Event('webglcontextrestored'));
    await session.frame();
    expect(session.meshes().length).toBeLessThan(there.length);
    for (const { material } of session.meshes()) expect(material).toMatchObject({ map: { image: { isClosed: false } } });
    expect(await session.settle()).toBe(true);
    expect(session.cut()).toEqual(there);
    expect(asked.length).toBeGreaterThanOrEqual(before + tiles);
    for (const { material } of session.meshes()) expect(material).toMatchObject({ map: { image: { isClosed: false } } });
    session.view.dispose();
    expect(FakeBitmap.open).toBe(0);
  });

  it('goes on without a tile whose picture cannot be decoded, and tells', async () => {
    let pictures = 0;
    vi.stubGlobal('createImageBitmap', async (file: Blob) => (++pictures > 1 ? Promise.reject(new Error('no')) : fakeDecode(file)));
    const session = begin(fetchFrom(textured()), { settings: { threshold: 0.05 } });
    await session.view.opened;
    session.look([0.5, 1, 0.5], [0.5, 0, 0.5001]);
    expect(await session.settle(60)).toBe(true);
    expect(session.view.stats().tiles).toBe(1);
    expect(session.problems[0]).toMatch(/tiles\/.*\.glb: its picture cannot be decoded/);
  });

  it('finds what sticks out of the coarse shape', async () => {
    const mesh = path.join(workshop.directory, 'antenna.ply');
    writeFileSync(mesh, antenna());
    const hierarchy = workshop.buildMesh('antenna', mesh, { partition: { vertices: 64 } });
    const session = begin(fetchFrom(hierarchy));
    await session.view.opened;
    await session.settle(5);
    session.camera.far = 1000;
    session.camera.updateProjectionMatrix();
    session.look([0.5, 58.6, 0.5], [0.5, 70, 0.5001]);
    await session.settle();
    expect(session.view.stats().finestLevel).toBeGreaterThan(3);
  });

  describe('with normal maps', () => {
    const mapped = (): string => workshop.build('mapped', ['surface', '--triangles', '6000', '--shape', 'torus'], { partition: { vertices: 100 }, storage: { normals: 'map' } });
    /// A host that stops amid the root's map until `end` is called, with an error if that is given.
    const halting = (known: Fetch): { fetch: Fetch; end: (problem?: Error) => void } => {
      let end!: (problem?: Error) => void;
      const fetch: Fetch = async (address, init) => {
        const answer = await known(address, init);
        if (!withoutQuery(address).endsWith('tiles/00/000000.glb') || end !== undefined) return answer;
        const bytes = new Uint8Array(await answer.arrayBuffer());
        const body = new ReadableStream<Uint8Array>({
          start: (controller) => {
            controller.enqueue(bytes.slice(0, bytes.length - 1000));
            end = (problem) => {
              if (problem) controller.error(problem);
              else controller.enqueue(bytes.slice(bytes.length - 1000));
              if (problem === undefined) controller.close();
            };
          },
        });
        return new Response(body);
      };
      return { fetch, end: (problem) => { end(problem); } };
    };
    const root = (session: Session): MeshStandardMaterial => session.meshes()[0].material as MeshStandardMaterial;
    beforeEach(() => {
      FakeBitmap.open = 0;
      vi.stubGlobal('createImageBitmap', fakeDecode);
    });

    it('draws the root before its map has come, and then with it', async () => {
      const host = halting(fetchFrom(mapped()));
      const session = begin(host.fetch);
      await session.view.opened;
      closeUp(session);
      for (let frames = 0; frames < 5; ++frames) await session.frame();
      expect(session.meshes()).toHaveLength(1);
      expect(root(session).normalMap).toBeNull();
      expect(session.view.stats()).toMatchObject({ settled: false, fetchedFiles: 0 });
      const cut = session.cut();
      const compiling: (() => void)[] = [];
      const compileAsync = async (): Promise<void> => new Promise((resolve) => { compiling.push(resolve); });
      session.meshes()[0].onBeforeRender({ domElement: new EventTarget(), initTexture: () => undefined, extensions: new Set(['KHR_parallel_shader_compile']), compileAsync } as unknown as WebGLRenderer, null!, null!, null!, null!, null!);
      host.end();
      for (let frames = 0; frames < 20; ++frames) await session.frame();
      expect(root(session).normalMap).toBeNull(); // until its program is there
      for (const done of compiling) done();
      while (root(session).normalMap === null) await session.frame();
      expect(session.cut()).toEqual(cut);
      expect(await session.settle()).toBe(true);
      expect(session.view.stats().tiles).toBeGreaterThan(4);
      expect(session.problems).toEqual([]);
      session.view.dispose();
      expect(FakeBitmap.open).toBe(0);
    });

    it('asks again for a root whose map broke off', async () => {
      const host = halting(fetchFrom(mapped()));
      const session = begin(host.fetch);
      await session.view.opened;
      closeUp(session);
      await session.frame();
      host.end(new TypeError('the line'));
      expect(await session.settle()).toBe(true);
      expect(session.problems).toEqual([expect.stringContaining('tiles/00/000000.glb: broke off')]);
      expect(session.missing).toBe(0);
    });

    it('keeps a root whose map does not come, and asks for it when it is told to', async () => {
      let isDown = false;
      const host = halting(fetchFrom(mapped()));
      const session = begin(troubled(host.fetch, () => (isDown ? down() : null)));
      await session.view.opened;
      closeUp(session);
      await session.frame();
      isDown = true;
      host.end(new TypeError('the line'));
      expect(await session.settle(60)).toBe(true);
      expect(root(session).normalMap).toBeNull();
      expect(session.missing).toBeGreaterThan(0);
      isDown = false;
      session.view.retry();
      expect(await session.settle()).toBe(true);
      expect(session.missing).toBe(0);
      expect(session.view.stats().tiles).toBeGreaterThan(4);
    });

    it('is closed before the map has come', async () => {
      const host = halting(fetchFrom(mapped()));
      const session = begin(host.fetch);
      await session.view.opened;
      session.view.dispose();
      host.end();
      await session.frame();
      expect(FakeBitmap.open).toBe(0);
      expect(session.problems).toEqual([]);
    });

    it('shows tiles once their maps are on the GPU, and prepares the programs of both kinds', async () => {
      const session = begin(fetchFrom(mapped()), { settings: { threshold: 8, restDetail: 1 } });
      await session.view.opened;
      closeUp(session);
      await session.frame();
      const uploaded: unknown[] = [];
      const compiled: Mesh[] = [];
      const renderer = { domElement: new EventTarget(), initTexture: (texture: unknown) => uploaded.push(texture), extensions: new Set(), compile: (mesh: Mesh) => compiled.push(mesh) } as unknown as WebGLRenderer;
      session.meshes()[0].onBeforeRender(renderer, null!, null!, null!, null!, null!);
      await session.frame();
      expect(compiled.map(({ material }) => (material as MeshStandardMaterial).normalMap !== null)).toEqual([true, false]);
      expect(await session.settle()).toBe(true);
      const shown = session.meshes().flatMap(({ material }) => (material as MeshStandardMaterial).normalMap ?? []);
      expect(shown.length).toBeGreaterThan(0);
      expect(uploaded).toEqual(expect.arrayContaining(shown));
    });
  });

  it('ends what is under way', async () => {
    const session = begin((_url, init) => new Promise((_resolve, reject) => {
      init?.signal?.addEventListener('abort', () => { reject(new DOMException('ended', 'AbortError')); });
    }));
    const ended = expect(session.view.opened).rejects.toThrow('ended');
    session.view.dispose();
    await ended;
    expect(session.problems).toEqual([]);
  });

  it('refuses settings that make no sense', () => {
    const session = begin(fetchFrom(torus()), { settings: { memoryBudget: undefined } });
    expect(session.view.settings.memoryBudget).toBe(256e6);
    expect(() => { session.view.setSettings({ threshold: NaN }); }).toThrow(RangeError);
    expect(() => { session.view.setSettings({ framesPerSecond: 0 }); }).toThrow(RangeError);
  });
});

/// A wavy square that a picture covers.
function texturedObj(size: number): string {
  const numbers = Array.from({ length: (size + 1) ** 2 }, (_, i) => i);
  const at = (i: number): [number, number] => [(i % (size + 1)) / size, Math.floor(i / (size + 1)) / size];
  const places = numbers.map((i) => { const [x, z] = at(i); return `v ${x} ${0.05 * Math.sin(9 * x) * Math.sin(7 * z)} ${z}\nvt ${x} ${z}`; });
  const faces = numbers.filter((i) => i % (size + 1) < size && i < size * (size + 1)).map((i) => {
    const [a, b, c, d] = [i, i + size + 1, i + size + 2, i + 1].map((v) => `${v + 1}/${v + 1}`);
    return `f ${a} ${b} ${c}\nf ${a} ${c} ${d}`;
  });
  return ['mtllib textured.mtl', ...places, 'usemtl one', ...faces, ''].join('\n');
}

/// A rough square of 40 x 40 around a thin pole, 60 high.
function antenna(): string {
  const size = 40;
  const vertices: string[] = [];
  const faces: string[] = [];
  for (let z = 0; z <= size; ++z) for (let x = 0; x <= size; ++x) vertices.push(`${x - size / 2} ${((x * 7 + z * 13) % 5) / 5} ${z - size / 2}`);
  for (let z = 0; z < size; ++z)
    for (let x = 0; x < size; ++x) {
      const a = z * (size + 1) + x;
      faces.push(`3 ${a} ${a + size + 1} ${a + 1}`, `3 ${a + 1} ${a + size + 1} ${a + size + 2}`);
    }
  const first = vertices.length;
  for (let i = 0; i <= 60; ++i) for (const [x, z] of [[0.49, 0.49], [0.51, 0.49], [0.5, 0.51]]) vertices.push(`${x} ${i} ${z}`);
  for (let i = 0; i < 60; ++i)
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [first + 3 * i + k, first + 3 * i + ((k + 1) % 3)];
      faces.push(`3 ${a} ${b} ${a + 3}`, `3 ${b} ${b + 3} ${a + 3}`);
    }
  return `ply\nformat ascii 1.0\nelement vertex ${vertices.length}\nproperty float x\nproperty float y\nproperty float z\nelement face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n${vertices.join('\n')}\n${faces.join('\n')}\n`;
}
