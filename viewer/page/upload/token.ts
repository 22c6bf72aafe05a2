// SPDX-License-Identifier: MIT
// The word that a server asks for before it takes meshes: known as long as the tab.
import { element } from '../parts/element.js';
import { words } from '../words/words.js';
import { storedToken, storeToken } from './permission.js';

export class Token {
  private known = storedToken();

  forget(): void {
    this.keep(null);
  }

  /// Asks for it once; null if the visitor does not tell.
  async get(): Promise<string | null> {
    if (this.known === null) this.keep(await ask());
    return this.known;
  }

  private keep(token: string | null): void {
    this.known = token;
    storeToken(token);
  }
}

function ask(): Promise<string | null> {
  const input = element('input', { type: 'password', name: 'token', autocomplete: 'off', required: true, 'aria-label': words.upload.token });
  const button = (value: string, text: string): HTMLButtonElement =>
    element('button', { type: 'submit', class: 'button upload-text', value, formnovalidate: value === '' }, text);
  const form = element('form', { method: 'dialog' }, element('p', {}, words.upload.askToken), input,
    element('div', { class: 'upload-answers' }, button('send', words.upload.go), button('', words.upload.stop))); // Enter is the first one
  const dialog = element('dialog', { class: 'upload-dialog' }, form);
  document.body.append(dialog);
  dialog.showModal();
  input.focus();
  return new Promise((resolve) => {
    dialog.addEventListener('close', () => {
      dialog.remove();
      resolve(dialog.returnValue === 'send' ? input.value.trim() || null : null);
    });
  });
}
