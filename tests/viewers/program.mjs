// The program whose files are read, the bundled throw, and a folder for them.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));
export const demo = join(root, 'assets/trials/demo.lcmlog');

export const folder = mkdtempSync(join(tmpdir(), 'headpin-viewers-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

export function headpin(...words) {
  const program = process.env.HEADPIN ?? join(root, 'build/release/headpin');
  return execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

// A table of `headpin export`: an object per row; numbers where a cell is one.
export function table(file) {
  const [head, ...lines] = readFileSync(join(folder, file), 'utf8').trimEnd().split('\n').map((line) => line.split(','));
  const cell = (text) => (text !== '' && !Number.isNaN(Number(text)) ? Number(text) : text);
  return lines.map((cells) => Object.fromEntries(head.map((name, i) => [name, cell(cells[i])])));
}

// The same numbers in [0, 1) each time (Park and Miller 1988).
export function random(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}
