// SPDX-License-Identifier: MIT
// Which objects are drawn, as texts say it: a name, or where it ends with "/" the beginning of names. Of two that fit the longer one holds.

export interface ObjectChoice {
  readonly hidden: readonly string[];
  /// Only these are drawn, unless they are hidden; none: all are.
  readonly only: readonly string[];
  /// Drawn although a shorter text hides them.
  readonly shown: readonly string[];
}

export const ALL_OBJECTS: ObjectChoice = { hidden: [], only: [], shown: [] };

export type Visibility = 'shown' | 'hidden' | 'mixed';

/// Tells whether all that a text means is meant by another one, too.
function covers(text: string, other: string): boolean {
  return text === other || (text.endsWith('/') && other.startsWith(text));
}

function isBelow(other: string, text: string): boolean {
  return other !== text && covers(text, other);
}

function longestOf(texts: readonly string[], text: string): number {
  return texts.reduce((longest, each) => (covers(each, text) ? Math.max(longest, each.length) : longest), -1);
}

/// Tells whether all of what a text means is drawn, nothing of it, or a part.
export function visibilityOf({ hidden, only, shown }: ObjectChoice, text: string): Visibility {
  const [out, back] = [longestOf(hidden, text), longestOf(shown, text)];
  const isAlone = only.length === 0 || only.some((each) => covers(each, text));
  const isShown = out < 0 && back < 0 ? isAlone : back > out;
  const isMixed = [...(isShown ? hidden : shown), ...(isAlone ? [] : only)].some((each) => isBelow(each, text));
  return isMixed ? 'mixed' : isShown ? 'shown' : 'hidden';
}

/// All of what a text means is drawn from now on, or nothing of it.
export function withShown({ hidden, only, shown }: ObjectChoice, text: string, isShown: boolean): ObjectChoice {
  const others = (texts: readonly string[]): string[] => texts.filter((each) => !covers(text, each));
  const rest = { hidden: others(hidden), only, shown: others(shown) };
  if (visibilityOf(rest, text) === (isShown ? 'shown' : 'hidden')) return rest;
  return isShown ? { ...rest, shown: [...rest.shown, text] } : { ...rest, hidden: [...rest.hidden, text] };
}

/// Nothing but what a text means is drawn, and of that what was drawn before.
export function alone({ hidden, shown }: ObjectChoice, text: string): ObjectChoice {
  const within = (texts: readonly string[]): string[] => texts.filter((each) => isBelow(each, text));
  return { hidden: within(hidden), only: [text], shown: within(shown) };
}
