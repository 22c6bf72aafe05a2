// SPDX-License-Identifier: MIT
// Contrast of texts, by WCAG 2.1, section 1.4.3: 4.5 at least; of what only draws, 3.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';

type Colour = readonly [number, number, number];

const STYLE = readFileSync(new URL('../../page/style/base.css', import.meta.url), 'utf8');

/// The custom properties of a rule that are plain colours.
function colours(rule: string): Record<string, Colour> {
  const body = STYLE.slice(STYLE.indexOf(`${rule} {`)).split('}')[0];
  return Object.fromEntries([...body.matchAll(/--([\w-]+): #([0-9a-f]{6})/g)].map(([, name, digits]) => {
    const value = parseInt(digits, 16);
    return [name, [value >> 16, (value >> 8) & 255, value & 255]];
  }));
}

function luminance(colour: Colour): number {
  const [r, g, b] = colour.map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: Colour, b: Colour): number {
  const [dark, light] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (light + 0.05) / (dark + 0.05);
}

/// Returns 84 % card over the stage, as bars and badges have it.
function veil(card: Colour, below: Colour): Colour {
  const mixed = card.map((value, k) => 0.84 * value + 0.16 * below[k]);
  return [mixed[0], mixed[1], mixed[2]];
}

describe.each([':root', ":root[data-theme='dark']"])('the colours of %s', (rule) => {
  const of = colours(rule);
  const grounds = { ground: of.ground, card: of.card, veil: veil(of.card, of['stage-edge']), brightVeil: veil(of.card, of['stage-middle']) };

  it.each(Object.entries(grounds))('can be read on %s', (_, ground) => {
    for (const name of ['ink', 'soft', 'accent', 'alarm']) expect(contrast(of[name], ground), name).toBeGreaterThanOrEqual(4.5);
  });

  it('show outlines and the focus', () => {
    for (const name of ['outline', 'accent']) expect(contrast(of[name], of.card), name).toBeGreaterThanOrEqual(3);
  });
});
