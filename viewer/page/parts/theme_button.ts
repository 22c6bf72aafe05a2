// SPDX-License-Identifier: MIT
// Goes from one theme to the next.
import { nextTheme } from '../theme.js';
import type { Theme } from '../preferences.js';
import { icon, iconButton } from './element.js';
import { ICONS } from './icons.js';
import { words } from '../words/words.js';

/// `chosen` is told the theme; `current` says which one it is.
export function themeButton(current: () => Theme, chosen: (theme: Theme) => void): HTMLButtonElement {
  const button = iconButton('', ICONS.auto, () => {
    chosen(nextTheme(current()));
    show();
  });
  const show = (): void => {
    const name = words.parts.theme(words.themes[current()]);
    button.setAttribute('aria-label', name);
    button.title = name;
    button.replaceChildren(icon(ICONS[current()]));
  };
  show();
  return button;
}
