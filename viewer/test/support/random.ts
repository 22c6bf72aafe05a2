// SPDX-License-Identifier: MIT
// The browser's checks have it, too: served to pages as it is.
export { random } from '../../../tests/web/random.mjs';
