// SPDX-License-Identifier: MIT
import { createHash } from 'node:crypto';
import { describe, expect, it } from 'vitest';
import { withPolicy } from '../../lean/policy.js';

const HEAD = '<!doctype html><html><head><meta charset="utf-8">';

describe('the policy of the page', () => {
  it('names each inline script by its hash, and no other way for one', () => {
    const scripts = ['start("a<b");', 'more();\n'];
    const html = withPolicy(`${HEAD}${scripts.map((script) => `<script>${script}</script>`).join('')}<script type="module" src="./a.js"></script></head></html>`);
    const policy = /http-equiv="Content-Security-Policy" content="([^"]*)"/.exec(html)?.[1] ?? '';
    for (const script of scripts) expect(policy).toContain(`'sha256-${createHash('sha256').update(script).digest('base64')}'`);
    expect(policy.match(/sha256/g)).toHaveLength(2);
    expect(policy).not.toContain('unsafe-inline');
    expect(policy).toContain("default-src 'none'");
  });

  it('stands before all that it binds', () => {
    const html = withPolicy(`${HEAD}<script>x</script></head></html>`);
    expect(html.indexOf('Content-Security-Policy')).toBeLessThan(html.indexOf('<script>'));
    expect(() => withPolicy('<html><script>x</script></html>')).toThrow('charset');
  });
});
