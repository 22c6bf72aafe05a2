// SPDX-License-Identifier: MIT
// From a viewpoint to the tiles that are drawn, and those that are asked for.
import type { Cone } from '../hierarchy/normals.js';
import type { TileIndex, TileRecord } from '../hierarchy/tile_index.js';
import { keyOf, type Node, type Tree } from '../hierarchy/tree.js';
import { chooseCut, LOADING, type Choice, type ChosenNode, type Sources } from './choose_cut.js';
import { RestDetail } from './rest_detail.js';
import type { TileStore, Wanted } from './tile_store.js';
import { comesFromOutside, looksAway, type Viewpoint } from './viewpoint.js';
import { windingNumber } from './winding.js';

export interface RefinementLimits {
  readonly threshold: number;
  /// At rest the error is divided by it: see RestDetail.
  readonly restDetail: number;
  readonly vertices: number;
  /// No tile of a finer level; Infinity: any.
  readonly mostLevel: number;
  /// The camera stands still.
  readonly atRest: boolean;
}

export interface Refined {
  /// A cut of tiles that are all there: as the view asks for, or coarser.
  readonly drawn: readonly ChosenNode[];
  /// More would be drawn if more of these were allowed.
  readonly limited: Choice['limited'];
  /// As the choice has them.
  readonly bytes: number;
  /// Nothing is missing that the view asks for.
  readonly isComplete: boolean;
  /// More is asked for after a while.
  readonly isPausing: boolean;
}

/// Bytes that a tile may take, by its record.
export type MostMemory = (record: TileRecord, node: Node) => number;

function opposite({ axis: [x, y, z], cosine }: Cone): Cone {
  return { axis: [-x, -y, -z], cosine };
}

const ROOT = keyOf(0, 0);
/// Finer tiles have normals that their parents have not: so much more must a tile look away.
const HIDDEN_MARGIN = 0.1;
/// At rest, when there is time for what hardly ever shows.
const HIDDEN_MARGIN_AT_REST = 0.35;
/// More still, once refined, while the camera moves.
const HYSTERESIS_MARGIN = 0.2;
/// At rest nothing is remembered: the cut is the same whatever was seen before.
const NONE: ReadonlySet<number> = new Set();
/// A point is outside of a closed surface if less of it goes around.
const OUTSIDE = 0.25;

export class Refinement {
  /// Backs are seen from outside, too: the model is cut open.
  showsInside = false;
  /// No backs are seen, from wherever.
  hidesBacks = false;
  private refined: ReadonlySet<number> = NONE;
  /// The last drawing showed these finer.
  private shown = new Set<number>();
  private readonly detail = new RestDetail();

  constructor(
    private readonly tree: Tree,
    private readonly index: TileIndex,
    private readonly store: TileStore,
    private readonly mostMemory: MostMemory,
  ) {}

  /// null: not even the root is known.
  refine(view: Viewpoint, limits: RefinementLimits, now: number): Refined | null {
    const { threshold, restDetail, atRest } = limits;
    const divisor = this.detail.step(now, atRest, restDetail);
    const choice = chooseCut(this.sources(view, atRest, now), view, { ...limits, fine: threshold / restDetail, bytes: this.store.budget });
    if (choice.root === null) return null;
    const asked = choice.refined.filter((chosen) => chosen.pixels > threshold / divisor || this.isThere(chosen) || !atRest);
    const isStepComplete = this.store.want(this.wanted(asked), now) === 0 && !choice.incomplete;
    this.detail.saw(now, atRest && isStepComplete);
    const isComplete = isStepComplete && asked.length === choice.refined.length;
    const shown = Math.min(threshold, threshold / (isStepComplete ? divisor : divisor / 2));
    const drawn = this.draw(choice.root, atRest && !isComplete ? shown : 0);
    this.refined = atRest ? this.shown : new Set(choice.refined.map(({ key }) => key));
    return { drawn, limited: choice.limited, bytes: choice.bytes, isComplete, isPausing: isStepComplete && !isComplete };
  }

  /// Finer than `shown`, an error in pixels, is drawn only what was before: all else at once, when its step is complete.
  private draw(root: ChosenNode, shown: number): ChosenNode[] {
    const drawn: ChosenNode[] = [];
    const before = this.shown;
    this.shown = new Set();
    const collect = (chosen: ChosenNode): void => {
      if (!this.isThere(chosen) || (chosen.pixels <= shown && !before.has(chosen.key))) {
        drawn.push(chosen);
        return;
      }
      this.shown.add(chosen.key);
      for (const child of chosen.children) collect(child);
    };
    collect(root);
    return drawn;
  }

  /// True where it can be drawn finer.
  private isThere({ children }: ChosenNode): boolean {
    return children.length > 0 && children.every(({ key }) => this.store.has(key));
  }

  private sources(view: Viewpoint, atRest: boolean, now: number): Sources {
    const culls = this.hidesBacks || this.isOutside(view);
    const margin = atRest ? HIDDEN_MARGIN_AT_REST : HIDDEN_MARGIN;
    const before = atRest ? NONE : this.refined;
    return {
      tree: this.tree,
      record: (node) => this.index.record(node),
      bytesOf: this.mostMemory,
      isLost: (node) => this.index.isLost(node) || this.store.isGivenUp(keyOf(node.level, node.index), now),
      isHidden: (key, record) => culls && this.isHidden(view, key, record, margin + (before.has(key) ? HYSTERESIS_MARGIN : 0)),
      wasRefined: (key) => before.has(key),
      mayBeFine: (key) => atRest || before.has(key),
    };
  }

  /// From outside of a closed surface none of its back is seen.
  private isOutside(view: Viewpoint): boolean {
    const root = this.store.get(ROOT)?.tile;
    if (!root?.closed || this.showsInside) return false;
    const [a, b, c, d, e, f] = root.box;
    if (view.towards !== undefined) return comesFromOutside(view, { min: [a, b, c], max: [d, e, f] });
    const { eye } = view;
    const inBox = eye.every((value, axis) => value >= root.box[axis] && value <= root.box[axis + 3]);
    return !inBox || Math.abs(windingNumber(root, eye)) < OUTSIDE;
  }

  private isHidden(view: Viewpoint, key: number, record: TileRecord, margin: number): boolean {
    const cone = this.store.get(key)?.tile.cone;
    if (cone === undefined) return false;
    const isTurned = !this.hidesBacks && this.store.get(ROOT)!.tile.insideOut;
    return looksAway(view, record, isTurned ? opposite(cone) : cone, margin);
  }

  private wanted(refined: readonly ChosenNode[]): Wanted[] {
    return refined.flatMap(({ children }) =>
      children.map(({ node, record }) => ({ node, record, loadingBytes: LOADING * this.mostMemory(record, node) })),
    );
  }
}
