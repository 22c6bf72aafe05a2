// SPDX-License-Identifier: MIT
// Which build of a hierarchy its files are of. The manifest's checksum names it: it covers that of the index, which covers those of all tiles.
import { fetchHostManifest } from './manifest.js';
import { MANIFEST } from './manifest_file.js';
import { HierarchyProblem, HierarchyReplaced } from './problem.js';
import type { RemoteFiles } from './files.js';

export class Build {
  private running: Promise<void> = Promise.resolve();
  private next: Promise<void> | null = null; // has not begun

  /// `name`: as the manifest that was read has it. `signal`: ends all that is under way.
  constructor(
    private readonly files: RemoteFiles,
    public name: string,
    private readonly signal: AbortSignal,
  ) {}

  /// Asks the host which build it has now, after this call: what came before it is of this one if that is. Calls that come together ask once.
  /// Throws HierarchyReplaced, and as fetchHostManifest().
  confirm(): Promise<void> {
    if (this.next !== null) return this.next;
    const next = this.running.catch(() => undefined).then(() => {
      this.next = null;
      this.running = this.look();
      return this.running;
    });
    this.next = next;
    return next;
  }

  /// Returns what a problem is due to: HierarchyReplaced where the host has another build by now, else the problem itself.
  async explain(problem: unknown): Promise<unknown> {
    if (!(problem instanceof HierarchyProblem) || problem instanceof HierarchyReplaced || problem.mayPass) return problem;
    try {
      await this.confirm();
      return problem;
    } catch (found) {
      return found instanceof HierarchyReplaced ? found : problem;
    }
  }

  private async look(): Promise<void> {
    const { build } = await fetchHostManifest(this.files, this.signal);
    if (build !== this.name) throw new HierarchyReplaced(MANIFEST);
  }
}
