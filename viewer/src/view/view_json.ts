// SPDX-License-Identifier: MIT
// Views in JSON: strictly of configs and manifests, leniently of what the browser keeps.
import { JsonValue, type Json } from '../json_value.js';
import { isOtherwise, rowOf, VIEW_KEYS, valueOf, type View, type ViewKey } from './view_table.js';

const JSON_KEYS = VIEW_KEYS.filter((key) => !rowOf(key).isForLinks);

/// Reads a view that says what a model is. Refuses what is none.
export function readView(json: JsonValue): View {
  const view: Partial<Record<ViewKey, unknown>> = {};
  for (const [name, value] of json.entries()) {
    const key = JSON_KEYS.find((each) => each === name);
    if (key === undefined) value.fail('a key of a view');
    else view[key] = rowOf(key).kind.read(value);
  }
  if (view.cut !== undefined && view.box !== undefined) json.at('box').fail('allowed beside a cut');
  if (view.attribute !== undefined) view.colours ??= 'attribute';
  return view as View;
}

/// What readView() reads again: all that is not as without a choice. An attribute that does not colour the model has its colours beside it.
export function viewToJson(view: View): Json {
  const isSaid = (key: ViewKey): boolean => !isOtherwise(key, view[key]) || (key === 'colours' && view.attribute !== undefined);
  return Object.fromEntries(JSON_KEYS.filter(isSaid).map((key) => [key, rowOf(key).kind.toJson(valueOf(view, key))]));
}

/// The value that somebody has stored, where it is one.
export function storedValue<Key extends ViewKey>(key: Key, stored: unknown): NonNullable<View[Key]> | null {
  const none = new Error('none');
  try {
    return rowOf(key).kind.read(JsonValue.of(stored, key, () => { throw none; })) as NonNullable<View[Key]>;
  } catch (problem) {
    if (problem !== none) throw problem;
    return null;
  }
}
