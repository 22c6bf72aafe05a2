// SPDX-License-Identifier: MIT
// Goes from one theme to the next.
import type { Page } from '../page.js';
import { THEMES } from '../preferences.js';
import { icon, iconButton } from './element.js';
import { ICONS } from './icons.js';
import { words } from '../words/words.js';

export function themeButton(page: Page): HTMLButtonElement {
  const button = iconButton('', ICONS.auto, () => { page.setTheme(THEMES[(THEMES.indexOf(page.preferences.theme) + 1) % THEMES.length]); });
  const show = (): void => {
    const { theme } = page.preferences;
    const name = words.parts.theme(words.themes[theme]);
    button.setAttribute('aria-label', name);
    button.title = name;
    button.replaceChildren(icon(ICONS[theme]));
  };
  page.addEventListener('theme', show);
  show();
  return button;
}
