// SPDX-License-Identifier: MIT
// As much of a document as parts of the page need that are tested without a browser.
import { vi } from 'vitest';

export class FakeElement extends EventTarget {
  readonly attributes = new Map<string, string>();
  readonly style = { setProperty: (): void => undefined };
  readonly classList = { add: (): void => undefined };
  children: (FakeElement | string)[] = [];
  isConnected = true;
  hidden = false;

  setAttribute(name: string, value: string): void {
    this.attributes.set(name, value);
  }

  removeAttribute(name: string): void {
    this.attributes.delete(name);
  }

  append(...children: (FakeElement | string)[]): void {
    this.children.push(...children);
  }

  replaceChildren(...children: (FakeElement | string)[]): void {
    this.children = children;
  }

  get textContent(): string {
    return this.children.map((child) => (typeof child === 'string' ? child : child.textContent)).join('');
  }

  set textContent(text: string) {
    this.children = [text];
  }

  after(): void { /* rows that follow are not looked at */ }
  replaceWith(): void { /* nor is what is in its place */ }
  scrollIntoView(): void { /* nothing scrolls */ }
  focus(): void { /* nothing is typed */ }
}

/// The page has such a document until `vi.unstubAllGlobals()`.
export function fakePage(): void {
  vi.stubGlobal('document', { createElement: () => new FakeElement(), createElementNS: () => new FakeElement() });
}

/// What a part of the page made, as what it is here.
export function faked(element: unknown): FakeElement {
  return element as FakeElement;
}
