// SPDX-License-Identifier: MIT
// What the page's address tells of objects, between links and the tool.

export class ObjectLinkStore {
  private readonly listeners: (() => void)[] = [];

  /// `text`: what the address had; `put`: puts another one there, or takes it away.
  constructor(private link: string | null, private readonly put: (link: string | null) => void) {}

  get text(): string | null {
    return this.link;
  }

  onFollow(listener: () => void): void {
    this.listeners.push(listener);
  }

  /// Another link is followed.
  follow(link: string | null): void {
    if (link === this.link) return;
    this.link = link;
    for (const listener of this.listeners) listener();
  }

  write(link: string | null): void {
    if (link === this.link) return;
    this.link = link;
    this.put(link);
  }
}
