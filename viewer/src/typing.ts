// SPDX-License-Identifier: MIT
// Which keys are for the field that they are typed into: the one rule for every view's keys, in pages and elements.

/// These of a key's event count.
export type Typed = Pick<KeyboardEvent, 'key' | 'isComposing' | 'composedPath'>;

const WRITTEN_IN: readonly string[] = ['textarea', 'select'];

/// Tells whether an input of that type needs the key for itself; what is written in needs them all.
export function needsKey(type: string, key: string): boolean {
  if (type === 'checkbox' || type === 'button') return key === ' ';
  if (type === 'radio' || type === 'range') return /^(Arrow|Page|Home$|End$| $)/.test(key);
  return true;
}

/// The field that takes the key, also one in the shadow of an element; null: none does.
export function fieldOf(event: Typed): HTMLElement | null {
  const target = event.composedPath()[0] as Partial<HTMLInputElement> | undefined;
  const { localName = '', type = '', isContentEditable = false } = target ?? {};
  const isRow = target?.getAttribute?.('role') === 'treeitem'; // letters lead to names
  const takes = event.isComposing || isContentEditable || isRow || WRITTEN_IN.includes(localName) || (localName === 'input' && needsKey(type, event.key));
  return takes ? (target as HTMLElement) : null;
}

/// Tells whether a view's keys leave it alone.
export function isTyped(event: Typed): boolean {
  return fieldOf(event) !== null;
}
