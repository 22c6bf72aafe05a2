// SPDX-License-Identifier: MIT
/// What is wrong with a file, and which one it is. Everything in this library throws these for bad
/// input; anything else is a defect.
export class HierarchyProblem extends Error {
  override readonly name = 'HierarchyProblem';
  /// `mayPass`: it is the host or the line; the same may succeed later.
  constructor(
    file: string,
    readonly what: string,
    readonly mayPass = false,
  ) {
    super(`${file}: ${what}`);
  }
}
