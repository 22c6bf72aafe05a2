// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { loadStory, resolved } from '../../page/story/story_source.js';

const BASE = 'https://host/models/a.hier.story.json';

describe('what a story names', () => {
  it('is found from where the story lies', () => {
    expect(resolved('pictures/1.jpg', BASE, true)).toBe('https://host/models/pictures/1.jpg');
    expect(resolved('https://other/x', BASE, false)).toBe('https://other/x');
    expect(resolved('data:image/png;base64,AA==', BASE, true)).toBe('data:image/png;base64,AA==');
  });

  it.each(['javascript:alert(1)', 'data:text/html,x', 'data:image/svg+xml;base64,AA==', 'blob:https://host/1', 'file:///etc/passwd', 'http://[', '', null, undefined])('is left out: %s', (address) => {
    expect(resolved(address, BASE, true)).toBeNull();
    expect(resolved(address, BASE, false)).toBeNull();
  });

  it('is no picture as a link', () => {
    expect(resolved('data:image/png;base64,AA==', BASE, false)).toBeNull();
  });

  it('may be the story itself', async () => {
    const story = await loadStory('{"type":"AnnotationPage","label":"a","items":[]}', new AbortController().signal);
    expect(story).toEqual({ title: 'a', notes: [], bookmarks: [] });
  });
});
