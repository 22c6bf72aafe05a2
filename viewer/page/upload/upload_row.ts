// SPDX-License-Identifier: MIT
// One upload, as the page shows it: how far it is, and a button that ends it.
import { formatBytes, formatDuration } from '../numbers.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import { words } from '../words/words.js';
import type { Upload } from './plan.js';
import { RateMeter } from './rate.js';

export function progressText(sent: number, total: number, meter: RateMeter): string {
  const { upload } = words;
  if (sent >= total) return upload.saving;
  const done = upload.sent(formatBytes(sent), formatBytes(total));
  const { rate } = meter;
  const left = meter.secondsTo(total);
  return rate === null || left === null ? done : upload.rate(done, formatBytes(rate), formatDuration(left));
}

export class UploadRow {
  readonly root: HTMLLIElement;
  private readonly bar: HTMLProgressElement;
  private readonly state = element('span', { class: 'upload-state' }, words.upload.waiting);
  private readonly meter = new RateMeter();

  constructor(readonly upload: Upload, cancel: () => void) {
    const { name } = upload;
    this.bar = element('progress', { max: '1', value: '0', 'aria-label': words.upload.progress(name) });
    const end = iconButton(words.upload.cancel(name), ICONS.close, cancel);
    this.root = element('li', { class: 'upload-row' }, element('span', { class: 'upload-name' }, name), this.bar, this.state, end);
  }

  /// Bytes of the request; `now` in milliseconds.
  show(sent: number, total: number, now: number): void {
    this.meter.note(now, sent);
    this.bar.value = total > 0 ? sent / total : 0;
    this.state.textContent = progressText(sent, total, this.meter);
  }
}
