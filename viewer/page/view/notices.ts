// SPDX-License-Identifier: MIT
// Tells a visitor what failed in a model's view, as long as it holds.
import { HierarchyProblem } from '../../src/index.js';
import { formatCount } from '../numbers.js';
import { words } from '../words/words.js';
import type { PageFrames } from './page_frames.js';
import type { PageContext } from './page_context.js';

type Done = (() => void) | undefined;

export class Notices {
  private missing: Done;
  private refusal: Done;
  private lost: Done;

  constructor(private readonly context: PageContext, private readonly frames: PageFrames) {
    const { view, canvas, signal } = context;
    view.addEventListener('problem', ({ message, files }) => { this.miss(message, files); });
    view.addEventListener('recovered', () => { this.missing?.(); });
    view.addEventListener('replaced', () => { this.missing?.(); });
    context.addEventListener('opened', () => { this.refusal?.(); });
    context.addEventListener('refused', ({ error }) => { this.refuse(error); });
    canvas.element.addEventListener('webglcontextlost', () => { this.lose(); }, { signal });
    canvas.element.addEventListener('webglcontextrestored', () => { this.lost?.(); }, { signal });
  }

  /// However many files are missing, they are one message.
  private miss(message: string, files: number): void {
    const { model, page: { problems }, view } = this.context;
    const text = words.problems.missing(model.name, files, formatCount(files));
    this.missing = problems.tell(text, { more: message, subject: 'missing', retry: () => { view.retry(); } });
  }

  /// Nothing is drawn until the device is back.
  private lose(): void {
    const { pictureLost, pictureLostMore } = words.problems;
    const told = this.context.page.problems.tell(pictureLost, { more: pictureLostMore });
    const goOn = this.frames.pause();
    this.lost = () => {
      this.lost = undefined;
      told();
      goOn();
    };
  }

  private refuse(error: unknown): void {
    const { model, page } = this.context;
    const why = error instanceof Error ? error.message : String(error);
    const passes = error instanceof HierarchyProblem && error.mayPass;
    const { notOpened, notAHierarchy } = words.problems;
    const more = passes ? why : `${why}. ${notAHierarchy(model.url)}`;
    this.missing?.();
    this.refusal = page.problems.tell(notOpened(model.name), { more, subject: 'refused', retry: () => { page.dispatchEvent(new Event('again')); } });
  }
}
