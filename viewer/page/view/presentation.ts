// SPDX-License-Identifier: MIT
// Shows a model as it was chosen; what was left open is chosen by what the model is.
import type { HierarchyView, Look } from '../../src/index.js';
import { materialOf, rigOf, shownLook, type KnownModel } from '../../src/scene/shown_look.js';
import { LIGHTS, type Appearance, type Light } from '../appearance.js';
import { keyOf, turned, type Angles, type Lighting, type Rig } from '../../src/scene/lighting.js';

/// This is shown of what was chosen.
export interface ShownAppearance {
  look: Look;
  rig: Rig;
  key: Angles;
}

export function shownOf({ look, light, standing }: Pick<Appearance, 'look' | 'light' | 'standing'>, model: KnownModel): ShownAppearance {
  const rig = rigOf(light.name, model);
  const key = light.key === null ? keyOf(rig) : { right: light.key[0], up: light.key[1] };
  return { look: { ...shownLook(look, rig, standing.stretch, model), material: materialOf(light.name) }, rig, key };
}

function isSame(a: object, b: object): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}

export function nextLight(light: Light): Light {
  return { ...light, name: LIGHTS[(LIGHTS.indexOf(light.name) + 1) % LIGHTS.length], key: null };
}

export class Presentation {
  constructor(
    private readonly view: HierarchyView,
    private readonly lighting: Lighting,
    public chosen: Appearance,
    /// Shown instead of what was chosen.
    public over: Partial<Look> | null = null,
  ) {}

  get shown(): ShownAppearance {
    return shownOf(this.chosen, this.view);
  }

  /// Also when more is known of the model than before.
  apply(): void {
    const { look: wished, rig, key } = this.shown;
    const look = { ...wished, ...this.over };
    if (!isSame(look, this.view.look)) this.view.setLook(look);
    if (!isSame(this.chosen.standing, this.view.standing)) this.view.setStanding(this.chosen.standing);
    if (this.chosen.level !== this.view.mostLevel) this.view.mostLevel = this.chosen.level;
    this.lighting.set(rig, key);
  }

  /// The chosen light, its key turned by radians to the right and up.
  turnedLight(by: Angles): Light {
    const { right, up } = turned(this.shown.key, by);
    return { ...this.chosen.light, key: [right, up] };
  }
}
