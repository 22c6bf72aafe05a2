// SPDX-License-Identifier: MIT
// Shows a model as it was chosen; what was left to the page is chosen here, by what the model is.
import type { HierarchyView, Look, Terrain } from '../../src/index.js';
import { LIGHTS, type Appearance, type Light } from '../appearance.js';
import { keyOf, turned, type Angles, type Lighting, type Rig } from './lighting.js';

/// Slopes that show well: those of hills are shaded so steep.
const SHOWN_SLOPE = 0.5;
const MOST_RELIEF = 1000;

/// What is shown of what was chosen.
export interface Shown {
  look: Look;
  rig: Rig;
  key: Angles;
}

type Model = Pick<HierarchyView, 'terrain' | 'hasColours' | 'hasTriangles' | 'hasAttributes'>;

function rigOf({ name }: Light, terrain: Terrain | null): Rig {
  if (name === 'matcap') return 'studio';
  return name === 'auto' ? (terrain?.upright === true ? 'sun' : 'studio') : name;
}

function reliefOf({ slope }: Terrain, stretch: number): number {
  return Math.min(Math.max(SHOWN_SLOPE / Math.max(slope * stretch, 1e-9), 1), MOST_RELIEF);
}

/// What has no colours of its own is plain: white shows no form. But terrains are coloured by height, and under the sun, or seen from their front, their slopes are shaded steeper.
export function shownOf({ look, light, standing }: Appearance, { terrain, hasColours, hasTriangles, hasAttributes }: Model): Shown {
  const rig = rigOf(light, terrain);
  const wished = look.colours === 'attribute' && hasAttributes === false ? 'vertex' : look.colours;
  const colours = wished === 'vertex' && hasColours === false ? (terrain === null ? 'plain' : 'height') : wished;
  const isSteep = terrain !== null && (rig === 'sun' || !terrain.upright);
  const relief = isSteep ? reliefOf(terrain, terrain.upright ? standing.stretch : 1) : 1;
  const key = light.key === null ? keyOf(rig) : { right: light.key[0], up: light.key[1] };
  const points = look.points || hasTriangles === false; // nothing else shows those
  return { look: { ...look, colours, points, relief, material: light.name === 'matcap' ? 'matcap' : 'lit' }, rig, key };
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
  ) {}

  get shown(): Shown {
    return shownOf(this.chosen, this.view);
  }

  /// Also when more is known of the model than before.
  apply(): void {
    const { look, rig, key } = this.shown;
    if (!isSame(look, this.view.look)) this.view.setLook(look);
    if (!isSame(this.chosen.standing, this.view.standing)) this.view.setStanding(this.chosen.standing);
    this.lighting.set(rig, key);
  }

  /// The chosen light, its key turned by radians to the right and up.
  turnedLight(by: Angles): Light {
    const { right, up } = turned(this.shown.key, by);
    return { ...this.chosen.light, key: [right, up] };
  }
}
