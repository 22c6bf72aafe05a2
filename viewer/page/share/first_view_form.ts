// SPDX-License-Identifier: MIT
// Makes what is seen the model's first view: at a button for those who may, else by lines to paste.
import { isArchiveUrl } from '../../src/hierarchy/archive_format.js';
import { viewToJson } from '../../src/view/view_json.js';
import { formatAddress } from '../address.js';
import { fileOf } from '../listing.js';
import { element } from '../parts/element.js';
import { Token } from '../upload/token.js';
import type { ViewParts } from '../view/view_parts.js';
import { words } from '../words/words.js';
import { CopyField } from './copy_field.js';
import { sendView } from './send_view.js';

/// For a shell, between single quotes.
function quoted(link: string): string {
  return `'${link.replaceAll("'", '%27')}'`;
}

export class FirstViewForm {
  readonly root: HTMLElement;
  private readonly make = element('button', { type: 'button', class: 'text-button' }, words.firstView.make);
  private readonly forget = element('button', { type: 'button', class: 'text-button' }, words.firstView.forget);
  private readonly buttons = element('div', { class: 'first-view-buttons', hidden: true }, this.make, this.forget);
  private readonly config: CopyField;
  private readonly command: CopyField;
  private readonly lines: HTMLElement;
  private readonly token = new Token();
  private mayWrite = false;

  /// `status`: tells what came of it.
  constructor(private readonly parts: ViewParts, private readonly status: HTMLElement) {
    const text = words.firstView;
    this.config = new CopyField(text.config, 3, status);
    this.command = new CopyField(text.command, 3, status);
    this.lines = element('div', { class: 'share' }, this.config.root, this.command.root);
    this.make.addEventListener('click', () => void this.send(false));
    this.forget.addEventListener('click', () => void this.send(true));
    this.root = element('details', { class: 'numbers' }, element('summary', {}, text.title), element('div', { class: 'share' }, element('p', { class: 'hint' }, text.hint), this.buttons, this.lines));
    parts.context.arrival.findPermission(parts.context.signal).then((may) => {
      this.mayWrite = may && !this.isArchive;
      this.show();
    }, () => undefined);
  }

  /// As it is seen now.
  show(): void {
    const { parts } = this;
    const spot = parts.firstSpot();
    this.buttons.hidden = !this.mayWrite;
    this.lines.hidden = this.mayWrite;
    this.forget.hidden = Object.keys(parts.first.view).length === 0;
    this.config.field.value = `"view": ${JSON.stringify(viewToJson(parts.seen()))}`;
    this.command.field.value = `meshhier view ${fileOf(parts.context.model)} --link ${quoted(formatAddress({ path: '', ...spot }))}`;
    this.command.root.hidden = this.isArchive;
  }

  /// An archive is written once.
  private get isArchive(): boolean {
    return isArchiveUrl(this.parts.context.model.url.replace(/\/+$/, ''));
  }

  private async send(isNothing: boolean): Promise<void> {
    const { parts: { context }, token } = this;
    const word = context.arrival.asksToken() ? await token.get() : null;
    const view = isNothing ? {} : this.parts.seen();
    const answer = await sendView(context.model.url, view, { token: word, build: context.view.manifest?.build ?? '' });
    if (answer.status === 401) token.forget();
    if (answer.build !== null) context.view.takeFirstView(answer.build, view);
    this.show();
    this.status.textContent = answer.status !== 200 ? words.firstView.refused(answer.text) : isNothing ? words.firstView.forgotten : words.firstView.made;
  }
}
