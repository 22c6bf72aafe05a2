// SPDX-License-Identifier: MIT
// Importing this makes `<meshhier-viewer>` known to the page.
import { defineViewer } from './viewer_element.js';

export { defineViewer, MeshhierViewerElement } from './viewer_element.js';

defineViewer();
