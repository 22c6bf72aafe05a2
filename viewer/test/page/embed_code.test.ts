// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { parseAddress } from '../../page/address.js';
import { readQuery } from '../../page/query.js';
import { addressAlone, elementCode, frameCode, type Shared } from '../../page/share/embed_code.js';

const POSE = { position: [1.5, -2, 3e9], target: [0, 0.25, 1] } as const;

function shared(change: Partial<Shared> = {}): Shared {
  return { page: 'http://host/show/index.html', name: 'david', url: 'http://host/show/models/david.hier', story: null, other: null, pose: null, choices: '', leftOut: [], isWhole: false, ...change };
}

describe('the address of a model alone', () => {
  it.each(['http://host/show/models/david.hier', 'http://host/elsewhere/a%20b%26c.hier', 'https://other:8080/%25/x.hier', 'http://host/show/a%2Fb.hier'])('shows %s', (url) => {
    const address = new URL(addressAlone(shared({ url, pose: POSE, choices: 'light=flat' })));
    expect(readQuery(address.search, address.href).only!.url).toBe(url);
    expect(parseAddress(address.hash)).toEqual({ path: '', pose: POSE, choices: 'light=flat' });
  });

  it('has the model that it is compared with', () => {
    const address = new URL(addressAlone(shared({ other: 'http://host/show/models/b c.hier', choices: 'way=side' })));
    expect(readQuery(address.search, address.href).other).toMatchObject({ url: 'http://host/show/models/b%20c.hier' });
    expect(parseAddress(address.hash)!.choices).toBe('way=side');
  });

  it.each(['http://host/show/models/a%20b.hier.story.json', 'https://other/x.json?signed=a&b'])('has the story at %s', (story) => {
    const address = new URL(addressAlone(shared({ story, pose: POSE })));
    expect(readQuery(address.search, address.href).only).toMatchObject({ url: shared().url, story });
    expect(parseAddress(address.hash)!.pose).toEqual(POSE);
  });

  it('is short where the model lies below the page, and needs no camera', () => {
    expect(addressAlone(shared())).toBe('http://host/show/index.html?model=models/david.hier');
  });
});

describe('code for other pages', () => {
  const name = '"><script>alert(1)</script>&amp;';

  it('holds nothing but what it is made for', () => {
    for (const code of [frameCode(shared({ name })), elementCode(shared({ name, url: 'http://host/"onload="x' }))]) {
      expect(code).not.toContain('<script>alert');
      expect(code).not.toContain('"onload="x');
      expect(code).toContain('&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;amp;');
    }
  });

  it('names the script beside the page, the model and the camera', () => {
    const code = elementCode(shared({ pose: POSE }));
    expect(code).toContain('src="http://host/show/meshhier-viewer.js"');
    expect(code).toContain('src="http://host/show/models/david.hier"');
    expect(code).toContain('camera="1.5,-2,3000000000,0,0.25,1"');
    expect(elementCode(shared())).not.toContain('camera=');
  });

  it('tells the element of the view, but for notes and stories', () => {
    expect(elementCode(shared({ choices: 'colours=height&light=flat&cut=1,0,0,2&notes=abc&story=2' }))).toContain(' view="colours=height&amp;light=flat&amp;cut=1,0,0,2" ');
    expect(elementCode(shared({ choices: 'story=2' }))).not.toContain(' view=');
  });
});
