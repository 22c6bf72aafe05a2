// SPDX-License-Identifier: MIT
// How a model is shown while a story is told, and how before.
import { withChoices, type Appearance } from '../appearance.js';

export class ToldLook {
  private before: Appearance | null = null;
  private told: Appearance | null = null;

  /// A note wants to be seen so, on top of what was chosen before the story; `now`: what is chosen.
  tell(choices: string, now: Appearance): Appearance {
    if (this.before === null || now !== this.told) this.before = now;
    this.told = withChoices(choices, { ...this.before });
    return this.told;
  }

  /// As before the story, unless the visitor has chosen something since.
  end(now: Appearance): Appearance {
    const then = now === this.told && this.before !== null ? this.before : now;
    this.before = this.told = null;
    return then;
  }
}
