// A real Chromium, and the program that makes its pages.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { chromium } from 'playwright-core';

export const root = fileURLToPath(new URL('../../..', import.meta.url));
export const program = process.env.HEADPIN ?? join(root, 'build/release/headpin');
export const demo = join(root, 'assets/trials/demo.lcmlog');
const kWait = 120_000;  // ms: for what happens on a machine that is busy with other things

export const folder = mkdtempSync(join(tmpdir(), 'headpin-page-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

export function headpin(...words) {
  return execFileSync(program, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

export function refused(...words) {
  const { status, stderr } = spawnSync(program, words, { cwd: folder, encoding: 'utf8' });
  return { status, stderr };
}

/** Software GL: SwiftShader has to be asked for (Chromium's docs/gpu/swiftshader.md). */
const kSoftware = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

/** @param drawing  options that say what draws in 3D */
export function launch(drawing = kSoftware) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', ...drawing],
  });
}

/** Opens a page of ours and keeps all that it says or asks for. */
export async function open(browser, file, { width = 1280, height = 900, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(kWait);
  const said = [];
  const asked = [];
  page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`error: ${error.message}`));
  page.on('request', (request) => {
    if (!/^(blob|data):/.test(request.url())) asked.push(request.url());
  });
  const url = pathToFileURL(join(folder, file)).href;
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  return { page, said, asked: () => asked.filter((one) => one !== url) };
}

/** Waits for the picture of a tick. */
export async function drawnAt(page, tick) {
  await page.evaluate((to) => {
    window.headpin.clock.pause();
    window.headpin.clock.go(to);
    window.headpin.view.drawNow();
  }, tick);
}

/** Waits until something holds in the page, whose own policy lets no tool put its eyes in. */
export async function until(page, holds, argument) {
  const end = Date.now() + kWait;
  while (!(await page.evaluate(holds, argument))) {
    if (Date.now() > end) throw new Error(`waited ${kWait} ms for ${holds}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}
