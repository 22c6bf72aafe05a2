// SPDX-License-Identifier: MIT
// In place of the transcoder of KTX2 where it is a script of its own, or a worker's.
export const createBasis = (): Promise<never> => Promise.reject(new Error('the transcoder of KTX2 is elsewhere'));
export const WASM = '';
