// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import type { Manifest } from '../../src/index.js';
import { factsOf, summaryOf } from '../../page/info/facts.js';
import { modelOfPath } from '../../page/listing.js';

const MODEL = modelOfPath('david.hier', 'http://host/models.json')!;
const MANIFEST = {
  source: {
    fileName: 'david.ply', fileBytes: 5e6, vertices: 1000, triangles: 2000, hasColours: false, hasNormals: false, textures: null,
    min: [0, -1, 5], max: [1.5, 1, 5.0001],
  },
  licence: ' ',
  totalBytes: 7e6,
  units: null,
  transform: null,
} as unknown as Manifest;

function facts(change: Partial<Manifest> = {}, known = {}): Record<string, string> {
  return Object.fromEntries(factsOf({ ...MODEL, ...known }, { ...MANIFEST, ...change }));
}

describe('about a model', () => {
  it('there are its source and sizes; what is not known has no line', () => {
    expect(facts()).toEqual({ Source: 'david.ply', Triangles: '2,000', Vertices: '1,000', Extent: '1.5 × 2 × 0.0001', 'Source file': '5.00 MB', Hierarchy: '7.00 MB' });
  });

  it('there is what else is known', () => {
    const textures = { images: 3, missingImages: 1 };
    expect(facts({ licence: 'CC0', source: { ...MANIFEST.source, textures } }, { modified: new Date(2026, 8, 21).getTime() / 1000 })).toMatchObject({
      Licence: 'CC0', Colours: '3 pictures, 1 of them missing', Made: 'Sep 21, 2026',
    });
  });

  it('there is its size in its unit, if that is known', () => {
    expect(facts({ units: 'mm' }).Extent).toBe('1.5 × 2 × 0.0001 mm');
    expect(facts({ units: 'us_ft' }).Extent).toBe('1.5 × 2 × 0.0001 US ft');
    expect(facts({ transform: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 6e6, 0, 0, 1] }).Extent).toBe('1.5 × 2 × 0.0001 m');
    expect(facts({ transform: [0.7, 0, 0, 0, 0, 0.7, 0, 0, 0, 0, 0.7, 0, 6e6, 0, 0, 1] }).Extent).toBe('1.5 × 2 × 0.0001');
  });

  it('there is a summary in words', () => {
    expect(summaryOf(MODEL, MANIFEST)).toBe('david: 2,000 triangles, 1.5 × 2 × 0.0001 in size.');
  });
});
