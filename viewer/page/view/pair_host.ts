// SPDX-License-Identifier: MIT
// The other model of a comparison, whose code is loaded where there is one; and the way to it where there is none.
import type { Spot } from '../address.js';
import { element } from '../parts/element.js';
import { compareAddress } from '../pair/compare_address.js';
import { DEFAULT_PAIR, formatPairLook, readPairLook, type PairLook } from '../pair/pair_link.js';
import type { PagePair } from '../pair/page_pair.js';
import type { PageStage } from './page_stage.js';
import type { ViewChoices } from './view_choices.js';

export class PairHost {
  /// Models to compare with are chosen in it.
  readonly form = element('div', { class: 'compare' });
  private pair: PagePair | null = null;
  private look: PairLook = DEFAULT_PAIR;
  /// A story's note wants it so; null: none is told.
  private told: PairLook | null = null;

  constructor(private readonly stage: PageStage, private readonly choices: ViewChoices, private readonly spot: () => Spot) {
    const { context } = stage;
    this.look = readPairLook(context.arrival.spot.choices);
    context.addEventListener('story', ({ isTold }) => { if (!isTold) this.tell(null); });
    context.signal.addEventListener('abort', () => { this.pair?.close(); });
  }

  get shown(): PagePair | null {
    return this.pair;
  }

  /// Two models are to be seen.
  get isWanted(): boolean {
    return this.stage.context.arrival.other !== null;
  }

  /// The code for two models has come, if there are two.
  get isThere(): boolean {
    return !this.isWanted || this.pair !== null;
  }

  /// As links have it.
  get text(): string {
    return this.isWanted ? formatPairLook(this.look) : '';
  }

  /// As a link says.
  follow(choices: string): void {
    this.look = readPairLook(choices);
    this.show();
  }

  /// As a note of a story wants it; null: none is told any more.
  tell(choices: string | null): void {
    this.told = choices === null ? null : readPairLook(choices);
    this.show();
  }

  choose(change: Partial<PairLook>): void {
    this.look = { ...this.look, ...this.told, ...change };
    this.told = null;
    this.show();
    this.stage.context.startRest();
  }

  /// Loads the other model, if there is one.
  async begin(): Promise<void> {
    const { context } = this.stage;
    const { other } = context.arrival;
    if (other === null || this.pair !== null) return;
    try {
      const { PagePair } = await import('../pair/page_pair.js');
      if (context.signal.aborted) return;
      this.pair = new PagePair(this.stage, this.choices, other, (change) => { this.choose(change); }, () => { this.end(); });
      this.show();
    } catch {
      context.missCode(() => void this.begin());
    }
  }

  /// Shows what this model may be compared with.
  async offer(): Promise<void> {
    const { context } = this.stage;
    if (this.form.childElementCount > 0) return;
    try {
      const { CompareForm } = await import('../pair/compare_form.js');
      if (context.signal.aborted || this.form.childElementCount > 0) return;
      this.form.append(new CompareForm(context, (other) => { this.leaveFor(other); }).root);
    } catch {
      context.missCode(() => void this.offer());
    }
  }

  private show(): void {
    this.pair?.show(this.told ?? this.look);
  }

  private end(): void {
    this.leaveFor(null);
  }

  /// The page is loaded with another model beside this one, or without any. The camera and what was chosen stay.
  private leaveFor(other: string | null): void {
    const { model } = this.stage.context;
    const { pose, choices } = this.spot();
    const url = model.files === undefined ? model.url : null;
    location.assign(compareAddress(location.href, { url, other, story: url === null ? null : model.story, pose, choices }));
  }
}

