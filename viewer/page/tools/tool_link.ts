// SPDX-License-Identifier: MIT
// What the page's address tells of a tool, between links and the tool: `NAME=VALUE` of its keys, with & between; '': nothing.

export class ToolLink {
  private readonly listeners: (() => void)[] = [];

  /// `text`: what the address had; `put`: puts another one there, or takes it away.
  constructor(private link: string, private readonly put: (link: string) => void) {}

  get text(): string {
    return this.link;
  }

  onFollow(listener: () => void): void {
    this.listeners.push(listener);
  }

  /// Another link is followed.
  follow(link: string): void {
    if (link === this.link) return;
    this.link = link;
    for (const listener of this.listeners) listener();
  }

  write(link: string): void {
    if (link === this.link) return;
    this.link = link;
    this.put(link);
  }
}
