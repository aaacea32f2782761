// What the tests of `headpin serve` share: the server, and a line to it that can be cut.
import { spawn } from 'node:child_process';
import { connect, createServer } from 'node:net';

import { folder, program } from './program.mjs';

/** Starts a server; `said` has what it says on standard error. */
export async function serving(...words) {
  const child = spawn(program, ['serve', '--json', '--port', '0', ...words], { cwd: folder });
  const said = [];
  child.stderr.setEncoding('utf8').on('data', (text) => said.push(text));
  const line = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.setEncoding('utf8').on('data', (more) => {
      text += more;
      if (text.includes('\n')) resolve(text);
    });
    child.on('exit', (code) => reject(new Error(`serve ended with ${code}: ${said.join('')}`)));
  });
  const stop = () => new Promise((resolve) => {
    child.on('exit', resolve);
    child.kill('SIGTERM');
  });
  return { ...JSON.parse(line), said, stop };
}

/** A line to a port of this machine, which can be cut: all connections end, and no new ones are made until it is mended. */
export async function lineTo(port) {
  const open = new Set();
  let whole = true;
  const server = createServer((near) => {
    if (!whole) return near.destroy();
    const far = connect(port, '127.0.0.1');
    for (const [a, b] of [[near, far], [far, near]]) {
      open.add(a);
      a.on('error', () => b.destroy());
      a.on('close', () => { open.delete(a); b.destroy(); });
      a.pipe(b);
    }
    return undefined;
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    port: server.address().port,
    cut() {
      whole = false;
      for (const socket of open) socket.destroy();
    },
    mend() { whole = true; },
    close() {
      this.cut();
      server.close();
    },
  };
}
