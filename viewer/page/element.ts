// SPDX-License-Identifier: MIT
// The script for other pages, meshhier-viewer.js: the element with all that it needs, in one file; pages with
// pictures in KTX2 load meshhier-ktx2.js beside it, or from where `<link id="meshhier-ktx2">` says. `src="#meshhier-hierarchy"` is the
// hierarchy within the page itself.
import TileWorker from '../src/hierarchy/tile_worker.js?worker&inline';
import { setTranscoderUrl } from '../src/hierarchy/basis.js';
import { MeshhierViewerElement } from '../src/element/index.js';
import { embeddedModel, ID } from './embedded.js';

/// Where the transcoder lies. Undefined: nobody says, and this script itself lies nowhere, but within a page.
function findTranscoder(): string | undefined {
  const said = document.querySelector<HTMLLinkElement>('link#meshhier-ktx2');
  if (said !== null) return said.href;
  return /^(https?|file):/.test(import.meta.url) ? new URL(/* @vite-ignore */ './meshhier-ktx2.js', import.meta.url).href : undefined;
}

MeshhierViewerElement.createWorker = () => new TileWorker();
MeshhierViewerElement.filesOf = (url) => (url === new URL(`#${ID}`, document.baseURI).href ? embeddedModel(document)?.files : undefined);
setTranscoderUrl(findTranscoder());
