// SPDX-License-Identifier: MIT
// The shaded root of what is pointed at or focused for a while. Its code, the view's, and its tile come only then.
import type { RootPicture } from '../view/root_picture.js';
import type { Turn } from './layout.js';
import type { Shape } from './shape.js';

const STAY = 900; // milliseconds that mean it: a tile and the view's code are larger than an outline

export class Solid {
  private picture: RootPicture | null = null;
  private timer = 0;
  private epoch = 0;
  private turn: Turn | null = null;

  /// `url`: of the hierarchy; `stage`: its class `solid` says that the picture is there.
  constructor(private readonly url: string, private readonly stage: HTMLElement) {}

  /// Shows the root as the outline is seen, after a while.
  await(shape: Shape, turn: Turn): void {
    if (this.timer !== 0) return;
    this.turn = turn;
    this.timer = window.setTimeout(() => { void this.begin(shape, this.epoch); }, STAY);
  }

  show(turn: Turn): void {
    this.turn = turn;
    this.picture?.show(turn);
  }

  end(): void {
    window.clearTimeout(this.timer);
    this.timer = 0;
    ++this.epoch;
    this.stage.classList.remove('solid');
    this.picture?.close();
    this.picture = null;
  }

  /// Where the code does not come, or draws nothing, the outline stays.
  private async begin(shape: Shape, epoch: number): Promise<void> {
    try {
      const { RootPicture } = await import('../view/model_view.js');
      if (epoch !== this.epoch || this.turn === null || !this.stage.checkVisibility()) return; // a model may have been opened meanwhile
      this.picture = new RootPicture(this.url, shape, this.turn, () => { this.stage.classList.add('solid'); });
      this.stage.append(this.picture.canvas);
    } catch {
      // nothing else shows it
    }
  }
}
