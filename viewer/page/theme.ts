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

/// The colour of a custom property of the page, as numbers from 0 to 1.
export function themeColour(property: string): [number, number, number] {
  const text = getComputedStyle(document.documentElement).getPropertyValue(property).trim();
  const value = Number.parseInt(text.replace('#', ''), 16);
  return [((value >> 16) & 255) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
