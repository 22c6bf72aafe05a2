// SPDX-License-Identifier: MIT
// The browser's checks have it, too.
export { house, HOUSE, plyOf, type HouseMesh, type Plan } from '../../../tests/web/house.mjs';
