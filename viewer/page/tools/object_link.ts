// SPDX-License-Identifier: MIT
// What links tell of objects: which one is picked, by which property they have colours, and which are drawn.
import type { ObjectChoice } from '../../src/tools/object_choice.js';
import { readLink, writeLink } from '../../src/view/view_link.js';

export interface ObjectLink extends ObjectChoice {
  /// The name of the object that is picked; null: none is.
  readonly picked: string | null;
  /// The property that objects are coloured by; null: none.
  readonly by: string | null;
  /// Where its colours begin and end; null: at the least and the greatest number.
  readonly between: readonly [number, number] | null;
}

/// Empty: nothing is picked, and all is drawn.
export function formatObjectLink({ picked, by, between, hidden: hide, only, shown: show }: ObjectLink): string {
  return writeLink({ object: picked ?? undefined, by: by ?? undefined, between: between ?? undefined, only, hide, show });
}

export function parseObjectLink(link: string): ObjectLink {
  const { object = null, by = null, between = null, only = [], hide = [], show = [] } = readLink(link);
  return { picked: object, by, between, only, hidden: hide, shown: show };
}
