// SPDX-License-Identifier: MIT
// Makes elements. Texts are set as text, never as markup.

type Child = Node | string | null;

/// `attributes`: null leaves one out, true sets it empty.
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Readonly<Record<string, string | boolean | null>> = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) made.setAttribute(name, value === true ? '' : value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

const SVG = 'http://www.w3.org/2000/svg';

/// A drawing of strokes on a grid of 24, for an element that has a name of its own.
export function icon(path: string): SVGSVGElement {
  const drawing = document.createElementNS(SVG, 'svg');
  for (const [name, value] of Object.entries({ viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true', focusable: 'false' }))
    drawing.setAttribute(name, value);
  const stroke = document.createElementNS(SVG, 'path');
  stroke.setAttribute('d', path);
  drawing.append(stroke);
  return drawing;
}

/// A button that shows a drawing; `name` is its accessible name and its tip.
export function iconButton(name: string, path: string, act: () => void): HTMLButtonElement {
  const button = element('button', { type: 'button', class: 'button', 'aria-label': name, title: name });
  button.append(icon(path));
  button.addEventListener('click', act);
  return button;
}
