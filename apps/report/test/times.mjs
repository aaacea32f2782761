// How long the page lets a reader wait, in Chromium drawing in software: node times.mjs
//
// The first picture is from the start of the page's loading to its first picture in 3D; scrubbing is from
// a new tick to all pixels of the picture that is shown while one scrubs, and of the fine one that follows
// when it rests. All are medians; what is asked and aimed at stands beside them.
import { statSync } from 'node:fs';
import { join } from 'node:path';

import { launch, open } from './chromium.mjs';
import { until } from './page.mjs';
import { demo, folder, headpin } from './program.mjs';

const kOpened = 7;
const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];
const row = (name, value, unit, goal) =>
  console.log(`${name.padEnd(44)} ${value.toPrecision(4).padStart(8)} ${unit.padEnd(12)} ${goal}`);

headpin('replay', demo, '-o', 'game.lcmlog');
headpin('report', 'game.lcmlog', '-o', 'game.html');
const browser = await launch();
console.log(`Chromium ${browser.version()}, drawing in software`);
row('page without video', statSync(join(folder, 'game.html')).size / 1e6, 'MB', 'must 2, aim 1.2');

const first = [];
let page;
for (let i = 0; i < kOpened; ++i) {
  if (page) await page.context().close();
  ({ page } = await open(browser, 'game.html'));
  first.push(await page.evaluate(() => performance.getEntriesByName('first picture')[0].startTime));
}
row('first 3D picture', median(first) / 1e3, 's', 'must 2, aim 1');
await until(page, () => document.documentElement.dataset.engine);

/** Times of a picture at each of many ticks [ms]. */
function scrubbed([mode, quick]) {
  const { view, clock, setMode } = window.headpin;
  setMode.call(window.headpin, mode);
  const gl = view.renderer.getContext();
  const took = [];
  for (let i = 0; i < 45; ++i) {
    const start = performance.now();
    clock.go((i * 631) % clock.lastTick);
    view.drawNow(quick);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // waits until it is drawn
    if (i >= 5) took.push(performance.now() - start);
  }
  return took;
}
for (const [mode, name] of [['around', 'from outside'], ['left', 'through an eye'], ['both', 'through both eyes']]) {
  row(`scrubbing, ${name}`, median(await page.evaluate(scrubbed, [mode, true])), 'ms', 'must 50, aim 16');
  row('  the fine picture after it', median(await page.evaluate(scrubbed, [mode, false])), 'ms', '');
}

const again = await page.evaluate(async () => {
  const paces = [];
  for (let i = 0; i < 7; ++i) {
    const { trial, milliseconds } = await window.headpin.again.engine.simulate({});
    paces.push((1e3 * trial.json.summary.simulated_s) / milliseconds);
  }
  return paces;
});
row('the throw simulated again', median(again), 'x real time', 'must 10, aim 300');
await browser.close();
