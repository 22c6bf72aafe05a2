// SPDX-License-Identifier: MIT
// Values of vertices: out of the manifest and tiles of a real hierarchy, along seams, under a ray, and as colours.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { PerspectiveCamera } from 'three';
import { afterAll, describe, expect, it } from 'vitest';
import { HierarchyView, type ScalarAttribute } from '../src/index.js';
import { readManifest } from '../src/hierarchy/manifest.js';
import { NO_VALUE } from '../src/hierarchy/scalar_values.js';
import { Attributes, isolineStep } from '../src/plugins/attributes.js';
import { labelColour, rampColour, RAMPS } from '../src/scene/ramps.js';
import { attributeIndex, DEFAULT_LOOK, wholeRange } from '../src/scene/settings.js';
import type { Tile } from '../src/hierarchy/tile.js';
import { Picker, rayThrough } from '../src/tools/pick.js';
import { pickedPoint } from '../src/tools/picked_point.js';
import { fetchFrom, hasProgram, Workshop } from './support/meshhier.js';

const SIDE = 40;
const VIEWPORT = { width: 800, height: 600 };

/// A grid, z = 0: `height` = 2 x, not a number at one of 16; `class`: 3 or 300 by the side of x = 20.
function gridText(): string {
  const header = `ply\nformat ascii 1.0\nelement vertex ${SIDE ** 2}\nproperty float x\nproperty float y\nproperty float z\nproperty double height\nproperty ushort class\n`;
  const vertices = Array.from({ length: SIDE ** 2 }, (_, i) => {
    const [x, y] = [i % SIDE, Math.floor(i / SIDE)];
    return `${x} ${y} 0 ${x % 4 === 0 && y % 4 === 0 ? 'nan' : 2 * x} ${x < 20 ? 3 : 300}`;
  });
  const faces: string[] = [];
  for (let y = 0; y + 1 < SIDE; ++y)
    for (let x = 0; x + 1 < SIDE; ++x) {
      const a = y * SIDE + x;
      faces.push(`3 ${a} ${a + 1} ${a + SIDE + 1}`, `3 ${a} ${a + SIDE + 1} ${a + SIDE}`);
    }
  return `${header}element face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n${[...vertices, ...faces].join('\n')}\n`;
}

describe.skipIf(!hasProgram)('values of a hierarchy', () => {
  const workshop = new Workshop();
  afterAll(() => { workshop.remove(); });
  const hierarchy = (): string => {
    const mesh = path.join(workshop.directory, 'grid.ply');
    writeFileSync(mesh, gridText());
    return workshop.buildMesh('grid', mesh, { partition: { vertices: 100 }, up: 'y' });
  };

  async function settled(look: object = {}): Promise<{ view: HierarchyView; camera: PerspectiveCamera }> {
    const view = new HierarchyView('', { fetch: fetchFrom(hierarchy()), look, settings: { threshold: 0.01 } });
    const camera = new PerspectiveCamera(45, VIEWPORT.width / VIEWPORT.height, 0.1, 1000);
    camera.position.set(20, 20, 60);
    camera.lookAt(20, 20, 0);
    await view.opened;
    for (let now = 0; now < 60_000 && !view.stats().settled; now += 50) {
      view.update(camera, VIEWPORT, now);
      await new Promise((resolve) => setImmediate(resolve));
    }
    return { view, camera };
  }

  it('are listed in the manifest', () => {
    const { values } = readManifest(readFileSync(path.join(hierarchy(), 'hierarchy.json'), 'utf8')).source;
    expect(values.map(({ name, kind }) => [name, kind])).toEqual([['height', 'quantity'], ['class', 'label']]);
    expect(values[0]).toMatchObject({ min: 0, max: 78, missing: 100 });
    expect(values[0].bins.reduce((sum, count) => sum + count, 0)).toBe(1500);
    expect(values[1].labels).toEqual([3, 300]);
  });

  it('are those of the input in the partitions, ghosts too', async () => {
    const { view } = await settled();
    const tiles = view.source!.tree.lastLevel;
    let seen = 0;
    for (const { node, tile } of view.surface) {
      if (node.level !== tiles) continue;
      for (let v = 0; 3 * v < tile.positions.length; ++v) {
        const [x, y] = [tile.positions[3 * v], tile.positions[3 * v + 1]];
        expect(tile.values![2 * v]).toBe(x % 4 === 0 && y % 4 === 0 ? Math.fround(NO_VALUE) : 2 * x);
        expect(tile.values![2 * v + 1]).toBe(x < 20 ? 3 : 300);
        ++seen;
      }
    }
    expect(seen).toBeGreaterThan(SIDE ** 2);
    view.dispose();
  });

  it('are told of a point: quantities between vertices, labels of the nearest', async () => {
    const { view, camera } = await settled();
    const hit = new Picker().pick(view.surface, rayThrough(camera, 0.33, 0.21, view.surfaceMatrix))!;
    const picked = pickedPoint(hit, view.manifest!, false);
    expect(picked.values.map(({ name }) => name)).toEqual(['height', 'class']);
    const [x] = picked.point;
    if (picked.values[0].value !== null) expect(picked.values[0].value).toBeCloseTo(2 * x, 4);
    expect(picked.values[1].value).toBe(Math.round(x) < 20 ? 3 : 300);
    view.dispose();
  });

  it('reach the geometry of tiles once they are shown, each in its turn', async () => {
    const { view, camera } = await settled({ colours: 'attribute', attribute: 'class' });
    const offsets = (): Set<number> => {
      const found = new Set<number>();
      view.traverse((object) => {
        const { geometry } = object as { geometry?: { attributes: Record<string, { offset?: number }> } };
        const offset = geometry?.attributes.scalar?.offset;
        if (object.visible && offset !== undefined) found.add(offset);
      });
      return found;
    };
    expect(offsets()).toEqual(new Set([1]));
    view.setLook({ attribute: 'height' });
    view.update(camera, VIEWPORT, 100_000);
    expect(offsets()).toEqual(new Set([0]));
    view.dispose();
  });
});

const QUANTITY: ScalarAttribute = { name: 'q', kind: 'quantity', min: -1, max: 3, missing: 0, binWidth: 1, firstBin: -1, bins: [1, 0, 0, 0, 1], labels: [], labelNames: [] };
const LABEL: ScalarAttribute = { ...QUANTITY, name: 'l', kind: 'label', min: 2, max: 5, labels: [2, 5], labelNames: ['', 'door'] };

describe('an attribute as colours', () => {
  it('is the one of that name, else the first', () => {
    expect(attributeIndex([QUANTITY, LABEL], 'l')).toBe(1);
    expect(attributeIndex([QUANTITY, LABEL], 'none')).toBe(0);
    expect(attributeIndex([], 'l')).toBe(-1);
  });

  it('has the whole range, on both sides of 0 where the ramp has a middle', () => {
    expect(wholeRange(QUANTITY, 'viridis')).toEqual([-1, 3]);
    expect(wholeRange(QUANTITY, 'coolwarm')).toEqual([-3, 3]);
    expect(wholeRange({ ...QUANTITY, min: 1 }, 'coolwarm')).toEqual([1, 3]);
  });

  it('has isolines at round steps', () => {
    expect(isolineStep([0, 1])).toBeCloseTo(0.1);
    expect(isolineStep([0, 123])).toBe(20);
    expect(isolineStep([5, 5])).toBeGreaterThan(0);
    expect(isolineStep([3, -1])).toBeCloseTo(0.5);
  });

  it('goes from one end of a ramp to the other, and no farther', () => {
    for (const ramp of RAMPS) {
      expect(rampColour(ramp, -1)).toEqual(rampColour(ramp, 0));
      expect(rampColour(ramp, 2)).toEqual(rampColour(ramp, 1));
    }
    expect(rampColour('viridis', 0)).toEqual([0x44, 0x01, 0x54]);
    expect(rampColour('viridis', 1)).toEqual([0xfd, 0xe7, 0x25]);
  });

  it('gives labels colours of their own', () => {
    const colours = Array.from({ length: 30 }, (_, i) => labelColour(i));
    expect(new Set(colours.map(String)).size).toBe(30);
    for (const colour of colours) for (const channel of colour) expect(channel >= 0 && channel <= 255).toBe(true);
  });

  it('hides labels', () => {
    const paint = new Attributes();
    paint.show({ ...DEFAULT_LOOK, attribute: 'l', hidden: [5] }, [QUANTITY, LABEL]);
    expect(paint.key({ ...DEFAULT_LOOK, colours: 'attribute' }, { values: new Float32Array(2) } as Tile)).toBe('label');
    const { data } = paint.uniforms.valueRamp.value!.image as { data: Uint8Array };
    expect([3, 7, 11, 15].map((alpha) => data[alpha])).toEqual([255, 255, 255, 0]);
    paint.show({ ...DEFAULT_LOOK, range: [2, 0] }, [QUANTITY]);
    expect(paint.uniforms.valueRange.value.toArray()).toEqual([2, 0]);
    paint.dispose();
  });

  it('goes along the range of another build', () => {
    const paint = new Attributes();
    for (const max of [4, 9]) {
      paint.show(DEFAULT_LOOK, [{ ...QUANTITY, min: 0, max }]);
      expect(paint.uniforms.valueRange.value.y).toBe(wholeRange({ ...QUANTITY, min: 0, max }, DEFAULT_LOOK.ramp)[1]);
    }
    expect(paint.uniforms.valueRange.value.y).toBeGreaterThan(4);
    paint.dispose();
  });
});
