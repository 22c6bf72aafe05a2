// SPDX-License-Identifier: MIT
// Tells what failed and what to do: one message at a time, the newest, in a region that can be dismissed.
import { element, iconButton } from './parts/element.js';
import { ICONS } from './parts/icons.js';
import { words } from './words/words.js';

interface Told {
  message: string;
  more: string;
  retry: (() => void) | null;
  retryText: string;
}

export interface Telling {
  /// The button Retry does this; null: there is no button.
  retry?: (() => void) | null;
  /// Another text on that button.
  retryText?: string;
  /// Why, and what to do: shown when it is asked for.
  more?: string;
  /// The message is about this: a later one about the same takes its place.
  subject?: string;
}

export class Problems {
  readonly root = element('div', { class: 'problems', role: 'alert' });

  private readonly told = new Map<string, Told>();
  private readonly dismissed = new Set<string>();
  private readonly text = element('p', { class: 'problem-text' });
  private readonly more = element('p', { class: 'problem-more' });
  private readonly details = element('details', {}, element('summary', {}, words.parts.details), this.more);
  private readonly box = element('div', { class: 'problem' }, element('div', { class: 'problem-said' }, this.text, this.details));
  private readonly retry = element('button', { type: 'button', class: 'button problem-retry' }, words.parts.retry);

  constructor() {
    this.retry.addEventListener('click', () => { this.newest()?.[1].retry?.(); });
    this.box.append(this.retry, iconButton(words.parts.dismiss, ICONS.close, () => { this.dismiss(); }));
  }

  /// A message that was dismissed is not told again until it was taken away, which the function that it returns does.
  tell(message: string, { retry = null, retryText = words.parts.retry, more = '', subject = message }: Telling = {}): () => void {
    if (!this.dismissed.has(subject)) {
      this.told.delete(subject);
      this.told.set(subject, { message, more, retry, retryText });
      this.show();
    }
    return () => {
      this.told.delete(subject);
      this.dismissed.delete(subject);
      this.show();
    };
  }

  clear(): void {
    this.dismissed.clear();
    this.told.clear();
    this.show();
  }

  private newest(): [string, Told] | undefined {
    return [...this.told].at(-1);
  }

  private dismiss(): void {
    const newest = this.newest();
    if (newest === undefined) return;
    this.told.delete(newest[0]);
    this.dismissed.add(newest[0]);
    this.show();
  }

  /// A text that stays is not read out again.
  private show(): void {
    const newest = this.newest();
    if (newest === undefined) {
      this.box.remove();
      return;
    }
    const [, { message, more, retry, retryText }] = newest;
    if (this.text.textContent !== message) this.text.textContent = message;
    if (this.more.textContent !== more) this.more.textContent = more;
    this.details.hidden = more === '';
    this.retry.textContent = retryText;
    this.retry.hidden = retry === null;
    if (this.box.parentNode === null) this.root.append(this.box);
  }
}
