// SPDX-License-Identifier: MIT
// All around a model's picture: what is not needed to see and to turn it. Comes once the first picture is drawn.
import type { Spot } from '../address.js';
import { Chrome } from './chrome.js';
import type { FirstParts } from './first_parts.js';
import { listenToKeys } from './keys.js';
import { ViewParts } from './view_parts.js';

export class Furniture {
  readonly parts: ViewParts;

  /// `spot`: as the link says that the visitor followed last.
  constructor(first: FirstParts, spot: Spot) {
    const parts = new ViewParts(first);
    this.parts = parts;
    const { context, camera, choices, frames } = parts;
    const chrome = new Chrome(parts);
    listenToKeys(parts, chrome);
    parts.follow(spot);
    context.addEventListener('rested', () => { context.arrival.entry.write(parts.spot()); });
    if (!camera.navigation.atHome) context.startRest(); // it was moved before anything could write that down
    choices.show();
    if (context.page.preferences.panel) chrome.panel.open();
    void parts.pair.begin();
    frames.reportSoon();
  }
}
