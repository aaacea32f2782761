// The page in Firefox, with and without WebGL; what it looks like is left in out/page.
import assert from 'node:assert/strict';
import { mkdirSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { launch, open, openScreen } from './firefox.mjs';
import { axeFinds, differenceOver, drawnAt, pixelsOf, until } from './page.mjs';
import { demo, folder, headpin, root } from './program.mjs';

const pictures = join(root, 'out/page');
const kScreens = [[360, 640], [768, 1024], [1366, 768], [1920, 1080], [2560, 1440]];

const asJson = (...words) => JSON.parse(headpin(...words, '--json'));
const textOf = (page, selector) => page.$eval(selector, (element) => element.textContent);
const isVisible = (page, id) => page.$eval(`#${id}`, (element) => element.checkVisibility());
const tickOf = (page) => page.evaluate(() => window.headpin.clock.tick);

let screen;
before(async () => {
  headpin('replay', demo, '-o', 'game.lcmlog');
  headpin('replay', demo, '-o', 'smooth.lcmlog', '--friction', '0.3');
  headpin('report', 'game.lcmlog', '-o', 'one.html');
  headpin('report', 'game.lcmlog', 'smooth.lcmlog', '-o', 'two.html');
  rmSync(pictures, { recursive: true, force: true });
  mkdirSync(pictures, { recursive: true });
  screen = await openScreen();
});
after(() => screen.close());

/** Events of a trial that happen at a time; sums come after all. */
const happened = () => asJson('info', 'game.lcmlog').events
  .filter(({ kind }) => kind !== 'ledger' && kind !== 'game_hash');

/** Every key of the page. */
async function keysDoNoHarm(browser) {
  const { page, said, asked } = await open(browser, 'one.html');
  for (const key of ['2', '3', '4', '1', 't', 'v', 'c', 'b', 'b', 'b', ']', '[', '+', '-', 'w', 'd', 'r', 'PageDown',
    'ArrowRight', 'End', 'Home']) {
    await page.keyboard.press(key);
    if (key === 'End') assert.equal(await tickOf(page), asJson('info', 'game.lcmlog').ticks);
  }
  assert.equal(await tickOf(page), 0);
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.close();
}

async function spacePlays(browser) {
  const { page, said } = await open(browser, 'one.html');
  const plays = () => page.evaluate(() => window.headpin.clock.playing);
  await page.keyboard.press(' ');
  await until(page, () => window.headpin.clock.tick > 20);
  await page.keyboard.press(' ');
  assert.equal(await plays(), false);
  for (const id of ['#first', '#speed', '#plots summary']) {  // whatever was clicked before
    await page.click(id);
    if (id === '#speed') await page.keyboard.press('Escape');
    await page.keyboard.press(' ');
    assert.equal(await plays(), true, id);
    await page.keyboard.press(' ');
    assert.equal(await plays(), false, id);
  }
  assert.deepEqual(said, []);
  await page.close();
}

async function eventsSetTheClock(browser) {
  const { page, said } = await open(browser, 'one.html');
  const events = happened();
  for (const i of [events.length - 1, 0, 1]) {
    await page.click(`#events-body tr:nth-child(${i + 1}) button`);
    assert.equal(await tickOf(page), events[i].tick);
    assert.match(await textOf(page, '#time'), new RegExp(`tick ${events[i].tick}$`));
    assert.equal(await page.$eval('#events-body tr[aria-current]', (row) => Number(row.cells[1].textContent)), events[i].tick);
  }
  await page.click('#marks .mark:nth-child(2)');
  assert.match(await textOf(page, '#nearest'), /release ball/);
  assert.deepEqual(said, []);
  await page.close();
}

async function simulatesAgain(browser) {
  const { page, said } = await open(browser, 'one.html');
  const { state_hash: recorded } = asJson('replay', 'game.lcmlog');
  const words = await textOf(page, '#again-status');
  assert.ok(words.includes(recorded) && words.includes('equal to the bit with the recording'), words);
  const { state_hash: moved, skittles_down: down } = asJson('replay', 'game.lcmlog', '--friction', '0.2');
  assert.notEqual(moved, recorded);
  await page.$eval('#friction', (control) => {
    control.value = '0.2';
    control.dispatchEvent(new Event('input', { bubbles: true }));
  });
  await until(page, (want) => document.getElementById('again-status').textContent.includes(want), moved);
  assert.ok((await textOf(page, '#again-status')).includes(`${down} of 10 skittles down`));
  await page.click('#unmoved');
  await until(page, () => document.getElementById('again-status').textContent.includes('equal to the bit'));
  assert.ok((await textOf(page, '#again-status')).includes(recorded));
  assert.deepEqual(said, []);
  await page.close();
}

async function twoAreCompared(browser) {
  const { page, said } = await open(browser, 'two.html');
  const { first_difference_tick: tick, first_difference_body: body, scenario_differences: keys } =
    asJson('compare', 'game.lcmlog', 'smooth.lcmlog');
  const words = await textOf(page, '#first-difference');
  assert.ok(words.includes(`First different tick: ${tick} `) && words.includes(`in the ${body}`), words);
  await page.click('#first-difference button');
  assert.equal(await tickOf(page), tick);
  const compared = await textOf(page, '#compared-body');
  assert.ok(keys.length > 0);
  for (const { key } of keys) assert.ok(compared.includes(key), key);
  for (const name of ['game', 'smooth']) {
    assert.ok(compared.includes(asJson('replay', `${name}.lcmlog`).state_hash), name);
  }
  const curves = () => page.evaluate(() => window.headpin.plots.plots[0].plot.series.length - 1);
  assert.equal(await curves(), 6);
  for (const [shown, each] of [['a', 3], ['b', 3], ['both', 6]]) {
    await page.keyboard.press('b');
    assert.equal(await page.$eval('#pair :checked', ({ value }) => value), shown);
    assert.equal(await curves(), each);
  }
  assert.deepEqual(said, []);
  await page.close();
}

/** The colours in the picture of a tick, and how many of its pixels differ from those of another tick. */
async function pictureOf(page, tick, other) {
  return page.evaluate(([one, another]) => {
    const { view, clock } = window.headpin;
    const pixels = (to) => {
      clock.go(to);
      view.drawNow();
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [view.canvas.width, view.canvas.height];
      copy.getContext('2d').drawImage(view.canvas, 0, 0);
      const { data } = copy.getContext('2d').getImageData(0, 0, copy.width, copy.height);
      return new Uint32Array(data.buffer);
    };
    const [a, b] = [pixels(one), pixels(another)];
    const gl = view.renderer.getContext();
    return { colours: new Set(a).size, differ: a.reduce((sum, colour, i) => sum + (colour !== b[i]), 0), error: gl.getError() };
  }, [tick, other]);
}

async function pictureFollowsTheClock(browser) {
  const { page, said } = await open(browser, 'one.html');
  const still = await pictureOf(page, 300, 300);
  assert.deepEqual([still.differ, still.error], [0, 0]);
  assert.ok(still.colours > 1000, `${still.colours} colours`);
  const { differ } = await pictureOf(page, 300, 1215);
  assert.ok(differ > 1000, `${differ} pixels`);

  // The ball is where headpin's own eye sees it, and would be seen to be elsewhere a tenth of a second later.
  headpin('frames', 'game.lcmlog', '-o', 'frames', '--frames', '300', '--ids');
  const ball = pixelsOf(join(folder, 'frames/left_000300'), 10);
  assert.ok(ball.mask.length >= 8, `${ball.mask.length} pixels`);
  await page.keyboard.press('c');  // arrows are not what the eyes see
  await page.keyboard.press('2');
  await drawnAt(page, 1200);
  const there = await differenceOver(page, ball);
  await drawnAt(page, 1224);
  const later = await differenceOver(page, ball);
  assert.ok(there < 26 && later > 1.5 * there, `${there} levels off, ${later} a tenth of a second later`);
  assert.deepEqual(said, []);
  await page.close();
}

async function videoFollowsTheClock(browser) {
  headpin('frames', 'game.lcmlog', '--frames', '0-119', '--video', 'stereo.mkv');
  headpin('report', 'game.lcmlog', '-o', 'video.html', '--video', 'stereo.mp4');
  const { page, said, asked } = await open(browser, 'video.html');
  await page.waitForSelector('#video:not([hidden])');
  await drawnAt(page, 240);
  await until(page, () => Math.abs(document.querySelector('video').currentTime - 1) < 0.01);
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.close();
}

async function allElseIsThere(browser) {
  const { page, said } = await open(browser, 'one.html');
  assert.match(await textOf(page, '#seen'), /^No picture: this browser cannot draw in 3D \([^\n]*[^.\s]\)\. /);
  for (const id of ['view', 'modes', 'from-field', 'layers', 'trouble']) assert.equal(await isVisible(page, id), false, id);
  for (const id of ['seen', 'play', 'time', 'scrub', 'marks', 'again', 'plots', 'events', 'devices', 'provenance']) {
    assert.equal(await isVisible(page, id), true, id);
  }
  const { skittles_down: down, state_hash: hash } = asJson('replay', 'game.lcmlog');
  assert.ok((await textOf(page, '#subtitle')).includes(`${down} of 10 skittles down`));
  const rows = await page.$$eval('#result-body tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const result = Object.fromEntries(rows);
  assert.deepEqual([result['Skittles down'], result['State hash']], [`${down} of 10`, hash]);
  const printed = headpin('replay', 'game.lcmlog');
  for (const condition of ['Elasticity', 'Friction']) {
    assert.equal(result[condition], new RegExp(`^${condition.toLowerCase()} +(.*)$`, 'm').exec(printed)[1]);
  }

  const { devices, participant, events: all } = asJson('info', 'game.lcmlog');
  assert.equal((await page.$$('#events-body tbody tr')).length, happened().length);
  assert.ok(all.length > happened().length);
  const told = await page.$$eval('#devices-body tbody tr', (lines) => lines.map(({ cells }) =>
    [cells[0].textContent, Number(cells[1].textContent)]));
  assert.deepEqual(new Map(told), new Map(devices.map(({ device, samples }) => [device, samples])));
  const origin = await textOf(page, '#provenance-body');
  for (const words of [participant, hash, 'headpin report']) assert.ok(origin.includes(words), words);
  const drawn = await page.$$eval('.plot canvas', (plots) => plots.map((plot) => {
    const { data } = plot.getContext('2d').getImageData(0, 0, plot.width, plot.height);
    return new Set(new Uint32Array(data.buffer)).size;
  }));
  assert.ok(drawn.length >= 6 && drawn.every((colours) => colours > 10), drawn.join());
  assert.deepEqual(said, []);
  await page.close();
}

/** Waits until plots and picture have the size that the screen gives them. */
const settled = (page) => until(page, () => {
  const { plots, view } = window.headpin;
  return plots.plots.every(({ plot, holder }) => plot.width === holder.clientWidth)
    && (view.why || (view.canvas.width === view.canvas.clientWidth && view.canvas.height === view.canvas.clientHeight));
});

/** What should be on the screen and is not, at the top of the page; and what goes past its sides. */
const outside = (page, first) => page.evaluate((ids) => {
  const { clientWidth: width, scrollWidth } = document.documentElement;
  const fits = (element, height) => {
    const { top, bottom, left, right } = element.getBoundingClientRect();
    return left >= 0 && right <= width && (!height || (top >= 0 && bottom <= height));
  };
  const wide = [...document.querySelectorAll('h1, h2, p, button, select, input, label, canvas, dd, figcaption')]
    .filter((element) => element.checkVisibility() && !element.closest('.scroll, .hidden') && !fits(element));
  return [...ids.filter((id) => !fits(document.getElementById(id), innerHeight)),
    ...wide.map((element) => element.outerHTML.slice(0, 200)), ...(scrollWidth > width ? [`${scrollWidth} wide`] : [])];
}, first);

async function looksRight(browser, draws, scheme) {
  for (const file of ['one', 'two']) {
    const { page, said } = await open(browser, `${file}.html`);
    assert.equal(await page.evaluate(() => matchMedia('(prefers-color-scheme: dark)').matches), scheme === 'dark');
    await drawnAt(page, 1215);
    for (const [width, height] of kScreens) {
      const what = `${draws ? '' : 'no-webgl-'}${scheme}-${file}-${width}`;
      await page.setViewport({ width, height });
      await settled(page);
      await page.screenshot({ path: join(pictures, `${what}.png`), fullPage: true });
      assert.deepEqual(await outside(page, ['title', 'subtitle', draws ? 'view' : 'seen', 'play', 'time', 'scrub']), [], what);
      assert.deepEqual(await axeFinds(page), [], what);
    }
    assert.deepEqual(said, []);
    await page.close();
  }
}

const always = {
  'no key does harm, nothing is fetched': keysDoNoHarm,
  'Space plays, whatever was clicked before': spacePlays,
  'a click on an event sets the clock': eventsSetTheClock,
  'the engine in the page comes to the recorded hash, and to that of another condition': simulatesAgain,
  'two trials are compared': twoAreCompared,
};
const withPicture = {
  'the picture follows the clock': pictureFollowsTheClock,
  'what both eyes saw is on the same clock': videoFollowsTheClock,
};

for (const [draws, scheme, checks] of [
  [true, 'light', { ...always, ...withPicture }], [true, 'dark', {}],
  [false, 'light', {}], [false, 'dark', { ...always, 'only the picture is missing': allElseIsThere }],
]) {
  describe(`Firefox ${draws ? 'with' : 'without'} WebGL, ${scheme}`, () => {
    let browser;
    before(async () => { browser = await launch(draws ? screen : null, scheme); });
    after(() => browser.close());
    for (const [name, check] of Object.entries(checks)) test(name, () => check(browser));
    test('it fits screens of five widths, and axe-core finds no fault', () => looksRight(browser, draws, scheme));
  });
}
