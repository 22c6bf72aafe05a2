// SPDX-License-Identifier: MIT
// The light of the picture: a key, a fill and a rim, and the sky. They go with the camera; the sun stays where it is.
import { DirectionalLight, Group, HemisphereLight, type Camera, type Object3D } from 'three';

/// `sun`: from the northwest of the model, as maps have it.
export type Rig = 'studio' | 'raking' | 'flat' | 'sun';

/// Radians to the right and up: from the camera, or of the sun from the south.
export interface Angles {
  readonly right: number;
  readonly up: number;
}

interface Setup {
  readonly key: Angles & { readonly strength: number };
  readonly fill: number;
  readonly rim: number;
  readonly sky: number;
  /// Light from below, as a part of the light from above.
  readonly ground: number;
}

const SETUPS: Readonly<Record<Rig, Setup>> = {
  studio: { key: { right: -0.75, up: 0.7, strength: 2.9 }, fill: 0.35, rim: 1.1, sky: 1.25, ground: 0.42 },
  raking: { key: { right: -1.4, up: 0.2, strength: 3.6 }, fill: 0, rim: 0, sky: 0.4, ground: 0.6 },
  flat: { key: { right: 0, up: 0.1, strength: 0.7 }, fill: 0, rim: 0, sky: 2.6, ground: 0.9 },
  sun: { key: { right: -2.36, up: 0.79, strength: 3 }, fill: 0, rim: 0, sky: 1.1, ground: 0.7 },
};

const FILL: Angles = { right: 1.1, up: 0.05 };
const RIM: Angles = { right: 2.3, up: 0.45 };
const [WARM, COOL, SKY] = [0xfff4e4, 0xd4e2ff, 0xf1f5ff];
/// From behind and from below nothing is lit that can be seen.
const MOST = { right: Math.PI, up: 1.5 };

function place(light: Object3D, { right, up }: Angles): void {
  light.position.set(Math.sin(right) * Math.cos(up), Math.sin(up), Math.cos(right) * Math.cos(up));
}

function within(value: number, most: number): number {
  return Math.min(Math.max(value, -most), most);
}

export function turned({ right, up }: Angles, by: Angles): Angles {
  return { right: within(right + by.right, MOST.right), up: within(up + by.up, MOST.up) };
}

export function keyOf(rig: Rig): Angles {
  const { right, up } = SETUPS[rig].key;
  return { right, up };
}

export class Lighting {
  private readonly key = new DirectionalLight(WARM);
  private readonly fill = new DirectionalLight(COOL);
  private readonly rim = new DirectionalLight(COOL);
  private readonly sky = new HemisphereLight(SKY);
  private readonly withCamera = new Group();

  constructor(
    private readonly scene: Object3D,
    camera: Camera,
  ) {
    camera.add(this.withCamera);
    scene.add(this.sky);
    for (const light of [this.key, this.fill, this.rim]) this.withCamera.add(light, light.target);
    place(this.fill, FILL);
    place(this.rim, RIM);
    this.set('studio', keyOf('studio'));
  }

  /// `key`: where it comes from.
  set(rig: Rig, key: Angles): void {
    const setup = SETUPS[rig];
    (rig === 'sun' ? this.scene : this.withCamera).add(this.key, this.key.target);
    place(this.key, key);
    this.key.intensity = setup.key.strength;
    this.fill.intensity = setup.fill;
    this.rim.intensity = setup.rim;
    this.sky.intensity = setup.sky;
    this.sky.groundColor.set(0xffeedd).multiplyScalar(setup.ground);
  }
}
