// Validates every .glb below the given directories with the Khronos glTF validator.
//
//   node validate.mjs DIR...
//
// Exit code 0: no error and no warning in any file; 1: there are some, or there is no file;
// 2: wrong use; 77: the validator is not installed (run `npm ci` here).
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';

const SEVERITIES = ['error', 'warning', 'information', 'hint'];
const SHOWN_PER_FILE = 5;

function glbFiles(directory) {
  return readdirSync(directory, { withFileTypes: true })
    .sort((a, b) => (a.name < b.name ? -1 : 1))
    .flatMap((entry) => {
      const file = path.join(directory, entry.name);
      if (entry.isDirectory()) return glbFiles(file);
      return entry.name.endsWith('.glb') ? [file] : [];
    });
}

async function loadValidator() {
  try {
    return (await import('gltf-validator')).default;
  } catch (error) {
    if (error.code !== 'ERR_MODULE_NOT_FOUND') throw error;
    console.log('gltf-validator is not installed: run `npm ci` in the directory of this script');
    process.exit(77);
  }
}

async function messagesOf(validator, file) {
  try {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
      uri: path.basename(file),
      format: 'glb',
      maxIssues: 0,
    });
    return report.issues.messages;
  } catch (error) {
    return [{ severity: 0, code: 'UNREADABLE', message: String(error), pointer: '' }];
  }
}

async function main(directories) {
  if (directories.length === 0) {
    console.error('use: node validate.mjs DIR...');
    return 2;
  }
  const validator = await loadValidator();
  const files = directories.flatMap(glbFiles);
  const counts = [0, 0, 0, 0];
  const codes = new Map();
  for (const file of files) {
    let shown = 0;
    for (const { severity, code, message, pointer } of await messagesOf(validator, file)) {
      counts[severity] += 1;
      codes.set(code, (codes.get(code) ?? 0) + 1);
      if (severity <= 1 && ++shown <= SHOWN_PER_FILE) {
        console.log(`${file}: ${SEVERITIES[severity]} ${code} at ${pointer}: ${message}`);
      }
    }
  }
  const totals = SEVERITIES.map((name, i) => `${counts[i]} ${name}`).join(', ');
  console.log(`gltf-validator ${validator.version()}: ${files.length} files: ${totals}`);
  for (const [code, count] of [...codes].sort()) console.log(`  ${code}: ${count}`);
  if (files.length === 0) console.log('no .glb file found');
  return counts[0] + counts[1] === 0 && files.length > 0 ? 0 : 1;
}

process.exit(await main(process.argv.slice(2)));
