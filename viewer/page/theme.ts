// SPDX-License-Identifier: MIT
// Light, dark, or as the system has it.
import { THEMES, type Theme } from './preferences.js';

const dark = matchMedia('(prefers-color-scheme: dark)');

export function applyTheme(theme: Theme): void {
  const shown = theme === 'auto' ? (dark.matches ? 'dark' : 'light') : theme;
  document.documentElement.dataset.theme = shown;
}

export function nextTheme(theme: Theme): Theme {
  return THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
}

/// Calls `changed` when the system's theme changes.
export function watchSystemTheme(changed: () => void): void {
  dark.addEventListener('change', changed);
}
