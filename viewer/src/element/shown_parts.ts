// SPDX-License-Identifier: MIT
// What a view shows beside look and camera: a model cut open, and some of its objects. Loaded when it is first wanted.
import { Clipping } from '../plugins/clipping.js';
import { Objects } from '../plugins/objects.js';
import type { HierarchyView } from '../scene/hierarchy_view.js';
import { Coordinates } from '../tools/coordinates.js';
import { planesInTiles, planesOf } from '../tools/planes.js';
import type { View } from '../view/view_table.js';

export class ShownParts {
  private readonly clipping = new Clipping('element clipping');
  private readonly objects = new Objects({ name: 'element objects', isAlone: false });

  constructor(private readonly view: HierarchyView) {
    view.registerPlugin(this.clipping);
    if (view.objects !== null) view.registerPlugin(this.objects);
  }

  /// Once the manifest is there.
  show(shown: View): void {
    const { manifest, objects } = this.view;
    if (manifest === null) return;
    this.clipping.cut(planesInTiles(planesOf(shown), new Coordinates(manifest)), shown.caps ?? true);
    if (objects !== null) this.showObjects(shown);
  }

  private showObjects({ object, by, between, only = [], hide = [], show = [] }: View): void {
    void this.objects.draw({ only, hidden: hide, shown: show });
    void this.objects.colourBy(by ?? null, undefined, between ?? null);
    if (object === undefined) this.objects.choose(null);
    else void this.objects.chooseNamed(object);
  }
}
