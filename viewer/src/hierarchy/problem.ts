// SPDX-License-Identifier: MIT

/// Milliseconds until a host whose problem may pass is asked again.
export const AGAIN = 20_000;

/// Problems say what is wrong with a file, and which one it is. Everything in this library throws them for bad
/// input; anything else is a defect.
export class HierarchyProblem extends Error {
  override readonly name: string = 'HierarchyProblem';
  /// `mayPass`: it is the host or the line; the same may succeed later.
  constructor(
    file: string,
    readonly what: string,
    readonly mayPass = false,
  ) {
    super(`${file}: ${what}`);
  }
}

/// A file is of another build than what was read before: the hierarchy was replaced on its host. What was read still fits together; the rest
/// is to be had no more.
export class HierarchyReplaced extends HierarchyProblem {
  override readonly name = 'HierarchyReplaced';
  constructor(file: string) {
    super(file, 'another model is there by now: this one was replaced since it was opened');
  }
}
