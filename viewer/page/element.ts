// SPDX-License-Identifier: MIT
// The script for other pages, meshhier-viewer.js: the element with all that it needs, in one file.
import TileWorker from '../src/hierarchy/tile_worker.js?worker&inline';
import { MeshhierViewerElement } from '../src/element/index.js';

MeshhierViewerElement.createWorker = () => new TileWorker();
