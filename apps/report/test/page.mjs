// What the tests of all browsers ask of a page; `page` is Playwright's or Puppeteer's.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

import { readPng } from './png.mjs';

export const kWait = 120_000;  // ms: for what happens on a machine that is busy with other things

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const kRules = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];

/** Keeps what a page says and asks for. */
export function listened(page) {
  const said = [];
  const asked = [];
  page.on('console', (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => said.push(`error: ${error.message}`));
  page.on('request', (request) => {
    if (!/^(blob|data):/.test(request.url())) asked.push(request.url());
  });
  return { said, asked: () => asked.filter((one) => one !== page.url()) };
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

/** What axe-core finds wrong in the page or a part of it: rules, and some elements that break each. */
export async function axeFinds(page, part = 'html') {
  if (!(await page.evaluate(() => 'axe' in window))) await page.addScriptTag({ content: axe });
  return page.evaluate(async ([selector, rules]) => {
    const { violations } = await window.axe.run(document.querySelector(selector), { runOnly: rules });
    return violations.map(({ id, nodes }) => [id, nodes.slice(0, 3).map((node) => node.html)]);
  }, [part, kRules]);
}

/** The pixels of a body in a picture of `headpin frames --ids`, and their colours. */
export function pixelsOf(name, id) {
  const ids = readPng(`${name}_ids.png`);
  const own = readPng(`${name}.png`);
  const mask = [];
  const colours = [];
  ids.values.forEach((found, i) => {
    if (found !== id) return;
    mask.push([i % ids.width, Math.floor(i / ids.width)]);
    colours.push([...own.values.subarray(3 * i, 3 * i + 3)]);
  });
  return { mask, colours };
}

/** Mean difference of the page's picture of an eye from headpin's own, over the pixels of a body. */
export async function differenceOver(page, { mask, colours }) {
  return page.evaluate(([pixels, own]) => {
    const { view } = window.headpin;
    view.drawNow();
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(view.canvas, 0, 0);
    const scale = view.canvas.width / view.canvas.clientWidth;
    const [[eye, x, y, w, h]] = view.eyeFrames(view.canvas.clientWidth, view.canvas.clientHeight);
    const { width, height } = view.eyes[eye].eye;
    let sum = 0;
    pixels.forEach(([column, row], i) => {
      const seen = context.getImageData(Math.floor(scale * (x + ((column + 0.5) / width) * w)),
        Math.floor(scale * (y + ((row + 0.5) / height) * h)), 1, 1).data;
      for (let c = 0; c < 3; ++c) sum += Math.abs(seen[c] - own[i][c]);
    });
    return sum / (3 * pixels.length);
  }, [mask, colours]);
}
