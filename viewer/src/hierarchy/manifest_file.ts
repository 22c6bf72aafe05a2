// SPDX-License-Identifier: MIT
/// The manifest's file in a hierarchy.
export const MANIFEST = 'hierarchy.json';
export const MOST_MANIFEST_BYTES = 2 ** 20;
