// SPDX-License-Identifier: MIT
// Counts what differences save: a client without memory would be sent each view whole (Lluch et al.).

export interface ShownFile {
  readonly bytes: number;
  /// The number of the movement in which it was fetched.
  readonly epoch: number;
}

export class Account {
  fetchedBytes = 0;
  fetchedFiles = 0;
  wholeViewBytes = 0;
  hits = 0;
  /// Raised by each movement.
  epoch = 0;
  private settledEpoch = -1;

  fetched(bytes: number): void {
    this.fetchedBytes += bytes;
    ++this.fetchedFiles;
  }

  /// The view of this epoch is complete: counted once.
  settled(files: readonly ShownFile[]): void {
    if (this.settledEpoch === this.epoch) return;
    this.settledEpoch = this.epoch;
    for (const { bytes, epoch } of files) {
      this.wholeViewBytes += bytes;
      if (epoch < this.epoch) ++this.hits;
    }
  }

  get savedBytes(): number {
    return Math.max(0, this.wholeViewBytes - this.fetchedBytes);
  }
}
