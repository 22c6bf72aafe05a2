// SPDX-License-Identifier: MIT
// Tells taps from drags: those of one pointer alone, which hardly moves.

export const TAP_REACH = 8; // pixels: what moves farther is a drag

type Touch = Pick<PointerEvent, 'pointerId' | 'clientX' | 'clientY'>;

export class Taps {
  private readonly pointers = new Map<number, Touch>();
  private travelled = 0;

  down(touch: Touch): void {
    this.pointers.set(touch.pointerId, touch);
    this.travelled = this.pointers.size === 1 ? 0 : Infinity;
  }

  /// All of the way counts, there and back too.
  move(touch: Touch): void {
    const before = this.pointers.get(touch.pointerId);
    if (before === undefined) return;
    this.travelled += Math.hypot(touch.clientX - before.clientX, touch.clientY - before.clientY);
    this.pointers.set(touch.pointerId, touch);
  }

  /// True: it was a tap.
  lift(touch: Touch & Pick<PointerEvent, 'button'>): boolean {
    this.move(touch);
    const wasLast = this.pointers.delete(touch.pointerId) && this.pointers.size === 0;
    return wasLast && touch.button === 0 && this.travelled < TAP_REACH;
  }

  cancel({ pointerId }: Pick<Touch, 'pointerId'>): void {
    this.pointers.delete(pointerId);
  }
}
