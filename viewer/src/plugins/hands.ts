// SPDX-License-Identifier: MIT
// A visitor's hands move a model in the room: one that grabs moves it, two turn and resize it; sticks turn and resize it;
// a finger on a phone's screen turns it.
import { Vector3 } from 'three';
import type { Placement } from './placement.js';

const TURN = 1.6; // radians a second, with a stick
const RESIZE = 1.2; // of a factor's logarithm, a second
const TOUCH_TURN = 1.5; // radians from the middle of a screen to its side
const LEAST = 0.15; // of a stick: less is its rest
const LONGEST_STEP = 0.1; // seconds

interface Grip {
  readonly at: Vector3;
  readonly touch: readonly number[] | null;
}

function stickOf({ gamepad }: XRInputSource): readonly [number, number] {
  const axes = gamepad?.axes ?? [];
  const [x, y] = axes.length >= 4 ? [axes[2], axes[3]] : [0, 0];
  return [Math.abs(x) < LEAST ? 0 : x, Math.abs(y) < LEAST ? 0 : y];
}

function grabs({ gamepad, targetRayMode }: XRInputSource): boolean {
  return targetRayMode === 'screen' || (gamepad?.buttons.slice(0, 2).some(({ pressed }) => pressed) ?? false);
}

export class Hands {
  private before = new Map<XRInputSource, Grip>();
  private time: number | null = null;

  constructor(private readonly placement: Placement) {}

  /// `space`: the room's. `now`: milliseconds.
  step(frame: XRFrame, space: XRReferenceSpace, now: number): void {
    const seconds = Math.min((now - (this.time ?? now)) / 1000, LONGEST_STEP);
    this.time = now;
    const sources = [...frame.session.inputSources];
    for (const source of sources) {
      const [x, y] = stickOf(source);
      this.placement.turn(x * TURN * seconds);
      this.placement.resize(Math.exp(-y * RESIZE * seconds));
    }
    const grips = new Map(sources.filter(grabs).flatMap((source) => {
      const position = frame.getPose(source.gripSpace ?? source.targetRaySpace, space)?.transform.position;
      const touch = source.targetRayMode === 'screen' ? [...(source.gamepad?.axes ?? [])] : null;
      return position === undefined ? [] : [[source, { at: new Vector3(position.x, position.y, position.z), touch }] as const];
    }));
    this.pull(grips);
    this.before = grips;
  }

  private pull(grips: ReadonlyMap<XRInputSource, Grip>): void {
    const held = [...grips].flatMap(([source, now]) => {
      const before = this.before.get(source);
      return before === undefined ? [] : [{ before, now }];
    });
    if (held.length === 1) this.pullOne(held[0].before, held[0].now);
    else if (held.length > 1) this.pullTwo(held[0], held[1]);
  }

  private pullOne(before: Grip, now: Grip): void {
    if (before.touch !== null && now.touch !== null) this.placement.turn(TOUCH_TURN * ((now.touch[0] ?? 0) - (before.touch[0] ?? 0)));
    else this.placement.move(now.at.clone().sub(before.at));
  }

  private pullTwo(one: { before: Grip; now: Grip }, other: { before: Grip; now: Grip }): void {
    const [was, is] = [other.before.at.clone().sub(one.before.at), other.now.at.clone().sub(one.now.at)];
    const [middle, middleNow] = [one.before.at.clone().lerp(other.before.at, 0.5), one.now.at.clone().lerp(other.now.at, 0.5)];
    this.placement.move(middleNow.sub(middle));
    if (was.length() > 0 && is.length() > 0) this.placement.resize(is.length() / was.length());
    this.placement.turn(Math.atan2(is.x, is.z) - Math.atan2(was.x, was.z));
  }
}
