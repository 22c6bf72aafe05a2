// SPDX-License-Identifier: MIT
// A mesh that is being made into a hierarchy: what it looks like, how far it is, or why it failed.
import type { Job } from '../listing.js';
import { formatDuration, formatPercent } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import type { Cell } from './cell.js';

/// Without the name where it begins with that: it stands above.
function messageOf({ name, message }: Job): string {
  const start = `${name}:`;
  return message.startsWith(start) ? message.slice(start.length).trim() : message;
}

/// One that these words do not know is called as the build calls it.
function stageName(stage: string): string {
  const names: Readonly<Record<string, string>> = words.jobs.stages;
  return Object.hasOwn(names, stage) ? names[stage] : stage || words.jobs.building;
}

export function stateText(job: Job): string {
  const { state, stage, progress, secondsLeft } = job;
  if (state === 'failed') return messageOf(job) || words.jobs.failed;
  if (state === 'waiting') return messageOf(job) || words.jobs.waiting;
  const part = progress === null ? '' : ` ${formatPercent(progress)}`;
  const what = `${stageName(stage)}${part}`;
  return secondsLeft === null ? what : words.jobs.left(what, formatDuration(secondsLeft));
}

function bar({ name, state, progress }: Job): HTMLElement | null {
  if (state === 'failed') return null;
  const value = state === 'building' && progress !== null ? String(progress) : null;
  return element('progress', { max: '1', value, 'aria-label': words.jobs.progress(name) });
}

export class JobCell implements Cell {
  readonly root: HTMLLIElement;
  private readonly picture = element('img', { class: 'cell-picture', alt: '', decoding: 'async', draggable: 'false', hidden: true });
  private readonly state = element('span', { class: 'cell-state' });
  private readonly size = element('span', { class: 'cell-size' });
  private readonly body: HTMLElement;
  private shown = '';

  constructor(name: string) {
    const stage = element('span', { class: 'cell-stage' }, this.picture, this.state);
    this.body = element('div', { class: 'cell job' }, stage, element('span', { class: 'cell-name', title: name }, name), this.size);
    this.root = element('li', {}, this.body);
    this.picture.addEventListener('load', () => { this.picture.hidden = false; });
    this.picture.addEventListener('error', () => { this.picture.hidden = true; });
  }

  update(job: Job): void {
    const text = JSON.stringify(job);
    if (text === this.shown) return;
    this.shown = text;
    const failed = job.state === 'failed';
    this.body.classList.toggle('job-failed', failed);
    this.size.classList.toggle('cell-problem', failed);
    this.state.replaceChildren(...[bar(job)].filter((one) => one !== null));
    this.size.textContent = this.size.title = stateText(job);
    if (job.preview !== null && job.preview !== this.picture.getAttribute('src')) this.picture.src = job.preview;
  }

  load(): void {
    // its picture comes with the listing
  }

  redraw(): void {
    // nothing of it is drawn
  }

  close(): void {
    this.root.remove();
  }
}
