// SPDX-License-Identifier: MIT
// All parts of the page share this: what the visitor chose, and what is told of failures.
import { loadPreferences, savePreferences, type Preferences, type Theme } from './preferences.js';
import { Problems } from './problems.js';
import type { Language } from './words/languages.js';

const dark = matchMedia('(prefers-color-scheme: dark)');

/// Events: `theme`, another one is shown; `leave`, the visitor goes from the model to the gallery; `again`, the model is opened anew.
export class Page extends EventTarget {
  readonly preferences = loadPreferences();
  readonly problems = new Problems();

  constructor() {
    super();
    this.showTheme();
    dark.addEventListener('change', () => { this.showTheme(); });
  }

  /// Changes preferences, and keeps them in the browser.
  keep(change: Partial<Preferences>): void {
    Object.assign(this.preferences, change);
    savePreferences(this.preferences);
  }

  setTheme(theme: Theme): void {
    this.keep({ theme });
    this.showTheme();
  }

  /// The words hold as long as the page: it is loaded again, without the language that its address asks for.
  setLanguage(language: Language): void {
    this.keep({ language });
    const address = new URL(location.href);
    address.searchParams.delete('lang');
    history.replaceState(history.state, '', address);
    location.reload();
  }

  private showTheme(): void {
    const { theme } = this.preferences;
    document.documentElement.dataset.theme = theme === 'auto' ? (dark.matches ? 'dark' : 'light') : theme;
    this.dispatchEvent(new Event('theme'));
  }
}
