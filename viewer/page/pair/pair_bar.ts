// SPDX-License-Identifier: MIT
// The names of two models, with their colours, and how they are looked at.
import type { Laying, Side, Way } from '../../src/pair/index.js';
import { TINTS, WAYS } from '../../src/pair/index.js';
import { formatNumber } from '../numbers.js';
import { checkbox, choice, type ChoiceControl, type Control } from '../parts/controls.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from '../words/words.js';

export interface PairActions {
  readonly way: (way: Way) => void;
  readonly show: (side: Side) => void;
  readonly blinks: (on: boolean) => void;
  readonly align: (on: boolean) => void;
  readonly end: () => void;
}

/// Facts about both models that a person who compares them should know.
export interface PairFacts {
  readonly laying: Laying | null;
  readonly overlaps: boolean;
  readonly aligned: boolean;
  /// The second one lacks the attribute that colours the first; null: it does not.
  readonly lacks: string | null;
}

function cssOf(colour: number): string {
  return `#${colour.toString(16).padStart(6, '0')}`;
}

export class PairBar {
  readonly root: HTMLElement;
  private readonly names: readonly HTMLButtonElement[];
  private readonly ways: ChoiceControl<Way>;
  private readonly blinks: Control<boolean>;
  private readonly align: HTMLButtonElement;
  private readonly note = element('p', { class: 'pair-note', role: 'status' });
  private isAligned = false;

  constructor(names: readonly [string, string], private readonly actions: PairActions, mayBlink: boolean) {
    this.names = names.map((name, i) => this.nameButton(name, i as Side));
    this.ways = choice(words.pair.ways, WAYS.map((way) => [way, words.pair.wayNames[way]] as const), actions.way);
    this.blinks = checkbox(words.pair.blinks, null, actions.blinks);
    this.blinks.root.hidden = true;
    this.blinks.root.classList.toggle('pair-still', !mayBlink);
    this.align = element('button', { type: 'button', class: 'text-button', hidden: true });
    this.align.addEventListener('click', () => { actions.align(!this.isAligned); });
    const end = iconButton(words.pair.end, ICONS.close, actions.end);
    const row = element('div', { class: 'pair-row' }, this.names[0], this.ways.root, this.names[1], end);
    this.root = element('section', { class: 'pair-bar', 'aria-label': words.pair.title }, row, this.blinks.root, this.note, this.align);
  }

  /// `shown`: by a blink.
  show(way: Way, shown: Side, blinks: boolean): void {
    this.ways.show(way);
    this.blinks.show(blinks);
    this.blinks.root.hidden = way !== 'blink';
    this.root.dataset.way = way;
    this.names.forEach((button, i) => {
      button.disabled = way !== 'blink';
      button.setAttribute('aria-pressed', String(way === 'blink' && shown === i));
    });
  }

  tell({ laying, overlaps, aligned, lacks }: PairFacts): void {
    const { pair } = words;
    const said = [
      aligned ? pair.aligned : overlaps ? null : pair.apart,
      laying === null || laying.factor === 1 ? null : pair.units(formatNumber(laying.factor)),
      laying?.isTurned === true ? pair.turned : null,
      laying?.by === 'alone' ? pair.alone : null,
      lacks === null ? null : pair.lacks(this.names[1].textContent, lacks),
    ].filter((each) => each !== null).join(' ');
    if (this.note.textContent !== said) this.note.textContent = said;
    this.note.hidden = said === '';
    this.isAligned = aligned;
    this.align.hidden = overlaps && !aligned;
    this.align.textContent = aligned ? pair.asStored : pair.align;
  }

  /// The second model is not there.
  fail(message: string): void {
    this.note.hidden = false;
    this.note.textContent = message;
  }

  private nameButton(name: string, side: Side): HTMLButtonElement {
    const swatch = element('span', { class: 'swatch', 'aria-hidden': 'true' });
    swatch.style.background = cssOf(TINTS[side]);
    const button = element('button', { type: 'button', class: 'pair-name', title: name }, swatch, element('span', {}, name));
    button.addEventListener('click', () => { this.actions.show(side); });
    return button;
  }
}
