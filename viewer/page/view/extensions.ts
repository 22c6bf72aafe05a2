// SPDX-License-Identifier: MIT
// The plug-ins of a view that have no part of the page: each is loaded when it is first wanted.
import type { Immersion } from '../../src/plugins/immersion.js';
import type { ImmersionMode } from '../../src/plugins/immersion_modes.js';
import type { Occlusion } from '../../src/plugins/occlusion.js';
import { words } from '../words/words.js';
import type { ViewChoices } from './view_choices.js';
import type { PageContext } from './page_context.js';

export class Extensions {
  private occlusion: Occlusion | null = null;
  private immersion: Immersion | null = null;

  constructor(private readonly context: PageContext, private readonly choices: ViewChoices) {
    context.addEventListener('chosen', () => { this.occlude(); });
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
