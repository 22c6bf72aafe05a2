// A mesh that is being made into a hierarchy: how far it is, or why it failed.
import type { Job } from '../listing.js';
import { formatDuration, formatPercent } from '../numbers.js';
import { element } from '../parts/element.js';
import { words } from '../words/words.js';

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

export class JobCell {
  readonly root: HTMLLIElement;
  private readonly body = element('div', { class: 'cell job' });
  private shown = '';

  constructor(readonly name: string) {
    this.root = element('li', {}, this.body);
  }

  update(job: Job): void {
    const text = JSON.stringify(job);
    if (text === this.shown) return;
    this.shown = text;
    this.body.classList.toggle('job-failed', job.state === 'failed');
    this.body.replaceChildren(
      element('span', { class: 'cell-stage' }, bar(job)),
      element('span', { class: 'cell-name' }, job.name),
      element('span', { class: `cell-size${job.state === 'failed' ? ' cell-problem' : ''}` }, stateText(job)),
    );
  }
}
