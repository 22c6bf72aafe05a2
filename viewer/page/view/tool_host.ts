// SPDX-License-Identifier: MIT
// The tools of a view, loaded when they are first used, and the notes that its links have.
import { choiceOf, type Spot } from '../address.js';
import type { Bench, ToolName, Tools } from '../tools/bench.js';

export interface ToolSurroundings {
  /// Null: nothing is known of the model yet.
  bench(): Omit<Bench, 'notes' | 'setNotes'> | null;
  /// Links are to have other notes.
  noted(): void;
  /// The code could not be loaded.
  failed(retry: () => void): void;
}

export class ToolHost {
  private tools: Tools | null = null;
  private linked: string | null = null;
  private hasNews = false;

  constructor(private readonly around: ToolSurroundings) {}

  /// As links have them.
  get notes(): string | null {
    return this.linked;
  }

  /// A link's notes, instead of those before.
  follow(spot: Spot): void {
    this.linked = choiceOf(spot, 'notes');
    this.hasNews = this.linked !== null && this.tools === null;
    this.tools?.follow(this.linked);
  }

  /// The notes of a link are shown once something is known of the model.
  showNews(): void {
    if (this.hasNews) void this.use('notes');
    this.hasNews = false;
  }

  /// Null: the bar.
  async use(name: ToolName | null): Promise<void> {
    if (this.around.bench() === null) return;
    try {
      const { Toolbox } = await import('../tools/toolbox.js');
      const bench = this.around.bench();
      if (bench === null || bench.signal.aborted) return;
      this.tools ??= new Toolbox({ ...bench, notes: this.linked, setNotes: (notes) => { this.setNotes(notes); } });
      this.tools.toggle(name);
    } catch {
      this.around.failed(() => void this.use(name));
    }
  }

  tapped(right: number, up: number): boolean {
    return this.tools?.tapped(right, up) ?? false;
  }

  drawn(): void {
    this.tools?.drawn();
  }

  back(): boolean {
    return this.tools?.back() ?? false;
  }

  private setNotes(notes: string | null): void {
    this.linked = notes;
    this.around.noted();
  }
}
