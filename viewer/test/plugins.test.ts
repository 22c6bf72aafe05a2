// SPDX-License-Identifier: MIT
import { PerspectiveCamera, Plane, Scene, Vector3, type Material, type Mesh, type WebGLProgramParametersWithUniforms, type WebGLRenderer } from 'three';
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, it, vi } from 'vitest';
import { Plugins, type StageOf } from '../src/plugins/plugin.js';
import { replaceChunk, type Frame, type HierarchyView, type Plugin, type Shader, type Shading, type Stage } from '../src/index.js';
import { hasProgram, Workshop, fetchFrom } from './support/meshhier.js';
import { Session } from './support/session.js';

/// A plug-in as somebody else would write it: it paints stripes, tells what it was asked, and keeps one half of the world.
class Stranger implements Plugin {
  readonly name = 'stranger';
  readonly told: string[] = [];
  isPainter = false;
  readonly shading: Shading = {
    uniforms: { stripes: { value: 4 } },
    key: ({ colours }) => (colours === 'plain' ? 'striped' : ''),
    edit: (shader: Shader) => { replaceChunk(shader, 'fragmentShader', 'color_fragment', '#include <color_fragment>\ndiffuseColor.rgb *= fract(stripes);'); },
    prepare: (_, tile) => { this.told.push(`prepare ${tile.level}`); },
  };

  init(view: HierarchyView): void {
    this.told.push(`init ${view.look.colours}`);
  }

  enter({ view }: Stage): void {
    this.told.push(`enter ${view.look.colours}`);
  }

  paint(): boolean {
    this.told.push('paint');
    return this.isPainter;
  }

  shade({ renderer }: Frame): void {
    this.told.push(`shade ${typeof renderer}`);
  }

  drawn(): void {
    this.told.push('drawn');
  }

  keeps({ x }: Vector3): boolean {
    return x > 0;
  }

  tapped(right: number, up: number): boolean {
    return right > up;
  }

  dispose(): void {
    this.told.push('dispose');
  }
}

function refuse(): never {
  throw new Error('no');
}

const render = vi.fn();
const RENDERER = { render } as unknown as WebGLRenderer;

function compiled(mesh: Mesh): WebGLProgramParametersWithUniforms {
  const shader = { uniforms: {}, vertexShader: '', fragmentShader: '#include <color_fragment>' } as WebGLProgramParametersWithUniforms;
  (mesh.material as Material).onBeforeCompile(shader, RENDERER);
  return shader;
}

describe.skipIf(!hasProgram)('a plug-in of a stranger', () => {
  let workshop: Workshop;
  let directory: string;
  let session: Session;
  let plugin: Stranger;

  beforeAll(() => {
    workshop = new Workshop();
    directory = workshop.build('plain', ['surface', '--triangles', '2000', '--shape', 'torus'], { partition: { vertices: 500 } });
  });
  beforeEach(async () => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
    session = new Session(fetchFrom(directory), { look: { colours: 'plain' } });
    plugin = new Stranger();
    await session.view.opened;
    session.look([0, 0, 3], [0, 0, 0]);
    await session.settle();
  });
  afterEach(() => {
    session.view.dispose();
    vi.useRealTimers();
  });
  afterAll(() => { workshop.remove(); });

  it('shades the tiles that are there, in a program of its own, until it is taken away', async () => {
    const keyOf = (): string => (session.meshes()[0].material as Material).customProgramCacheKey();
    const before = keyOf();
    session.view.registerPlugin(plugin);
    expect(await session.frame()).toBe(true);
    expect(keyOf()).not.toBe(before);
    const shader = compiled(session.meshes()[0]);
    expect(shader.uniforms.stripes).toBe(plugin.shading.uniforms.stripes);
    expect(shader.fragmentShader).toContain('fract(stripes)');
    expect(plugin.told).toContain(`prepare ${session.view.shown[0].level}`);
    session.view.unregisterPlugin(plugin);
    await session.frame();
    expect(keyOf()).toBe(before);
    expect(plugin.told.at(-1)).toBe('dispose');
  });

  it('leaves alone what its key does not name', async () => {
    session.view.registerPlugin(plugin).setLook({ colours: 'height' });
    await session.frame();
    expect(compiled(session.meshes()[0]).fragmentShader).not.toContain('stripes');
  });

  it('draws with the renderer, or instead of it', () => {
    render.mockClear();
    const draw = (): void => { session.view.draw(RENDERER, new Scene(), new PerspectiveCamera()); };
    session.view.registerPlugin(plugin);
    draw();
    expect(render).toHaveBeenCalledTimes(1);
    expect(plugin.told.slice(-3)).toEqual(['paint', 'shade object', 'drawn']);
    plugin.isPainter = true;
    draw();
    expect(render).toHaveBeenCalledTimes(1);
    expect(plugin.told.slice(-2)).toEqual(['paint', 'drawn']);
  });

  it('marks the picture, whoever has made it, after all that was drawn over it', () => {
    const [marked, plane] = [vi.fn(), new Plane(new Vector3(0, 1, 0), 2)];
    const told: string[] = [];
    session.view.registerPlugin({ name: 'marks', cuts: [plane], mark: (frame) => { marked(frame); told.push('mark'); } });
    session.view.registerPlugin({ name: 'shades', shade: () => { told.push('shade'); } });
    session.view.registerPlugin(plugin);
    const draw = (): void => { session.view.draw(RENDERER, new Scene(), new PerspectiveCamera()); };
    draw();
    expect(told).toEqual(['shade', 'mark']);
    plugin.isPainter = true;
    draw();
    expect(told).toEqual(['shade', 'mark', 'mark']);
    expect(session.view.plugins.cuts).toEqual([plane]);
  });

  it('is on a stage, whichever was there first', () => {
    session.view.registerPlugin(plugin);
    expect(plugin.told).toEqual(['init plain']);
    const stage = { view: session.view } as Stage;
    session.view.plugins.enter(stage);
    expect(plugin.told.at(-1)).toBe('enter plain');
    session.view.unregisterPlugin(plugin);
    session.view.registerPlugin(plugin);
    expect(plugin.told.slice(-2)).toEqual(['init plain', 'enter plain']);
  });

  it('says what is kept and what is its own', () => {
    const { plugins } = session.view;
    expect([plugins.keeps(new Vector3(-1, 0, 0)), plugins.tapped(1, 0)]).toEqual([true, false]);
    session.view.registerPlugin(plugin);
    expect([plugins.keeps(new Vector3(1, 0, 0)), plugins.keeps(new Vector3(-1, 0, 0))]).toEqual([true, false]);
    expect([plugins.tapped(1, 0), plugins.tapped(0, 1)]).toEqual([true, false]);
  });

  it('has a name that no other has, and leaves with the view', () => {
    session.view.registerPlugin(plugin);
    expect(() => session.view.registerPlugin(new Stranger())).toThrow('"stranger"');
    expect(session.view.plugins.named('stranger')).toBe(plugin);
    expect(session.view.plugins.named('relief')).toBeDefined();
    session.view.unregisterPlugin(new Stranger());
    expect(session.view.plugins.named('stranger')).toBe(plugin);
    session.view.dispose();
    expect(plugin.told.at(-1)).toBe('dispose');
  });

  it('shades after those that came before it, and after the view itself', async () => {
    session.view.setLook({ colours: 'height' });
    const adding = (name: string): Plugin => ({
      name, shading: { uniforms: {}, key: () => name, edit: (shader) => { replaceChunk(shader, 'fragmentShader', 'color_fragment', `#include <color_fragment>\n// ${name}`); } },
    });
    for (const name of ['first', 'second']) session.view.registerPlugin(adding(name));
    await session.frame();
    const { fragmentShader } = compiled(session.meshes()[0]);
    const places = ['#include <color_fragment>', 'float step_', '// first', '// second'].map((text) => fragmentShader.indexOf(text));
    expect(places).toEqual([...places].sort((a, b) => a - b));
    expect(places[0]).toBeGreaterThanOrEqual(0);
  });

  it('is not taken for another one of the same name and key', async () => {
    const striped = (width: number): Plugin => ({
      name: 'stripes', shading: { uniforms: { width: { value: width } }, key: () => 'striped', edit: (shader) => { shader.fragmentShader += String(width); } },
    });
    const [thin, wide] = [striped(1), striped(2)];
    session.view.registerPlugin(thin);
    await session.frame();
    const before = session.meshes()[0].material as Material;
    session.view.unregisterPlugin(thin);
    session.view.registerPlugin(wide);
    await session.frame();
    const after = session.meshes()[0].material as Material;
    expect(after.customProgramCacheKey()).not.toBe(before.customProgramCacheKey());
    expect(compiled(session.meshes()[0]).uniforms.width).toBe(wide.shading!.uniforms.width);
  });

  it.each(['key', 'edit', 'parameters', 'show', 'prepare'] as const)('is left out of the shading once its %s throws, and told once', async (what) => {
    const told = vi.fn();
    vi.stubGlobal('reportError', told);
    const before = (session.meshes()[0].material as Material).customProgramCacheKey();
    const half = (shader: Shader): never => {
      shader.fragmentShader += '// half';
      return refuse();
    };
    const bad: Plugin = { name: 'bad', shading: { uniforms: {}, key: () => 'bad', edit: () => undefined, [what]: what === 'edit' ? half : refuse } };
    session.view.registerPlugin(bad).registerPlugin(plugin);
    for (let i = 0; i < 2; ++i) {
      await session.frame();
      for (const mesh of session.meshes()) expect(compiled(mesh).fragmentShader).toMatch(/^(?!.*half).*fract\(stripes\)/s);
    }
    expect(await session.frame()).toBe(false);
    expect(told).toHaveBeenCalledOnce();
    session.view.unregisterPlugin(plugin);
    await session.frame();
    expect((session.meshes()[0].material as Material).customProgramCacheKey()).toBe(before);
    session.view.unregisterPlugin(bad);
    session.view.registerPlugin(bad);
    await session.frame();
    compiled(session.meshes()[0]);
    expect(told).toHaveBeenCalledTimes(2); // it has another try
    vi.unstubAllGlobals();
  });
});

describe('a plug-in that throws', () => {
  const told = vi.fn();
  const changed = vi.fn();
  const frame = { renderer: RENDERER, scene: new Scene(), camera: new PerspectiveCamera() };
  const stage = {} as StageOf<object>;
  let plugins: Plugins<object>;
  beforeEach(() => {
    for (const mock of [told, changed, render]) mock.mockReset();
    vi.stubGlobal('reportError', told);
    plugins = new Plugins<object>({}, changed);
  });
  afterEach(() => { vi.unstubAllGlobals(); });

  it('keeps no other from leaving', () => {
    const dispose = vi.fn();
    for (const each of [{ name: 'bad', dispose: refuse }, { name: 'worse', dispose: refuse }, { name: 'good', dispose }]) plugins.register(each);
    plugins.unregister(plugins.named('bad')!);
    expect([plugins.named('bad'), told.mock.calls.length, changed.mock.calls.length]).toEqual([undefined, 1, 4]);
    plugins.dispose();
    expect([told.mock.calls.length, dispose.mock.calls.length]).toEqual([2, 1]);
  });

  it('is told on the console where errors are reported nowhere else', () => {
    vi.stubGlobal('reportError', undefined);
    const error = vi.spyOn(console, 'error').mockImplementation(() => undefined);
    plugins.register({ name: 'bad', dispose: refuse });
    plugins.dispose();
    expect(error).toHaveBeenCalledOnce();
    error.mockRestore();
  });

  it('is not there when it cannot begin', () => {
    const dispose = vi.fn();
    expect(() => { plugins.register({ name: 'bad', init: refuse, dispose }); }).toThrow('no');
    plugins.register({ name: 'bad', enter: refuse, dispose });
    plugins.enter(stage);
    expect([plugins.named('bad'), told.mock.calls.length]).toEqual([undefined, 1]);
    expect(() => { plugins.register({ name: 'bad', enter: refuse, dispose }); }).toThrow('no');
    expect([plugins.named('bad'), dispose.mock.calls.length]).toEqual([undefined, 3]);
  });

  it('is asked again when it comes anew, also where it left as it threw', () => {
    const drawn = vi.fn(() => {
      plugins.unregister(bad);
      refuse();
    });
    const bad = { name: 'bad', drawn };
    for (let i = 0; i < 2; ++i) {
      plugins.register(bad);
      plugins.drawn(frame);
    }
    expect([drawn.mock.calls.length, told.mock.calls.length]).toEqual([2, 2]);
  });

  it('is asked nothing once another one has taken it away', () => {
    const drawn = vi.fn();
    const other = { name: 'other', drawn };
    plugins.register({ name: 'first', drawn: () => { plugins.unregister(other); } });
    plugins.register(other);
    plugins.drawn(frame);
    expect([drawn.mock.calls.length, told.mock.calls.length]).toEqual([0, 0]);
  });

  it('is told once, and no longer asked to draw', () => {
    const shade = vi.fn();
    const drawn = vi.fn();
    const bad = { name: 'bad', paint: vi.fn(refuse), shade: vi.fn(refuse), drawn };
    for (const each of [bad, { name: 'good', shade, drawn }]) plugins.register(each);
    for (let i = 0; i < 2; ++i) {
      plugins.paint(frame);
      plugins.drawn(frame);
    }
    expect([bad.paint, bad.shade, told, render, shade, drawn].map(({ mock }) => mock.calls.length)).toEqual([1, 1, 2, 2, 2, 4]);
    plugins.unregister(bad);
    plugins.register(bad);
    plugins.paint(frame);
    expect(bad.paint).toHaveBeenCalledTimes(2); // it has another try
  });

  it('keeps what others keep, and takes no taps', () => {
    const bad = { name: 'bad', keeps: vi.fn(refuse), tapped: vi.fn(refuse) };
    for (const each of [bad, { name: 'good', keeps: ({ x }: Vector3) => x > 0, tapped: (right: number) => right > 0 }]) plugins.register(each);
    expect([1, -1].map((x) => [plugins.keeps(new Vector3(x, 0, 0)), plugins.tapped(x, 0)])).toEqual([[true, true], [false, false]]);
    expect([bad.keeps, bad.tapped, told].map(({ mock }) => mock.calls.length)).toEqual([1, 1, 2]);
  });

  it('enters once, whoever brings it or takes it away', () => {
    const [enter, gone] = [vi.fn(), vi.fn()];
    const leaving = { name: 'leaving', enter: gone };
    plugins.register({ name: 'bringer', enter: () => {
      plugins.register({ name: 'brought', enter });
      plugins.unregister(leaving);
    } });
    plugins.register(leaving);
    plugins.enter(stage);
    expect([enter.mock.calls.length, gone.mock.calls.length]).toEqual([1, 0]);
    plugins.dispose();
    plugins.register({ name: 'late', enter });
    expect(enter).toHaveBeenCalledTimes(1); // there is no stage any more
  });
});
