// SPDX-License-Identifier: MIT
// What a view may use of a budget that it shares with others.

export interface Share {
  /// Vertices in view while the camera moves.
  readonly vertices: number;
  /// Bytes of all its tiles in memory, with their pictures.
  readonly bytes: number;
}
