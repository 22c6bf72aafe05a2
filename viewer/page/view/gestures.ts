// SPDX-License-Identifier: MIT
// Mouse, pen, touch and wheel, as movements of the camera.
import { TAP_REACH, Taps } from '../../src/taps.js';
import type { Navigation } from './navigation.js';

const TURN = Math.PI; // radians for a drag along the picture's height
const WHEEL = 0.0016; // of a factor's logarithm, a pixel of the wheel
const MOST_WHEEL = 200;
const LINE = 32; // pixels, where wheels count lines
const NEW_GRAB = 250; // milliseconds without a turn of the wheel
const AGAIN = { reach: 24, pause: 400 }; // pixels and milliseconds between two taps

interface Finger {
  x: number;
  y: number;
}

/// The logarithm of a factor, of fingers whose spread changes; none where they meet, or are one finger.
export function zoomOfSpread(before: number, now: number): number {
  return before > 0 && now > 0 ? Math.log(before / now) : 0;
}

export class Gestures {
  private readonly fingers = new Map<number, Finger>();
  private panning = false;
  private wheeled = { at: -Infinity, x: 0, y: 0 };
  private tap = { at: -Infinity, x: 0, y: 0 };
  private readonly taps = new Taps();

  constructor(
    private readonly surface: HTMLElement,
    private readonly navigation: Pick<Navigation, 'grab' | 'grabMiddle' | 'move' | 'approach'>,
    /// A place of the picture was tapped, from -1 to 1; true: that is all.
    private readonly takes: (right: number, up: number) => boolean = () => false,
    /// A drag, in radians; true: it is none of the camera.
    private readonly takesDrag: (right: number, up: number) => boolean = () => false,
  ) {
    surface.addEventListener('pointerdown', (event) => { this.down(event); });
    surface.addEventListener('pointermove', (event) => { this.drag(event); });
    surface.addEventListener('pointerup', (event) => { this.lift(event); });
    surface.addEventListener('pointercancel', (event) => { this.release(event); });
    surface.addEventListener('wheel', (event) => { this.wheel(event); }, { passive: false });
    surface.addEventListener('contextmenu', (event) => { event.preventDefault(); });
  }

  /// To the right and up, from -1 to 1.
  private placeOf({ x, y }: Finger): [number, number] {
    const { left, top, width, height } = this.surface.getBoundingClientRect();
    return [((x - left) / width) * 2 - 1, 1 - ((y - top) / height) * 2];
  }

  private grab(finger: Finger): void {
    this.navigation.grab(...this.placeOf(finger));
  }

  private middle(): Finger {
    const all = [...this.fingers.values()];
    const sum = all.reduce((a, b) => ({ x: a.x + b.x, y: a.y + b.y }));
    return { x: sum.x / all.length, y: sum.y / all.length };
  }

  /// Adds up the fingers' distances from their middle.
  private spread(): number {
    const { x, y } = this.middle();
    return [...this.fingers.values()].reduce((sum, finger) => sum + Math.hypot(finger.x - x, finger.y - y), 0);
  }

  private down(event: PointerEvent): void {
    if (this.fingers.size >= 2) return;
    this.surface.focus({ preventScroll: true });
    this.surface.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.taps.down(event);
    this.panning = this.fingers.size > 1 || event.button !== 0 || event.shiftKey;
    if (this.panning) this.grab(this.middle());
    else this.navigation.grabMiddle();
  }

  private drag(event: PointerEvent): void {
    const finger = this.fingers.get(event.pointerId);
    if (finger === undefined) return;
    const [middle, spread] = [this.middle(), this.spread()];
    this.taps.move(event);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const now = this.middle();
    const height = this.surface.clientHeight;
    const [right, up] = [(now.x - middle.x) / height, (middle.y - now.y) / height];
    if (this.takesDrag(right * TURN, up * TURN)) return;
    if (!this.panning) this.navigation.move({ turnRight: -right * TURN, turnUp: -up * TURN });
    else this.navigation.move({ panRight: -right, panUp: -up, zoom: zoomOfSpread(spread, this.spread()) });
  }

  /// A finger that stays turns.
  private release(event: PointerEvent): void {
    this.taps.cancel(event);
    if (!this.fingers.delete(event.pointerId) || this.fingers.size === 0) return;
    this.panning = false;
    this.navigation.grabMiddle();
  }

  private lift(event: PointerEvent): void {
    const isTap = this.taps.lift(event);
    this.release(event);
    if (isTap) this.tapped(event);
  }

  /// The second one at a place flies there.
  private tapped({ timeStamp, clientX: x, clientY: y }: PointerEvent): void {
    if (this.takes(...this.placeOf({ x, y }))) return;
    const again = timeStamp - this.tap.at < AGAIN.pause && Math.hypot(x - this.tap.x, y - this.tap.y) < AGAIN.reach;
    this.tap = { at: again ? -Infinity : timeStamp, x, y };
    if (again) this.navigation.approach(...this.placeOf({ x, y }));
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const { clientX: x, clientY: y, timeStamp: at } = event;
    const elsewhere = Math.hypot(x - this.wheeled.x, y - this.wheeled.y) > TAP_REACH;
    if (elsewhere || at - this.wheeled.at > NEW_GRAB) this.grab({ x, y });
    this.wheeled = { at, x, y };
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE : 1) * (event.ctrlKey ? 5 : 1);
    this.navigation.move({ zoom: Math.min(Math.max(pixels, -MOST_WHEEL), MOST_WHEEL) * WHEEL });
  }
}
