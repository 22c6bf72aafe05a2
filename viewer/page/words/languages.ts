// SPDX-License-Identifier: MIT
// The languages of the page, and which of them a visitor gets.

export const LANGUAGES = ['en', 'de', 'es'] as const;
export type Language = (typeof LANGUAGES)[number];

function isLanguage(tag: string): tag is Language {
  return (LANGUAGES as readonly string[]).includes(tag);
}

/// `es-MX` to `es`.
function withoutRegion(tag: string): string {
  return tag.toLowerCase().split('-')[0];
}

/// Returns the language that the address asks for (`?lang=`), else the one that was chosen here before, else the first that the browser wants.
export function chooseLanguage(search: string, chosen: Language | null, wanted: readonly string[]): Language {
  const asked = new URLSearchParams(search).get('lang');
  const tags = [asked, chosen, ...wanted].map((tag) => withoutRegion(tag ?? ''));
  return tags.find(isLanguage) ?? 'en';
}

/// The visitor's own form of the language, as for its numbers: `de-CH` where the browser says so.
export function localeOf(language: Language, wanted: readonly string[]): string {
  return wanted.find((tag) => withoutRegion(tag) === language) ?? language;
}
