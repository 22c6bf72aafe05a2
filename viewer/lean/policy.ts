// SPDX-License-Identifier: MIT
// The page's policy on what it may load (Content Security Policy), within index.html: it holds on any host, also one that sends no headers.
//
// A text that came from a model, a link or a host and found a way into the page can run nothing: scripts are the page's own files, and the boot
// by its hash. The page may fetch from any host, because `?model=https://…` is what it is for; a host that wants less sends a policy beside
// this one, and both hold. Who may show the page in a frame only headers can say.
import { createHash } from 'node:crypto';
import type { Plugin } from 'vite';

const ANY_HOST = "'self' http: https: data: blob:";
const PLACE = '<meta charset="utf-8">';
const INLINE_SCRIPT = /<script>([^]*?)<\/script>/g;

function policyOf(scripts: readonly string[]): string {
  const hashes = scripts.map((script) => ` 'sha256-${createHash('sha256').update(script).digest('base64')}'`);
  return [
    "default-src 'none'",
    `script-src 'self' 'wasm-unsafe-eval'${hashes.join('')}`,
    "worker-src 'self' blob:",
    "style-src 'self'",
    `img-src ${ANY_HOST}`,
    `connect-src ${ANY_HOST}`,
    "base-uri 'none'",
    "form-action 'none'",
  ].join('; ');
}

/// Returns the document with its policy, before all that it binds.
export function withPolicy(html: string): string {
  const scripts = [...html.matchAll(INLINE_SCRIPT)].map(([, script]) => script);
  if (!html.includes(PLACE)) throw new Error(`index.html has no ${PLACE}`);
  return html.replace(PLACE, () => `${PLACE}\n    <meta http-equiv="Content-Security-Policy" content="${policyOf(scripts)}">`);
}

export function contentPolicy(): Plugin {
  return { name: 'content-policy', apply: 'build', transformIndexHtml: { order: 'post', handler: withPolicy } };
}
