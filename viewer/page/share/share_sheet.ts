// SPDX-License-Identifier: MIT
// A link to what is shown, the code for other pages, and how the model is seen first.
import { element } from '../parts/element.js';
import type { ViewParts } from '../view/view_parts.js';
import { words } from '../words/words.js';
import { CopyField } from './copy_field.js';
import { elementCode, frameCode } from './embed_code.js';
import { FirstViewForm } from './first_view_form.js';

export class ShareSheet {
  readonly root: HTMLElement;
  private readonly status = element('p', { class: 'copy-status', role: 'status' });
  private readonly link = new CopyField(words.share.link, 2, this.status);
  private readonly frame = new CopyField(words.share.frame, 4, this.status);
  private readonly element = new CopyField(words.share.element, 4, this.status);
  private readonly leftOut = element('p', { class: 'hint', hidden: true });
  private readonly codes = element('div', { class: 'share' }, this.frame.root, this.element.root, element('p', { class: 'hint' }, words.share.codesHint));
  private readonly first: FirstViewForm;

  constructor(private readonly parts: ViewParts) {
    this.first = new FirstViewForm(parts, this.status);
    this.root = element('div', { class: 'share' }, this.link.root, this.leftOut, this.codes, this.first.root, this.status);
  }

  /// Takes what is seen now: the page's address tells of it once the view was asked.
  show(): void {
    const shared = this.parts.shared();
    this.link.field.value = location.href;
    this.codes.hidden = shared.isWhole;
    this.frame.field.value = frameCode(shared);
    this.element.field.value = elementCode(shared);
    this.leftOut.hidden = shared.leftOut.length === 0;
    this.leftOut.textContent = words.share.leftOut(shared.leftOut.map((part) => words.share.parts[part]).join(', '));
    this.first.show();
  }
}
