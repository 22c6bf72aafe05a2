// Validates every .glb below the given directories with the Khronos glTF validator.
//
//   node validate.mjs DIR...
//
// Exit code 0: no error and no warning in any file; 1: there are some, or there is no file;
// 2: wrong use; 77: the validator is not installed (run `npm ci` here).
import path from 'node:path';
import { glbFiles, readGlb, required } from './glb.mjs';

const SEVERITIES = ['error', 'warning', 'information', 'hint'];
const SHOWN_PER_FILE = 5;

async function messagesOf(validator, file) {
  try {
    const report = await validator.validateBytes(readGlb(file), {
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
  const { default: validator } = await required('gltf-validator', () => import('gltf-validator'));
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
