// SPDX-License-Identifier: MIT
// Asks the server to keep a view as a model's first one.
import { withoutLastSlashes } from '../../src/hierarchy/bytes.js';
import { asObject } from '../../src/json_value.js';
import { viewToJson } from '../../src/view/view_json.js';
import type { View } from '../../src/view/view_table.js';
import { words } from '../words/words.js';

export interface ViewAnswer {
  /// 0: there was none.
  readonly status: number;
  /// Why it was not kept, in one line.
  readonly text: string;
  /// The build's name from now on; null: it is as it was.
  readonly build: string | null;
}

function buildOf(text: string): string | null {
  try {
    const { build } = asObject(JSON.parse(text));
    return typeof build === 'string' && /^[0-9a-f]{16}$/.test(build) ? build : null;
  } catch {
    return null;
  }
}

/// `url`: of the hierarchy; `build`: the one that is shown. An empty view takes away what is kept.
export async function sendView(url: string, view: View, { token, build }: { readonly token: string | null; readonly build: string }): Promise<ViewAnswer> {
  const headers = { 'Content-Type': 'application/json', ...(token === null ? {} : { Authorization: `Bearer ${token}` }) };
  try {
    const response = await fetch(`${withoutLastSlashes(url)}/view?build=${build}`, { method: 'PUT', headers, body: JSON.stringify(viewToJson(view)) });
    const text = (await response.text()).trim();
    return { status: response.status, text: text || String(response.status), build: response.ok ? buildOf(text) : null };
  } catch {
    return { status: 0, text: words.firstView.unreachable, build: null };
  }
}
