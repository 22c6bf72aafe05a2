// SPDX-License-Identifier: MIT
// The volume of the original is of the objects that are drawn.
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { setTimeout as later } from 'node:timers/promises';
import { Vector3 } from 'three';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { ClipTool } from '../../page/tools/clip_tool.js';
import { ToolLink } from '../../page/tools/tool_link.js';
import { words } from '../../page/tools/words/words.js';
import type { Workshop as PageWorkshop } from '../../page/tools/workshop.js';
import { Objects } from '../../src/plugins/objects.js';
import { LengthScale } from '../../src/tools/units.js';
import { faked, fakePage } from '../support/fake_page.js';
import { fetchFrom, hasProgram, Workshop } from '../support/meshhier.js';
import { Session } from '../support/session.js';
import { Town } from '../support/town.js';

describe.skipIf(!hasProgram)('the volume of the original', () => {
  const workshop = new Workshop();
  const town = new Town(12);
  let directory: string;
  let session: Session;
  let objects: Objects;
  let tool: ClipTool;

  beforeAll(() => {
    const mesh = path.join(workshop.directory, 'town.ply');
    writeFileSync(mesh, town.ply());
    directory = workshop.buildMesh('town', mesh, { up: 'z', partition: { vertices: 800 } });
    town.furnish(directory);
  });
  beforeEach(async () => {
    fakePage();
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    session = new Session(fetchFrom(directory));
    const { view } = session;
    await view.opened;
    objects = new Objects();
    view.registerPlugin(objects);
    session.look([0, 60, 0], [1e-3, 0, 0]);
    await session.settle();
    const closed = new Proxy(view, { get: (of, name) => { const value: unknown = name === 'closed' || Reflect.get(of, name, of); return typeof value === 'function' ? (value.bind(of) as unknown) : value; } });
    const bench = { view: closed, name: 'town', pose: () => ({ forward: new Vector3(0, -1, 0) }), redraw: vi.fn() };
    tool = new ClipTool({ bench, scale: new LengthScale('m', 'm', words.units.unit), settings: { modelUnit: 'm' }, link: () => new ToolLink('', () => undefined) } as unknown as PageWorkshop);
  });
  afterEach(() => {
    session.view.dispose();
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });
  afterAll(() => { workshop.remove(); });

  const note = (): string => faked(faked(tool.root).children.at(-1)).textContent;
  const told = (): string => {
    tool.drawn();
    return faked(faked(tool.root).children[4]).textContent;
  };
  const measure = (): void => { faked(faked(tool.root).children[5]).dispatchEvent(new Event('click')); };

  it('is told no more once other objects are drawn, however many are hidden', async () => {
    const hidden = town.rows.slice(1, 121).map(({ name }) => name);
    await objects.draw({ hidden });
    const shown = told();
    measure();
    await vi.waitFor(() => { expect(note()).toBe(words.clip.isOriginal); });
    const original = told();
    expect(original).not.toBe(shown);
    await objects.draw({ hidden: [...hidden, town.rows[121].name] });
    expect([note(), told() === original, note()]).toEqual([words.clip.isOriginal, false, '']);
  });

  it('is none where other objects are drawn while it is measured', async () => {
    const shown = told();
    measure();
    objects.shading.leaveOut([{ begin: 1, end: 40, isOut: true }], town.rows.length);
    objects.shading.leaveOut([], town.rows.length);
    await later(300);
    expect([note(), told()]).toEqual(['', shown]);
  });
});
