// SPDX-License-Identifier: MIT
// How a model is shown while a story is told, and how before.

/// `State`: another object after each change.
export class Told<State extends object> {
  private before: State | null = null;
  private told: State | null = null;

  /// `withChoices`: what a link says, on top of what is given, as an object of its own.
  constructor(private readonly withChoices: (choices: string, given: State) => State) {}

  /// A note wants to be seen so, on top of what was chosen before the story; `now`: what is chosen.
  tell(choices: string, now: State): State {
    if (this.before === null || now !== this.told) this.before = now;
    this.told = this.withChoices(choices, { ...this.before });
    return this.told;
  }

  /// As before the story, unless the visitor has chosen something since.
  end(now: State): State {
    const then = now === this.told && this.before !== null ? this.before : now;
    this.before = this.told = null;
    return then;
  }
}
