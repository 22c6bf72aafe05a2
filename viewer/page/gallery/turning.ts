// SPDX-License-Identifier: MIT
// How an outline is turned: by itself, by a drag across it, and by the arrow keys; and when there is one to be turned.
import { dragged, USUAL_TURN, type Turn } from './layout.js';

const CLICK_REACH = 6; // pixels that a click may move
const KEY_STEP = 0.2;
const KEYS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const INTENT = 120; // milliseconds that a pointer stays: one that passes by means nothing

export interface Turned {
  /// It is pointed at or focused, or no longer.
  enlivened(lively: boolean): void;
  /// It is to be drawn from another side.
  turned(): void;
}

export class Turning {
  turn: Turn = USUAL_TURN;
  private first: Turn = USUAL_TURN;
  private byHand = false; // and not by itself
  private held: { pointer: number; x: number; y: number } | null = null;
  private distance = 0; // of the last drag, in pixels
  private readonly reasons = new Set<'pointer' | 'focus'>();
  private timer = 0;

  /// A drag on `link` is no click.
  constructor(link: HTMLElement, private readonly stage: HTMLElement, private readonly turned: Turned) {
    link.addEventListener('pointerdown', (event) => { this.grab(event, link); });
    link.addEventListener('pointermove', (event) => { this.drag(event, link); });
    for (const type of ['pointerup', 'pointercancel'] as const) link.addEventListener(type, () => { this.release(); });
    link.addEventListener('click', (event) => { this.click(event); });
    link.addEventListener('dragstart', (event) => { event.preventDefault(); });
    link.addEventListener('keydown', (event) => { this.key(event); });
    link.addEventListener('pointerenter', () => { this.timer = window.setTimeout(() => { this.enliven('pointer'); }, INTENT); });
    link.addEventListener('pointerleave', () => { this.calm('pointer'); });
    link.addEventListener('focus', () => { this.enliven('focus'); });
    link.addEventListener('blur', () => { this.calm('focus'); });
  }

  /// It is pointed at, or focused.
  get lively(): boolean {
    return this.reasons.size > 0;
  }

  /// The side that is seen first is known now; an outline that was turned by hand stays.
  start(first: Turn): void {
    this.first = first;
    if (!this.byHand) this.turn = first;
  }

  /// Turns it by an angle, unless it is held.
  advance(angle: number): void {
    if (this.held === null) this.turn = { ...this.turn, yaw: this.turn.yaw + angle };
  }

  private enliven(reason: 'pointer' | 'focus'): void {
    this.reasons.add(reason);
    this.turned.enlivened(true);
  }

  private calm(reason: 'pointer' | 'focus'): void {
    window.clearTimeout(this.timer);
    if (!this.reasons.delete(reason)) return;
    if (!this.lively) this.rest();
    this.turned.enlivened(this.lively);
  }

  private rest(): void {
    this.turn = this.first;
    this.byHand = false;
  }

  private turnBy(x: number, y: number, width: number): void {
    this.turn = dragged(this.turn, x, y, width);
    this.byHand = true;
    this.turned.turned();
  }

  private grab(event: PointerEvent, link: HTMLElement): void {
    if (!event.isPrimary || event.button !== 0) return;
    this.distance = 0;
    this.held = { pointer: event.pointerId, x: event.clientX, y: event.clientY };
    if (event.pointerType !== 'touch') link.focus({ preventScroll: true });
  }

  private drag(event: PointerEvent, link: HTMLElement): void {
    const { held } = this;
    if (held?.pointer !== event.pointerId) return;
    const [x, y] = [event.clientX - held.x, event.clientY - held.y];
    this.held = { ...held, x: event.clientX, y: event.clientY };
    this.distance += Math.hypot(x, y);
    if (this.distance > CLICK_REACH) link.setPointerCapture(event.pointerId);
    this.turnBy(x, y, this.stage.clientWidth);
  }

  private release(): void {
    this.held = null;
  }

  private click(event: MouseEvent): void {
    if (event.detail > 0 && this.distance > CLICK_REACH) event.preventDefault();
    this.distance = 0;
  }

  private key(event: KeyboardEvent): void {
    const step = KEYS[event.key];
    if (step === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    this.turnBy(step[0] * KEY_STEP, step[1] * KEY_STEP, Math.PI);
  }
}
