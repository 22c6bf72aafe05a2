// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { loadStory, pictureOf } from '../../page/story/story_source.js';

const BASE = 'https://host/models/a.hier.story.json';

describe('a picture that a story names', () => {
  it('is found from where the story lies', () => {
    expect(pictureOf('pictures/1.jpg', BASE)).toBe('https://host/models/pictures/1.jpg');
    expect(pictureOf('https://other/x.png', BASE)).toBe('https://other/x.png');
    expect(pictureOf('data:image/png;base64,AA==', BASE)).toBe('data:image/png;base64,AA==');
  });

  it.each(['javascript:alert(1)', 'data:text/html,x', 'data:image/svg+xml;base64,AA==', 'blob:https://host/1', 'file:///etc/passwd', 'http://[', '', null, undefined])('is left out: %s', (address) => {
    expect(pictureOf(address, BASE)).toBeNull();
  });

  it.each(['pictures/1.jpg', 'https://other/x.png', '//other/x.png', '/x.png', 'file:///x.png'])('is never fetched for a page that has all within it: %s', (address) => {
    expect(pictureOf(address, null)).toBeNull();
    expect(pictureOf('data:image/png;base64,AA==', null)).not.toBeNull();
  });

  it('may be the story itself', async () => {
    const story = await loadStory('{"type":"AnnotationPage","label":"a","items":[]}', new AbortController().signal);
    expect(story).toEqual({ title: 'a', notes: [], bookmarks: [] });
  });
});
