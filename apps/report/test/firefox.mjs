// A real Firefox, driven over WebDriver BiDi.
import { spawn } from 'node:child_process';

import puppeteer from 'puppeteer-core';

import { kWait, listened } from './page.mjs';
import { urlOf } from './program.mjs';

/** A screen in memory: Firefox has WebGL only where there is a screen. */
export async function openScreen() {
  const server = spawn('Xvfb', ['-displayfd', '3', '-screen', '0', '1280x1024x24', '-nolisten', 'tcp'],
    { stdio: ['ignore', 'ignore', 'inherit', 'pipe'] });
  const close = () => server.kill();
  process.on('exit', close);
  let number = '';
  for await (const part of server.stdio[3]) {
    number += part;
    if (number.endsWith('\n')) return { display: `:${number.trim()}`, close };
  }
  throw new Error('Xvfb ended without a screen');
}

/**
 * @param screen  to draw on, with WebGL; null for a Firefox without both
 * @param scheme  light or dark
 */
export function launch(screen, scheme) {
  return puppeteer.launch({
    browser: 'firefox',
    executablePath: process.env.FIREFOX ?? '/usr/bin/firefox-esr',
    headless: !screen,
    timeout: kWait,
    env: { ...process.env, WAYLAND_DISPLAY: undefined, DISPLAY: screen?.display },
    extraPrefsFirefox: {
      'layout.css.prefers-color-scheme.content-override': scheme === 'dark' ? 0 : 1,
      'webgl.disabled': !screen,
    },
  });
}

/** Opens a page of ours, waits for its engine, and keeps all that it says or asks for. */
export async function open(browser, file) {
  const page = await browser.newPage();
  page.setDefaultTimeout(kWait);
  await page.setViewport({ width: 1280, height: 900 });
  const heard = listened(page);
  await page.goto(urlOf(file));
  await page.waitForSelector('html[data-engine=yes]');
  return { page, ...heard };
}
