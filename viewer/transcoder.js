// SPDX-License-Identifier: MIT
// Makes of three's copy of the Basis Universal transcoder a module that loads nothing: src/hierarchy/basis_transcoder.ts, the script and, in base64,
// its WebAssembly in gzip. Given a path, also a script of it, for pages that have no bundler.
//
//   node transcoder.js [SCRIPT]
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = path.dirname(fileURLToPath(import.meta.url));
const basis = path.join(here, 'node_modules/three/examples/jsm/libs/basis');
const binary = gzipSync(readFileSync(path.join(basis, 'basis_transcoder.wasm')), { level: 9 }).toString('base64');
const text = `// SPDX-License-Identifier: Apache-2.0
// Basis Universal, Copyright Binomial LLC (https://github.com/BinomialLLC/basis_universal); made by transcoder.js.
${readFileSync(path.join(basis, 'basis_transcoder.js'), 'utf8').replace(/\nif \(typeof exports[\s\S]*$/, '\n')}
export const createBasis = BASIS;
export const WASM = '${binary}';
`;

function write(file, content) {
  let before = '';
  try {
    before = readFileSync(file, 'utf8');
  } catch {
    // It is not there yet.
  }
  if (before !== content) writeFileSync(file, content);
}

write(path.join(here, 'src/hierarchy/basis_transcoder.ts'), `// @ts-nocheck\n${text}`);
if (process.argv[2] !== undefined) {
  write(path.resolve(process.argv[2]), text);
  writeFileSync(`${path.resolve(process.argv[2])}.gz`, gzipSync(text, { level: 9 })); // for hosts that send those
}
