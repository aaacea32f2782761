// The program that makes the pages, and the folder that they are made in.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const root = fileURLToPath(new URL('../../..', import.meta.url));
export const program = process.env.HEADPIN ?? join(root, 'build/release/headpin');
export const demo = join(root, 'assets/trials/demo.lcmlog');

export const folder = mkdtempSync(join(tmpdir(), 'headpin-page-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

export const urlOf = (file) => pathToFileURL(join(folder, file)).href;

export function headpin(...words) {
  return execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

export function refused(...words) {
  const { status, stderr } = spawnSync(program, words, { cwd: folder, encoding: 'utf8' });
  return { status, stderr };
}
