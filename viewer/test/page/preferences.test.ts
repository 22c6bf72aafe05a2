// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { HierarchyView } from '../../src/index.js';
import { parsePreferences } from '../../page/preferences.js';

const DEFAULTS = parsePreferences(null);

describe('preferences', () => {
  it('have defaults', () => {
    expect(DEFAULTS.settings).toEqual({ framesPerSecond: 30, threshold: 1, restDetail: 8, memoryBudget: 256e6 });
    expect(DEFAULTS).toMatchObject({ theme: 'auto', language: null });
  });

  it("have the library's defaults", () => {
    const view = new HierarchyView('http://host/a.hier', { fetch: () => Promise.reject(new Error('no host')) });
    expect(DEFAULTS).toMatchObject({ settings: view.settings, look: view.look });
    view.dispose();
  });

  it('come back as they were stored', () => {
    const chosen = {
      theme: 'dark',
      language: 'es',
      order: 'newest',
      panel: true,
      settings: { framesPerSecond: 60, threshold: 2.5, restDetail: 1, memoryBudget: 512e6 },
      look: { colours: 'error', texture: false, relight: true, material: 'lit', relief: 1, cavities: false, shading: 'flat', wires: true, points: true, outline: true, attribute: 'quality', ramp: 'turbo', range: [1, 2], tolerance: null, isolines: true, hidden: [3] },
      light: { name: 'raking', key: [0.5, 0.25], occlusion: true },
      standings: { 'http://host/a.hier': { up: 'z', stretch: 3 } },
    };
    expect(parsePreferences(JSON.stringify(chosen))).toEqual(chosen);
  });

  it.each(['', 'x', 'null', '[]', '7', '{"settings":null,"look":[]}', '{"theme":"pink","language":"tlh","order":"toString","settings":{"framesPerSecond":-1,"threshold":"1","memoryBudget":1e99},"look":{"colours":7,"wires":"yes"}}'])(
    'are the defaults where %s is stored',
    (text) => { expect(parsePreferences(text)).toEqual(DEFAULTS); },
  );
});
