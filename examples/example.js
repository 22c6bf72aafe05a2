// SPDX-License-Identifier: MIT
// What the pages share: which hierarchy they show, and plain words where that fails.

/// Puts a text over the page; none takes it away.
export function say(text = '') {
  const message = document.getElementById('message');
  message.textContent = text;
  message.hidden = text === '';
}

async function fetchFile(url) {
  try {
    return await fetch(url);
  } catch {
    throw new Error(`${url.origin} does not answer, or does not let this page read it.
      Is it running, and was it started with --cors? For example: meshhier serve models --cors ${location.origin}`);
  }
}

/// The URL of a file of the hierarchy that `?url=` of the page's address names. Throws an Error in plain words if it is not
/// there.
export async function fileOfHierarchy(name) {
  const given = new URLSearchParams(location.search).get('url');
  if (!given) throw new Error(`Which hierarchy? Add its URL to the address: ${location.pathname}?url=http://localhost:8080/models/NAME.hier`);
  const url = new URL(`${given.replace(/\/+$/, '')}/${name}`, location.href);
  const { ok, status } = await fetchFile(url);
  if (!ok) throw new Error(`There is no hierarchy at ${given}: the server has no ${url} (status ${status}).`);
  return url.href;
}

/// Runs `show`; what it throws is said.
export async function run(show) {
  say();
  try {
    await show();
  } catch (error) {
    say(`The model cannot be shown. ${error.message ?? error}`);
  }
}
