// SPDX-License-Identifier: MIT
// Whether the focus is moved by keys, for what only those who do so need.

export function watchInput(): void {
  const note = (input: 'keys' | 'pointer'): void => { document.documentElement.dataset.input = input; };
  window.addEventListener('keydown', ({ key }) => { if (key === 'Tab') note('keys'); }, { capture: true });
  window.addEventListener('pointerdown', () => { note('pointer'); }, { capture: true });
}
