// A `meshhier serve` of the tests' own.
import { spawn } from 'node:child_process';

/// Starts it on a free port. `url` resolves once it says where it is; `stop()` resolves to the exit code.
export function startServer(meshhier, models, ...more) {
  const server = spawn(meshhier, ['serve', models, '--port', '0', ...more], { stdio: ['ignore', 'pipe', 'pipe'] });
  const ended = new Promise((resolve) => server.on('exit', (code) => resolve(code)));
  const url = new Promise((resolve, reject) => {
    let text = '';
    const listen = (data) => {
      text += data;
      const found = /http:\/\/\S+/.exec(text);
      if (found) resolve(found[0]);
    };
    server.stdout.on('data', listen);
    server.stderr.on('data', listen);
    ended.then((code) => reject(new Error(`the server ended with ${code}: ${text}`)));
  });
  return { url, pid: server.pid, stop: () => (server.kill('SIGTERM'), ended) };
}
