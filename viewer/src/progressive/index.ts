// SPDX-License-Identifier: MIT
export { ProgressiveMesh, type Step } from './progressive_mesh.js';
export { StreamError, type StreamIndex } from './stream_index.js';
