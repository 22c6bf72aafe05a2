// The page of viewer/ on a plain static server, with a listing of hierarchies beside it.
import { cpSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { serve } from './server.mjs';

/// Returns what a listing says of a hierarchy.
function entryOf({ name, vertices, triangles, bytes }) {
  return { name, path: `models/${name}.hier`, vertices, triangles, bytes };
}

/// The page with models.json beside it, in a directory of its own; `more(models)`: other listings, by their files' names.
function makeSite(page, hierarchies, more) {
  const site = mkdtempSync(path.join(tmpdir(), 'meshhier-page-'));
  cpSync(page, site, { recursive: true });
  const models = hierarchies.map(entryOf);
  const listings = { 'models.json': { models }, ...more(models) };
  for (const [file, listing] of Object.entries(listings)) writeFileSync(path.join(site, file), JSON.stringify(listing));
  return site;
}

/// Calls `use(origin)` while the site is there.
export async function withSite(page, hierarchies, use, more = () => ({})) {
  const site = makeSite(page, hierarchies, more);
  const below = Object.fromEntries(hierarchies.map(({ name, directory }) => [`/models/${name}.hier`, directory]));
  const server = await serve({ ...below, '': site });
  try {
    await use(server.origin);
  } finally {
    server.close();
    rmSync(site, { recursive: true });
  }
}
