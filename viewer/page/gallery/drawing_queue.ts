// SPDX-License-Identifier: MIT
// Draws still outlines one a frame, so that scrolling does not wait for them.

export interface Drawable {
  readonly root: Element;
  draw(): void;
}

export class DrawingQueue {
  private readonly waiting = new Set<Drawable>();
  private frame = 0;

  add(one: Drawable): void {
    this.waiting.add(one);
    this.ask();
  }

  private ask(): void {
    if (this.frame === 0 && this.waiting.size > 0) this.frame = requestAnimationFrame(() => { this.next(); });
  }

  private next(): void {
    this.frame = 0;
    this.takeFirst()?.draw();
    this.ask();
  }

  /// Outlines that have left the page meanwhile are left out.
  private takeFirst(): Drawable | null {
    for (const one of this.waiting) {
      this.waiting.delete(one);
      if (one.root.isConnected) return one;
    }
    return null;
  }
}
