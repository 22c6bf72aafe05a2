// SPDX-License-Identifier: MIT
// Stands within the page itself, before all else: asks for everything that the first picture of a model needs as soon as the address is known.
//
//   page ─┬─ its own script ── gallery
//         └─ boot ─┬─ the model's picture: shown at once
//                  ├─ the root tile, after that
//                  └─ code of the view
//
// What the address means is told by app.ts: where this takes it for something else, what is begun here is of no use, and does no harm.
import { Poster } from './poster.js';
import { resolveHierarchy } from './hierarchy_url.js';
import { sendFirstRequest } from './first_request.js';
import { nameOfPath } from './path_name.js';
import { isArchiveUrl } from '../src/hierarchy/archive_format.js';
import { withoutLastSlashes } from '../src/hierarchy/bytes.js';
import { DEFAULT_LOOK } from '../src/scene/settings.js';

/// The files of the view's code, relative to the page.
declare const VIEW_FILES: readonly string[];

interface Stored {
  theme?: string;
  look?: Record<string, unknown>;
  light?: { name?: string; key?: unknown; occlusion?: boolean };
  standings?: Record<string, unknown>;
}

function stored(): Stored {
  try {
    return (JSON.parse(localStorage.getItem('meshhier') ?? '{}') ?? {}) as Stored;
  } catch {
    return {};
  }
}

/// Models are shown as their hierarchies' pictures show them, unless something else was chosen here before.
function isPlain({ look = {}, light = {}, standings = {} }: Stored, url: string): boolean {
  const isUsual = Object.entries(DEFAULT_LOOK).every(([name, value]) => !(name in look) || JSON.stringify(look[name]) === JSON.stringify(value));
  return isUsual && (light.name ?? 'auto') === 'auto' && light.key == null && light.occlusion !== true && standings[url] === undefined;
}

/// The path of the model that is opened, what is relative to, and whether a link says how it is looked at; null: none is.
function asked(): { path: string; base: string; isElsewhere: boolean } | null {
  const parameters = new URLSearchParams(location.search);
  const [name, ...view] = location.hash.slice(1).split('&');
  const [model, base] = [parameters.get('model'), document.baseURI];
  if (model !== null) return { path: model, base, isElsewhere: view.length > 0 };
  return name === '' ? null : { path: name, base: new URL(parameters.get('models') ?? 'models.json', base).href, isElsewhere: view.length > 0 };
}

function preloadCode(): void {
  for (const href of VIEW_FILES) {
    const kind = href.endsWith('.css') ? { rel: 'preload', as: 'style' } : { rel: 'modulepreload' };
    document.head.append(Object.assign(document.createElement('link'), { ...kind, href, crossOrigin: '' }));
  }
}

function showTheme(theme = 'auto'): void {
  document.documentElement.dataset.theme = theme !== 'auto' ? theme : matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}

/// `url`: of a directory, which may end in a slash.
function posterOf(url: string): Poster {
  return new Poster(`${withoutLastSlashes(url)}/preview.webp`, nameOfPath(url));
}

function boot(): void {
  const model = asked();
  const url = model && resolveHierarchy(model.path, model.base);
  if (url === null) return;
  const choices = stored();
  const savesData = (navigator as { connection?: { saveData?: boolean } }).connection?.saveData === true;
  const isPictured = !model!.isElsewhere && !savesData && !isArchiveUrl(url) && isPlain(choices, url);
  showTheme(choices.theme);
  const poster = isPictured ? posterOf(url) : null;
  preloadCode();
  globalThis.meshhierBooted = { url, first: sendFirstRequest(url, poster?.came), poster };
}

boot();
