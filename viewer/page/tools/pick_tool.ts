// SPDX-License-Identifier: MIT
// Coordinates of a point, as the input has them.
import type { PickedPoint } from '../../src/tools/picked_point.js';
import { copyText } from '../parts/clipboard.js';
import { checkbox } from '../parts/controls.js';
import { element } from '../parts/element.js';
import { figureList, figures, textButton } from './figures.js';
import { INNER_KEYS, isKey } from './keys.js';
import type { Mark } from '../../src/plugins/overlay.js';
import type { Tool } from './tool.js';
import { words } from './words/words.js';
import type { Workshop } from './workshop.js';

const NORMAL_DIGITS = 5;
const DEGREE_DIGITS = 9;
const VALUE_DIGITS = 7;

type State = 'refining' | 'done' | 'missing';

/// Writes all digits that a double has.
function coordinates({ point }: PickedPoint): string[] {
  return point.map((value) => (Object.is(value, -0) ? '-0' : String(value)));
}

function globeRows({ globe }: PickedPoint): (readonly [string, string])[] {
  if (globe === null) return [];
  const { longitude, latitude, height } = globe;
  return [
    [words.pick.longitude, `${longitude.toFixed(DEGREE_DIGITS)}°`],
    [words.pick.latitude, `${latitude.toFixed(DEGREE_DIGITS)}°`],
    [words.pick.height, `${height.toFixed(4)} m`],
  ];
}

/// As the tiles have them: of floats.
function valueRows({ values }: PickedPoint): (readonly [string, string])[] {
  return values.map(({ name, value, label }) => [name, label || (value === null ? '–' : String(Number(value.toPrecision(VALUE_DIGITS))))]);
}

function originOf(picked: PickedPoint, state: State): string {
  const { isOriginal, level, index } = picked;
  const from = isOriginal ? words.pick.original(String(index)) : words.pick.level(String(level));
  return state === 'refining' && !isOriginal ? words.pick.refining(from) : from;
}

function rowsOf(picked: PickedPoint, state: State): (readonly [string, string])[] {
  const [x, y, z] = coordinates(picked);
  const normal = picked.normal.map((value) => value.toFixed(NORMAL_DIGITS)).join(', ');
  return [['x', x], ['y', y], ['z', z], [words.pick.normal, normal], ...globeRows(picked), ...valueRows(picked), [words.pick.from, originOf(picked, state)]];
}

export class PickTool implements Tool {
  readonly root: HTMLElement;
  private readonly list = figureList();
  private readonly note = element('p', { class: 'tool-note' }, words.pick.hint);
  private readonly snap = checkbox(words.pick.snap, INNER_KEYS.snap, (on) => { this.setSnap(on); });
  private readonly copy = textButton(words.pick.copy, () => void this.copyPoint());
  private picked: PickedPoint | null = null;
  private place: readonly [number, number] | null = null;
  private asking = new AbortController();

  constructor(private readonly shop: Workshop) {
    this.copy.hidden = true;
    this.snap.show(shop.settings.snaps);
    this.root = element('div', {}, this.note, this.list, this.snap.root, this.copy);
  }

  choose(right: number, up: number): void {
    this.place = [right, up];
    void this.pick(right, up);
  }

  key(key: string): boolean {
    if (!isKey(key, 'snap')) return false;
    this.setSnap(!this.shop.settings.snaps);
    return true;
  }

  undo(): boolean {
    const had = this.picked !== null;
    this.asking.abort();
    this.place = null;
    if (had) this.show(null, 'done');
    return had;
  }

  marks(): readonly Mark[] {
    return this.picked ? [{ at: this.picked.local }] : [];
  }

  close(): void {
    this.asking.abort();
  }

  /// The place chosen last is looked at again, if the camera has not moved since.
  private setSnap(on: boolean): void {
    this.shop.setSettings({ snaps: on });
    this.snap.show(on);
    if (this.place !== null) this.choose(...this.place);
  }

  private async pick(right: number, up: number): Promise<void> {
    this.asking.abort();
    this.asking = new AbortController();
    const { signal } = this.asking;
    const pointed = this.shop.pointing.at(right, up, this.shop.settings.snaps, signal);
    this.show(pointed?.shown ?? null, 'refining');
    if (pointed === null) return;
    const original = await pointed.original.catch(() => null);
    if (!signal.aborted) this.show(original ?? pointed.shown, original ? 'done' : 'missing');
  }

  private show(picked: PickedPoint | null, state: State): void {
    this.picked = picked;
    this.list.replaceChildren(...(picked ? figures(rowsOf(picked, state)) : []));
    this.copy.hidden = picked === null;
    this.copy.textContent = words.pick.copy;
    this.note.textContent = picked === null ? words.pick.hint : picked.isExact ? words.pick.exact : state === 'missing' ? words.pick.notThere : '';
    this.shop.bench.redraw();
  }

  private async copyPoint(): Promise<void> {
    if (this.picked === null) return;
    const isCopied = await copyText(coordinates(this.picked).join(' '));
    this.copy.textContent = isCopied ? words.pick.copied : words.pick.notCopied;
  }
}

export function makeTool(shop: Workshop): Tool {
  return new PickTool(shop);
}
