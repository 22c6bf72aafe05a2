// SPDX-License-Identifier: MIT
// The script for other pages, meshhier-viewer.js: the element with all that it needs, in one file; pages with
// pictures in KTX2 load meshhier-ktx2.js beside it.
import TileWorker from '../src/hierarchy/tile_worker.js?worker&inline';
import { setTranscoderUrl } from '../src/hierarchy/basis.js';
import { MeshhierViewerElement } from '../src/element/index.js';

MeshhierViewerElement.createWorker = () => new TileWorker();
setTranscoderUrl(new URL(/* @vite-ignore */ './meshhier-ktx2.js', import.meta.url).href);
