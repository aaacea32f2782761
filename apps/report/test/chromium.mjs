// A real Chromium.
import { chromium } from 'playwright-core';

import { kWait, listened } from './page.mjs';
import { urlOf } from './program.mjs';

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
  const heard = listened(page);
  await page.goto(urlOf(file));
  await page.waitForSelector('html[data-ready]');
  return { page, ...heard };
}
