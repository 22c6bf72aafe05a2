// SPDX-License-Identifier: MIT
// How the page goes from one view to another. Within a frame it leaves no entries behind: the browser's Back belongs to the page
// around it.

const FRAMED = window.parent !== window;

/// Goes to another hash of this page.
export function visit(hash: string): void {
  if (FRAMED) location.replace(hash);
  else location.hash = hash;
}

/// Shows another address without loading it, and without telling anyone.
export function showAddress(address: string): void {
  if (FRAMED) history.replaceState(null, '', address);
  else history.pushState(null, '', address);
}

/// Tells whether going back leads to where the visitor was before.
export const leavesEntries = !FRAMED;

/// Links to hashes within `root` are visits, too.
export function watchLinks(root: HTMLElement): void {
  if (!FRAMED) return;
  root.addEventListener('click', (event) => {
    const hash = (event.target as Element).closest('a')?.getAttribute('href');
    if (hash?.startsWith('#') !== true || event.defaultPrevented || event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    visit(hash);
  });
}
