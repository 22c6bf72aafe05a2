// Whether keys or a pointer were used last, for what only those who work with keys need.

export function watchInput(): void {
  const note = (input: 'keys' | 'pointer') => (): void => { document.documentElement.dataset.input = input; };
  window.addEventListener('keydown', note('keys'), { capture: true });
  window.addEventListener('pointerdown', note('pointer'), { capture: true });
}
