// SPDX-License-Identifier: MIT
// The plug-ins of a view that have no part of the page: each is loaded when it is first wanted.
import type { Dollhouse } from '../../src/plugins/dollhouse.js';
import type { Immersion } from '../../src/plugins/immersion.js';
import type { ImmersionMode } from '../../src/plugins/immersion_modes.js';
import type { Occlusion } from '../../src/plugins/occlusion.js';
import { readLink, writeLink } from '../../src/view/view_link.js';
import { words } from '../words/words.js';
import type { ViewChoices } from './view_choices.js';
import type { PageContext } from './page_context.js';

/// The plug-in that every view of the page has.
export const DOLLHOUSE = 'page dollhouse';

export class Extensions {
  private dollhouse: Dollhouse | null = null;
  private wished: Dollhouse['mode'] = 'auto';
  private occlusion: Occlusion | null = null;
  private immersion: Immersion | null = null;

  constructor(private readonly context: PageContext, private readonly choices: ViewChoices) {
    context.addEventListener('chosen', () => { this.occlude(); });
    context.addEventListener('known', () => { if (this.dollhouse === null) this.openRooms().catch(() => undefined); });
  }

  async immerse(mode: ImmersionMode): Promise<void> {
    const { context } = this;
    const { view, signal } = context;
    if (view.manifest === null) return;
    try {
      const { Immersion } = await import('../../src/plugins/immersion.js');
      if (signal.aborted) return;
      if (this.immersion === null) {
        const immersion = new Immersion('page immersion');
        view.registerPlugin(immersion);
        this.immersion = immersion;
      }
      await this.immersion.start(mode);
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      context.page.problems.tell(words.problems.noImmersion, { more: why, subject: 'immersion' });
    }
  }

  /// As links have it; empty: nothing was chosen.
  get text(): string {
    return writeLink({ dollhouse: this.dollhouse?.mode ?? this.wished });
  }

  /// As a link says.
  follow(choices: string): void {
    this.wished = readLink(choices).dollhouse ?? 'auto';
    if (this.dollhouse !== null) this.dollhouse.mode = this.wished;
  }

  /// Looks into rooms, once there is a first picture: what the model is, is found out then. Without its code the page shows all faces.
  private async openRooms(): Promise<void> {
    const { view, signal } = this.context;
    const { Dollhouse } = await import('../../src/plugins/dollhouse.js');
    if (signal.aborted || this.dollhouse !== null) return;
    const dollhouse = new Dollhouse(DOLLHOUSE);
    dollhouse.mode = this.wished;
    this.dollhouse = dollhouse;
    dollhouse.addEventListener('change', () => { this.context.startRest(); });
    view.registerPlugin(dollhouse);
  }

  /// Gives hollows less light, or as much as all else, as it is chosen.
  private occlude(): void {
    const { context: { isOpened, view }, choices: { chosen: { light: { occlusion: isWanted } } } } = this;
    if (!isOpened || isWanted === (this.occlusion !== null)) return;
    if (isWanted) {
      this.loadOcclusion().catch(() => { this.context.missCode(() => { this.occlude(); }); });
      return;
    }
    view.unregisterPlugin(this.occlusion!);
    this.occlusion = null;
  }

  private async loadOcclusion(): Promise<void> {
    const { Occlusion } = await import('../../src/plugins/occlusion.js');
    const { context: { signal, view }, choices: { chosen } } = this;
    if (signal.aborted || this.occlusion !== null || !chosen.light.occlusion) return; // it may have been switched off meanwhile
    const occlusion = new Occlusion('page occlusion');
    view.registerPlugin(occlusion);
    this.occlusion = occlusion;
  }
}
