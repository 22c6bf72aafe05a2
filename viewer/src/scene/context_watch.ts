// SPDX-License-Identifier: MIT
/// Tells when a lost device is back: from then on it has nothing of what it was given.
export class ContextWatch {
  private readonly canvases = new WeakSet<EventTarget>();
  private readonly ending = new AbortController();

  constructor(private readonly restored: () => void) {}

  /// The renderer has listened before: it is ready when this tells.
  drawnOn(canvas: EventTarget): void {
    if (this.canvases.has(canvas)) return;
    this.canvases.add(canvas);
    canvas.addEventListener('webglcontextrestored', this.restored, { signal: this.ending.signal });
  }

  stop(): void {
    this.ending.abort();
  }
}
