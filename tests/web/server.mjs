// A plain static server on the loopback: directories under URL prefixes, nothing else. A .glb file
// that is a gzip stream is sent with Content-Encoding: gzip, and of a file with a copy FILE.gz beside it that copy, as a
// static host is set up to do.
import { createReadStream, openSync, readSync, closeSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import path from 'node:path';

const TYPES = {
  '.css': 'text/css',
  '.glb': 'model/gltf-binary',
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.json': 'application/json',
  '.mjs': 'text/javascript',
  '.wasm': 'application/wasm',
};

function isFile(file) {
  return statSync(file, { throwIfNoEntry: false })?.isFile() ?? false;
}

function isGzip(file) {
  const start = Buffer.alloc(2);
  const handle = openSync(file, 'r');
  readSync(handle, start, 0, 2, 0);
  closeSync(handle);
  return start[0] === 0x1f && start[1] === 0x8b;
}

/// The file that a URL names, if it is one below its prefix's directory.
function fileOf(url, directories) {
  const name = decodeURIComponent(new URL(url, 'http://localhost').pathname);
  for (const [prefix, directory] of Object.entries(directories)) {
    if (!name.startsWith(`${prefix}/`)) continue;
    const file = path.join(directory, path.normalize(name.slice(prefix.length)));
    if (isFile(file)) return file;
  }
  return null;
}

/// Serves `directories` ({prefix: directory}). Resolves to {origin, close}.
export function serve(directories) {
  const server = createServer((request, response) => {
    const file = fileOf(request.url, directories);
    if (file === null) {
      response.writeHead(404).end();
      return;
    }
    const type = path.extname(file);
    const sent = isFile(`${file}.gz`) ? `${file}.gz` : file;
    const headers = { 'Content-Type': TYPES[type] ?? 'application/octet-stream' };
    if (sent !== file || (type === '.glb' && isGzip(file))) headers['Content-Encoding'] = 'gzip';
    response.writeHead(200, headers);
    createReadStream(sent).pipe(response);
  });
  return new Promise((resolve) => {
    server.listen(0, '127.0.0.1', () => {
      resolve({
        origin: `http://127.0.0.1:${server.address().port}`,
        close: () => server.close(),
      });
    });
  });
}
