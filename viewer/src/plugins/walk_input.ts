// SPDX-License-Identifier: MIT
// What somebody who walks does with keys, pointers and a gamepad. While it listens, nothing of that comes to what else listens to the stage.
import type { Stage } from '../scene/hierarchy_view.js';
import { Taps } from '../taps.js';
import { isTyped } from '../typing.js';

/// Parts of the whole speed, from -1 to 1.
export interface Wish {
  readonly forward: number;
  readonly right: number;
  readonly turnRight: number;
  readonly lookUp: number;
  readonly isRunning: boolean;
}

export interface WalkOrders {
  /// A wish is another one, or a gamepad came.
  wake(): void;
  /// The picture was dragged by parts of its height.
  drag(right: number, up: number): void;
  /// A place of the picture, from -1 to 1.
  tap(right: number, up: number): void;
  /// Null: the mouse has left.
  hover(place: readonly [number, number] | null): void;
  leave(): void;
}

/// Keys by where they lie, whatever letters are on them.
const KEYS: Readonly<Record<string, Partial<Record<Exclude<keyof Wish, 'isRunning'>, number>>>> = {
  KeyW: { forward: 1 }, KeyS: { forward: -1 }, KeyA: { right: -1 }, KeyD: { right: 1 },
  ArrowUp: { forward: 1 }, ArrowDown: { forward: -1 }, ArrowLeft: { turnRight: -1 }, ArrowRight: { turnRight: 1 },
  PageUp: { lookUp: 1 }, PageDown: { lookUp: -1 },
};
const STICK = 0.12; // parts of the picture's height: two fingers that far from where they began go at whole speed
const WHEEL = 250; // milliseconds that a turn of the wheel goes on
const REST = 0.15; // of a gamepad's stick
const [RUN_BUTTONS, LEAVE_BUTTON] = [[7, 10], 1];

function within(value: number): number {
  return Math.min(Math.max(value, -1), 1);
}

function stick(value: number | undefined): number {
  return value === undefined || Math.abs(value) < REST ? 0 : value;
}

/// The first gamepad whose sticks are known; null: there is none.
export function gamepad(): Gamepad | null {
  const pads = (globalThis.navigator as Navigator | undefined)?.getGamepads?.() ?? [];
  return pads.find((pad) => pad?.mapping === 'standard' && pad.connected) ?? null;
}

export class WalkInput {
  private readonly keys = new Set<string>();
  private readonly fingers = new Map<number, { x: number; y: number }>();
  private readonly taps = new Taps();
  private begun: { x: number; y: number } | null = null; // of two fingers
  private isShifted = false;
  private wheel = { direction: 0, until: 0 };
  private readonly ending = new AbortController();

  constructor(private readonly stage: Stage, private readonly orders: WalkOrders) {
    const root = stage.root as unknown as EventTarget;
    const { signal } = this.ending;
    const listen = (kind: string, heard: (event: Event) => void): void => {
      root.addEventListener(kind, (event) => { if (event.composedPath().includes(stage.surface)) heard(event); }, { signal, capture: true, passive: false });
    };
    listen('pointerdown', (event) => { this.down(event as PointerEvent); });
    listen('pointermove', (event) => { this.move(event as PointerEvent); });
    listen('pointerup', (event) => { this.lift(event as PointerEvent); });
    listen('pointercancel', (event) => { this.release(event as PointerEvent); });
    listen('pointerleave', () => { orders.hover(null); });
    listen('wheel', (event) => { this.turnWheel(event as WheelEvent); });
    window.addEventListener('keydown', (event) => { this.press(event); }, { signal, capture: true });
    window.addEventListener('keyup', (event) => { this.raise(event); }, { signal, capture: true });
    window.addEventListener('blur', () => { this.keys.clear(); }, { signal });
    window.addEventListener('gamepadconnected', () => { orders.wake(); }, { signal });
  }

  stop(): void {
    this.ending.abort();
  }

  /// `now`: as performance.now() has it.
  wish(now: number): Wish {
    const sum = { forward: 0, right: 0, turnRight: 0, lookUp: 0 };
    for (const key of this.keys) for (const [name, part] of Object.entries(KEYS[key])) sum[name as keyof typeof sum] += part;
    const [right, forward] = this.dragged();
    const pad = gamepad();
    if (pad?.buttons[LEAVE_BUTTON]?.pressed === true) this.orders.leave();
    return {
      forward: within(sum.forward + forward + (now < this.wheel.until ? this.wheel.direction : 0) - stick(pad?.axes[1])),
      right: within(sum.right + right + stick(pad?.axes[0])),
      turnRight: within(sum.turnRight + stick(pad?.axes[2])),
      lookUp: within(sum.lookUp - stick(pad?.axes[3])),
      isRunning: this.isShifted || RUN_BUTTONS.some((button) => pad?.buttons[button]?.pressed === true),
    };
  }

  /// How far two fingers are from where they began, to the right and up.
  private dragged(): [number, number] {
    if (this.begun === null || this.fingers.size < 2) return [0, 0];
    const { x, y } = this.middle();
    const whole = STICK * this.stage.surface.clientHeight;
    return [(x - this.begun.x) / whole, (this.begun.y - y) / whole];
  }

  private middle(): { x: number; y: number } {
    const all = [...this.fingers.values()];
    return { x: all.reduce((sum, { x }) => sum + x, 0) / all.length, y: all.reduce((sum, { y }) => sum + y, 0) / all.length };
  }

  private placeOf({ clientX, clientY }: PointerEvent): [number, number] {
    const { left, top, width, height } = this.stage.surface.getBoundingClientRect();
    return [((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2];
  }

  private down(event: PointerEvent): void {
    event.stopPropagation();
    const { surface } = this.stage;
    surface.focus({ preventScroll: true });
    surface.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.taps.down(event);
    this.begun = this.fingers.size === 2 ? this.middle() : null;
    this.orders.hover(null);
  }

  private move(event: PointerEvent): void {
    event.stopPropagation();
    const before = this.fingers.get(event.pointerId);
    if (before === undefined) {
      if (event.pointerType === 'mouse') this.orders.hover(this.placeOf(event));
      return;
    }
    this.taps.move(event);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const height = this.stage.surface.clientHeight;
    if (this.fingers.size === 1) this.orders.drag((event.clientX - before.x) / height, (before.y - event.clientY) / height);
    else this.orders.wake();
  }

  private lift(event: PointerEvent): void {
    const isTap = this.taps.lift(event);
    this.release(event);
    if (isTap) this.orders.tap(...this.placeOf(event));
  }

  private release(event: PointerEvent): void {
    event.stopPropagation();
    this.taps.cancel(event);
    this.fingers.delete(event.pointerId);
    this.begun = null;
  }

  /// Forwards and back.
  private turnWheel(event: WheelEvent): void {
    event.preventDefault();
    event.stopPropagation();
    this.wheel = { direction: event.deltaY < 0 ? 1 : -1, until: performance.now() + WHEEL };
    this.orders.wake();
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || isTyped(event)) return;
    this.isShifted = event.shiftKey;
    if (event.key === 'Escape') this.orders.leave();
    else if (Object.hasOwn(KEYS, event.code)) this.keys.add(event.code);
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.orders.wake();
  }

  private raise({ code, shiftKey }: KeyboardEvent): void {
    this.isShifted = shiftKey;
    this.keys.delete(code);
  }
}
