// What the page shows of several trials, and of a trial that is simulated again: in Chromium.
import assert from 'node:assert/strict';
import { copyFileSync, truncateSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { launch, open } from './chromium.mjs';
import { drawnAt, until } from './page.mjs';
import { demo, folder, headpin } from './program.mjs';

let browser;

before(async () => {
  headpin('replay', demo, '-o', 'game.lcmlog');
  headpin('replay', demo, '--set', 'skittle.seen=collider', '--set', 'lane.head_pin=5', '-o', 'short.lcmlog');
  headpin('report', 'game.lcmlog', 'short.lcmlog', '-o', 'rooms.html');
  browser = await launch();
});
after(() => browser.close());

/** Moves a control of the engine and waits until the trial is simulated again with it. */
async function simulatedWith(page, id, value) {
  await page.waitForSelector('html[data-engine=yes]');
  await page.evaluate(async ([control, to]) => {
    const { again } = window.headpin;
    const element = document.getElementById(control);
    element.value = to;
    element.dispatchEvent(new Event(element.tagName === 'SELECT' ? 'change' : 'input', { bubbles: true }));
    while (again.running || again.wanted) await new Promise((resolve) => setTimeout(resolve, 20));
  }, [id, String(value)]);
}

/** The roles of the actors that are shown at a tick, and those of them that have no mesh to be drawn with. */
function drawnOf(page, cast) {
  return page.evaluate((name) => {
    const { [name]: of } = window.headpin.view;
    const shown = of.shown.map(({ mesh, objects }, i) => [of.trial.json.actors[i].role, mesh, objects.has(mesh)])
      .filter(([, mesh]) => mesh >= 0);
    return { shown: shown.map(([role]) => role), missing: shown.filter(([, , there]) => !there).map(([role]) => role) };
  }, cast);
}

test('skittles are drawn in both collision shapes, whichever was recorded', async () => {
  headpin('replay', demo, '--set', 'skittle.seen=collider', '-o', 'collider.lcmlog');
  headpin('report', 'collider.lcmlog', '-o', 'collider.html');
  const { page, said } = await open(browser, 'collider.html');
  for (const shape of ['ellipsoid', 'true']) {
    await simulatedWith(page, 'shape', shape);
    await drawnAt(page, 10);
    const { shown, missing } = await drawnOf(page, 'cast');
    assert.equal(shown.filter((role) => role === 'skittle').length, 10);
    assert.deepEqual(missing, [], shape);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('the hand of the second trial is drawn while it holds the ball, also where the first never takes it', async () => {
  copyFileSync(demo, join(folder, 'idle.lcmlog'));
  truncateSync(join(folder, 'idle.lcmlog'), 30_000);  // before the trigger is pressed
  assert.ok(!JSON.parse(headpin('info', 'idle.lcmlog', '--json')).events.some(({ kind }) => kind === 'grab'));
  headpin('report', 'idle.lcmlog', demo, '-o', 'grabs.html');
  const { events } = JSON.parse(headpin('info', 'game.lcmlog', '--json'));
  const grab = events.find(({ kind }) => kind === 'grab').tick;
  const { page } = await open(browser, 'grabs.html');
  for (const tick of [grab - 10, grab + 10, grab + 100]) {
    await drawnAt(page, tick);
    const { shown, missing } = await drawnOf(page, 'otherCast');
    assert.ok(shown.includes('hand'));
    assert.deepEqual(missing, [], `at tick ${tick}`);
  }
  await page.context().close();
});

/** Which buttons are chosen of what is shown: of the trial and what was simulated again, and of two trials. */
function chosen(page) {
  return page.evaluate(() => ['shown', 'pair'].map((name) => document.querySelector(`#${name} :checked`)?.value ?? ''));
}

test('simulated again, the first trial is in its own room, whichever trial was shown before', async () => {
  const { page, said } = await open(browser, 'rooms.html');
  await page.click('#pair [value=b]');
  await simulatedWith(page, 'friction', 0.3);
  const [drawn, recorded, second] = await page.evaluate(() => {
    const { view, trial, other } = window.headpin;
    const rowsOf = ({ json, sections }) => json.meshes.map(({ number }) => [number, sections.get(`mesh ${number} vertices`).rows]);
    return [[...view.looks.geometries].map(([number, { attributes }]) => [number, attributes.position.count]), rowsOf(trial), rowsOf(other)];
  });
  assert.notDeepEqual(recorded, second);
  assert.deepEqual(drawn, recorded);
  assert.deepEqual(await chosen(page), ['again', '']);

  await page.click('#pair [value=b]');
  assert.deepEqual(await chosen(page), ['recorded', 'b']);
  const isShown = (which) => page.evaluate((name) => window.headpin.view.trial === (name === 'again' ? window.headpin.again.again : window.headpin[name]), which);
  assert.ok(await isShown('other'));
  await page.click('#shown [value=again]');
  assert.ok(await isShown('again'));
  await page.click('#shown [value=recorded]');
  assert.ok(await isShown('trial'));
  assert.deepEqual(await chosen(page), ['recorded', 'both']);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('"at the skittles" is where the skittles of the shown trial are', async () => {
  const { page } = await open(browser, 'rooms.html');
  for (const [which, name] of [['a', 'trial'], ['b', 'other'], ['both', 'trial']]) {
    await page.click(`#pair [value=${which}]`);
    await page.selectOption('#from', 'behind');
    await page.selectOption('#from', 'skittles');
    const [target, pin] = await page.evaluate((of) => [window.headpin.view.orbit.target.y, window.headpin[of].json.room.head_pin], name);
    assert.ok(Math.abs(target - pin - 0.3) < 1e-9, `${which}: ${target}, head pin at ${pin}`);
  }
  await page.context().close();
});

test('a video of a part of the trial says so, and stays at its last picture', async () => {
  headpin('frames', 'game.lcmlog', '--frames', '230-259', '--video', 'part.mkv');
  headpin('report', 'game.lcmlog', '-o', 'part.html', '--video', 'part.mp4');
  const { page, said } = await open(browser, 'part.html');
  await page.waitForSelector('#video:not([hidden])');
  assert.match(await page.textContent('#video-part'), /lasts 0\.500 s, the trial 7\.008 s/);
  await drawnAt(page, 60);  // 0.25 s
  await until(page, () => Math.abs(document.querySelector('video').currentTime - 0.25) < 0.01);
  await page.evaluate(() => {
    const { clock } = window.headpin;
    window.seen = [];
    clock.onChange(() => window.seen.push([clock.tick, document.querySelector('video').currentTime]));
    clock.setSpeed(0.25);
    clock.play();
  });
  await until(page, () => window.headpin.clock.tick > 300);
  const seen = await page.evaluate(() => window.seen);
  const after = seen.filter(([tick]) => tick > 160);  // a while after its end at 120
  assert.ok(after.length > 0 && after.every(([, time]) => time > 0.4), seen.join(' '));
  assert.ok(seen.every(([, time], i) => i === 0 || time > seen[i - 1][1] - 0.15), seen.join(' '));
  await page.evaluate(() => { window.headpin.clock.pause(); window.headpin.clock.go(24); });
  await until(page, () => Math.abs(document.querySelector('video').currentTime - 0.1) < 0.01);
  assert.deepEqual(said, []);
  await page.context().close();
});
