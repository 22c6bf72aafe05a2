// SPDX-License-Identifier: MIT
// Makes the code that another page is given to show a model, or this one to show it again.
import { readLink, writeLink } from '../../src/view/view_link.js';
import type { ViewPart } from '../../src/view/view_table.js';
import { formatAddress, type Spot } from '../address.js';

/// A view that is shared.
export interface SharedSpot extends Spot {
  /// Parts that its link has no room for.
  readonly leftOut: readonly ViewPart[];
}

export interface Shared extends SharedSpot {
  /// The page's address, without query and hash.
  page: string;
  name: string;
  /// The hierarchy's.
  url: string;
  /// The address of what is told about it; null: nothing, or it has none.
  story: string | null;
  /// The address of the hierarchy that it is compared with; null: it is alone.
  other: string | null;
  /// The page has the hierarchy within it: there is no code for others.
  isWhole: boolean;
}

const ESCAPES: Readonly<Record<string, string>> = { '&': '&amp;', '"': '&quot;', '<': '&lt;', '>': '&gt;' };

function escaped(text: string): string {
  return text.replace(/[&"<>]/g, (sign) => ESCAPES[sign]);
}

/// Relative to the page where it lies below it: the page may be called by several names.
export function parameterOf(url: string, page: string): string {
  const folder = new URL('.', page).href;
  return encodeURIComponent(url.startsWith(folder) ? url.slice(folder.length) : url).replace(/%2F/g, '/').replace(/%3A/g, ':');
}

/// A page that shows the model alone.
export function addressAlone(shared: Shared): string {
  const { page, url, story, other, pose, choices } = shared;
  const hash = pose === null && choices === '' ? '' : formatAddress({ path: '', pose, choices });
  const told = story === null ? '' : `&story=${parameterOf(story, page)}`;
  const beside = other === null ? '' : `&with=${parameterOf(other, page)}`;
  return `${page}?model=${parameterOf(url, page)}${beside}${told}${hash}`;
}

export function frameCode(shared: Shared): string {
  const address = escaped(addressAlone(shared));
  return `<iframe src="${address}" title="${escaped(shared.name)}" width="640" height="480" style="border: 0" loading="lazy" allow="fullscreen"></iframe>`;
}

/// Loads the script that lies beside the page. The element knows neither notes nor stories: they are left out.
export function elementCode({ page, name, url, pose, choices }: Shared): string {
  const view = writeLink({ ...readLink(choices), notes: undefined, story: undefined });
  const camera = pose === null ? '' : ` camera="${[...pose.position, ...pose.target].join(',')}"`;
  return `<script type="module" src="${escaped(new URL('meshhier-viewer.js', page).href)}"></script>\n` +
    `<meshhier-viewer src="${escaped(url)}" label="${escaped(name)}"${camera}${view === '' ? '' : ` view="${escaped(view)}"`} style="height: 480px"></meshhier-viewer>`;
}
