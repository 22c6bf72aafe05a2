// SPDX-License-Identifier: MIT
/// Tells when a device is lost, and when it is back: from then on it has nothing of what it was given.
export class ContextWatch {
  private readonly canvases = new WeakSet<EventTarget>();
  private readonly ending = new AbortController();

  constructor(private readonly lost: () => void, private readonly restored: () => void) {}

  /// The renderer has listened before: it knows of the loss, and is ready again, when this tells.
  drawnOn(canvas: EventTarget): void {
    if (this.canvases.has(canvas)) return;
    this.canvases.add(canvas);
    const { signal } = this.ending;
    canvas.addEventListener('webglcontextlost', this.lost, { signal });
    canvas.addEventListener('webglcontextrestored', this.restored, { signal });
  }

  stop(): void {
    this.ending.abort();
  }
}
