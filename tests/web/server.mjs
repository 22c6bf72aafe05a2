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

/// Returns the part of a file of `size` bytes, as {start, end}, the last one included; null: the request asks for no part.
function partOf(request, size) {
  const match = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
  return match && { start: Number(match[1]), end: Math.min(Number(match[2]), size - 1) };
}

/// As hosts of files do that know ranges, with CORS as short as it works.
function sendPart(request, response, file) {
  const { size, mtimeMs } = statSync(file);
  const headers = { 'Accept-Ranges': 'bytes', 'Access-Control-Allow-Origin': '*', 'Last-Modified': new Date(mtimeMs).toUTCString() };
  const part = partOf(request, size);
  if (part === null) response.writeHead(200, { ...headers, 'Content-Length': size });
  else if (part.start > part.end) response.writeHead(416, headers);
  else response.writeHead(206, { ...headers, 'Content-Length': part.end + 1 - part.start, 'Content-Range': `bytes ${part.start}-${part.end}/${size}` });
  if (request.method === 'HEAD' || response.statusCode === 416) response.end();
  else createReadStream(file, part ?? {}).pipe(response);
}

/// Serves `directories` ({prefix: directory}), archives in parts if `ranges` says so; `isBare`: as a host without any settings, which says
/// nothing of gzip. Resolves to {origin, close}.
export function serve(directories, { ranges = false, isBare = false } = {}) {
  const server = createServer((request, response) => {
    const file = fileOf(request.url, directories);
    if (file === null) {
      response.writeHead(404).end();
      return;
    }
    const type = path.extname(file);
    if (ranges && type === '.3tz') {
      sendPart(request, response, file);
      return;
    }
    const sent = !isBare && isFile(`${file}.gz`) ? `${file}.gz` : file;
    const headers = { 'Content-Type': TYPES[type] ?? 'application/octet-stream' };
    if (isBare) headers['Content-Length'] = statSync(file).size;
    else if (sent !== file || (type === '.glb' && isGzip(file))) headers['Content-Encoding'] = 'gzip';
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
