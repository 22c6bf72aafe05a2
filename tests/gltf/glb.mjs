// Files of a published hierarchy, as a viewer gets them.
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { gunzipSync } from 'node:zlib';

// Of a script whose package is not there: tests are skipped then.
export const NOT_INSTALLED = 77;

export function glbFiles(directory) {
  return readdirSync(directory, { withFileTypes: true })
    .sort((a, b) => (a.name < b.name ? -1 : 1))
    .flatMap((entry) => {
      const file = path.join(directory, entry.name);
      if (entry.isDirectory()) return glbFiles(file);
      return entry.name.endsWith('.glb') ? [file] : [];
    });
}

// The bytes of the GLB: of one stored as a gzip stream, what a host with `Content-Encoding: gzip`
// makes a browser of it.
export function readGlb(file) {
  const bytes = readFileSync(file);
  return new Uint8Array(bytes[0] === 0x1f && bytes[1] === 0x8b ? gunzipSync(bytes) : bytes);
}

// What `load` imports; ends the script if it is not installed.
export async function required(name, load) {
  try {
    return await load();
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    console.log(`${name} is not installed: run \`npm ci\` in the directory of this script`);
    process.exit(NOT_INSTALLED);
  }
}
