// The page of `headpin play` with a headset that IWER emulates.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { stepClock, wear } from './headset.mjs';
import { until } from './page.mjs';
import { openGame, rooms, saved, verified } from './play.mjs';
import { readPng } from './png.mjs';
import { folder, headpin } from './program.mjs';

const iwer = createRequire(import.meta.url).resolve('iwer/build/iwer.min.js');
const kRate = 72;  // frames a second

let browser;
let server;

before(async () => ({ browser, server } = await rooms()));
after(async () => {
  await browser?.close();
  server?.close();
});

async function enter(inputs, { left = false, file = 'room.html', ahead = 0 } = {}) {
  const context = await browser.newContext({ viewport: { width: 320, height: 160 }, acceptDownloads: true });
  await context.addInitScript(stepClock, { hz: kRate });
  await context.addInitScript({ path: iwer });
  await context.addInitScript(wear, { inputs, ahead });
  const opened = await openGame(context, `${server.url}/${file}`);
  const { page } = opened;
  if (left) await page.check('#hands input[value=left]');
  await page.click('#vr');
  await until(page, () => window.headpin.game?.frames > 3);
  return { context, ...opened };
}

/** The wearer leaves; the game must be the same to the bit in a replay. */
async function leave({ page, context, said }, name) {
  await page.evaluate(() => window.headpin.xr.session.end());
  const result = await saved(page, name);
  assert.deepEqual(said.filter((line) => !/GPU stall|GL Driver/.test(line)), []);
  await context.close();
  const replayed = verified(name);
  assert.equal(replayed.game_hash, result.game);
  assert.equal(replayed.verified_ticks, result.ticks);
  assert.equal(replayed.skittles_down, result.down);
  const { complete, events } = JSON.parse(headpin('info', name, '--json'));
  assert.ok(complete);
  const told = (kind) => events.filter((event) => event.kind === kind);
  return { result, told };
}

for (const [inputs, hand] of [['controller', 'right'], ['controller', 'left'], ['hand', 'right'], ['hand', 'left']]) {
  test(`a throw with the ${hand} ${inputs}`, async () => {
    const opened = await enter(inputs, { left: hand === 'left' });
    const { page } = opened;
    await page.evaluate((which) => window.worn.throwBall(which), hand);
    await until(page, () => window.headpin.game.score.skittles_down > 0);
    const { told } = await leave(opened, `${inputs}-${hand}.lcmlog`);
    const [{ value: speed }, ...more] = told('release');
    assert.equal(more.length, 0);
    assert.ok(Math.abs(speed - 6.4) < 0.3, `${speed} m/s: the hand moved at 6.4 m/s as it let go`);
    assert.equal(told('foul').length, 0);
    assert.equal(told('paused').length, 0);
    assert.equal(told('recentred').length, 1);
    const [{ late_frames: late, frames }] = told('kept_pace').map(({ detail }) => JSON.parse(detail));
    assert.equal(late, 0);
    assert.ok(frames > 2 * kRate);
  });
}

test('the samples of a page make the same game in `headpin live`', () => {
  headpin('live', 'controller-right.lcmlog', '--eyes', 'none', '--record', 'live.lcmlog');
  // The two end some ticks apart; up to there each state is the same.
  const { a, b, first_difference_tick: first } = JSON.parse(headpin('compare', 'controller-right.lcmlog', 'live.lcmlog', '--json'));
  assert.ok(first === null || first > Math.min(a.ticks, b.ticks), `they differ in tick ${first} of ${a.ticks} and ${b.ticks}`);
  assert.ok(a.ticks - b.ticks < 24 && a.throw_count === 1);
});

test('poses that are predicted are for their own time; the trigger is pulled now', async () => {
  const kAhead = 30;
  const opened = await enter('controller', { ahead: kAhead });
  const { page } = opened;
  await page.evaluate(() => window.worn.throwBall('right'));
  await until(page, () => window.headpin.game.score.skittles_down > 0);
  const { told } = await leave(opened, 'predicted.lcmlog');
  assert.equal(JSON.parse(told('played_with')[0].detail).device, 'predicting-webxr');
  const [{ value: speed }] = told('release');
  const law = 16 * (0.4 - kAhead / 1000);  // where the hand was when the trigger was let go
  assert.ok(Math.abs(speed - law) < 0.3, `${speed} m/s, expected ${law}`);
  const { devices } = JSON.parse(headpin('info', 'predicted.lcmlog', '--json'));
  assert.ok(devices.length > 2, JSON.stringify(devices));
});

test('the log tells what is worn', async () => {
  const opened = await enter('controller');
  const { told } = await leave(opened, 'worn.lcmlog');
  const [{ detail }, ...more] = told('played_with');
  assert.equal(more.length, 0);
  const { device, inputs, frame_rate_hz: rate, frame_rates_hz: rates, views } = JSON.parse(detail);
  assert.equal(device, 'generic-webxr');
  assert.deepEqual(inputs.map(({ handedness }) => handedness).sort(), ['left', 'right']);
  assert.ok(inputs.every(({ profiles }) => profiles.includes('meta-quest-touch-plus')), JSON.stringify(inputs));
  assert.ok(rates.includes(rate), `${rate} is none of ${rates}`);
  assert.deepEqual(views.map(({ eye }) => eye), ['left', 'right']);
  const [from, to] = views.map(({ offset }) => offset);
  assert.ok(Math.abs(to[0] - from[0] - 0.063) < 0.002, `the eyes are ${from} and ${to}`);
  assert.ok(views.every(({ left, right, up, down }) => left < -30 && right > 30 && up > 30 && down < -30), JSON.stringify(views));
});

/** How many colours a picture has. */
function coloursOf(pixels, channels) {
  const colours = new Set();
  for (let i = 0; i < pixels.length; i += channels) colours.add(pixels.slice(i, i + 3).join());
  return colours.size;
}

test('each eye has a picture of its own, and the page has one afterwards', async () => {
  const { page, context } = await enter('controller');
  const [left, right] = await page.evaluate(() => window.worn.seen());
  for (const eye of [left, right]) assert.ok(coloursOf(eye, 4) > 50, `${coloursOf(eye, 4)} colours`);
  const other = left.filter((x, i) => Math.abs(x - right[i]) > 8).length / left.length;
  assert.ok(other > 0.005 && other < 0.5, `${100 * other} % are other numbers`);
  await page.evaluate(() => window.headpin.xr.session.end());
  await page.waitForSelector('#save-last');
  await page.evaluate(() => window.worn.during((t) => t > 0.1));
  const picture = join(folder, 'after.png');
  await page.locator('#view').screenshot({ path: picture });
  const { values, channels } = readPng(picture);
  assert.ok(coloursOf(values, channels) > 50, `${coloursOf(values, channels)} colours`);
  await context.close();
});

test('the hand touches the red button, and its version begins', async () => {
  const opened = await enter('controller', { file: 'experiment.html' });
  const { page } = opened;
  await page.evaluate(() => window.worn.touch('right', window.headpin.json.buttons.find(({ colour }) => colour === 'red').p));
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  assert.match(await page.textContent('#score'), /^red /);
  await page.evaluate(() => window.worn.throwBall('right'));
  await until(page, () => window.headpin.game.score.skittles_down > 0);
  const { told } = await leave(opened, 'red.lcmlog');
  assert.deepEqual(told('version').map(({ detail }) => detail), ['red']);
});

/** The head in W: how far from where the tracked space stands [m], and how far to the side it looks. */
const head = () => {
  const { view, X_WT } = window.headpin.game;
  const [w, x, y, z, px, py] = view.subarray(19, 26);
  return { away: Math.hypot(px - X_WT[4], py - X_WT[5]), aside: Math.abs(-2 * (x * z + w * y)) };
};

test('recentring puts the wearer in front of the lane: by a button, a key and the headset itself', async () => {
  const opened = await enter('controller');
  const { page } = opened;
  const inFront = async () => {
    const { away, aside } = await page.evaluate(head);
    return away < 1e-3 && aside < 1e-3;
  };
  const drawn = (more) => page.evaluate((frames) => window.worn.during((t) => t > frames / 72), more);
  await drawn(10);
  assert.ok(await inFront());
  await page.evaluate(() => window.worn.stand(-1, [-0.5, 0.8]));
  await drawn(10);
  assert.ok(!(await inFront()));
  await page.evaluate(() => window.worn.device.controllers.right.updateButtonValue('a-button', 1));
  await drawn(20);
  assert.ok(await inFront());
  await page.evaluate(() => window.worn.device.controllers.right.updateButtonValue('a-button', 0));
  await page.evaluate(() => window.worn.stand(0.2, [-0.5, 0.3]));
  await drawn(10);
  assert.ok(!(await inFront()));
  await page.keyboard.press('r');
  await drawn(20);
  assert.ok(await inFront());
  await page.evaluate(() => window.worn.stand(0.7, [0.2, 0.1]));
  await drawn(10);
  await page.evaluate(() => window.worn.device.recenter());
  await drawn(20);
  assert.ok(await inFront());
  const { told } = await leave(opened, 'recentred.lcmlog');
  assert.equal(told('recentred').length, 4);
});

test('a hand whose place the headset only estimates does not move, and is away after 0.1 s', async () => {
  const opened = await enter('controller');
  const { page } = opened;
  const later = () => page.evaluate(() => window.worn.during((t) => t > 0.3));
  const isSeen = () => page.evaluate(() => window.headpin.game.view[2] > 0);
  const estimate = (on) => page.evaluate((estimated) => {
    XRFrame.prototype.measuredPose ??= XRFrame.prototype.getPose;
    XRFrame.prototype.getPose = function (...of) {
      const pose = this.measuredPose(...of);
      if (pose) Object.defineProperty(pose, 'emulatedPosition', { value: estimated });
      return pose;
    };
  }, on);
  await estimate(false);
  await later();
  assert.ok(await isSeen());
  await estimate(true);
  await later();
  assert.ok(!(await isSeen()));
  await estimate(false);
  await later();
  assert.ok(await isSeen());
  const { told } = await leave(opened, 'estimated.lcmlog');
  const [{ value: after, detail }, ...more] = told('tracking_lost');
  assert.equal(more.length, 0);
  assert.equal(detail, 'hand');
  assert.ok(after > 0.1 && after < 0.11, `lost after ${after} s`);
  assert.equal(told('tracking_back').length, 1);
  assert.equal(told('source_amiss').length, 2);  // of both hands, as IWER says it at first
  const hands = JSON.parse(headpin('info', 'estimated.lcmlog', '--json')).devices.filter(({ device }) => device.endsWith('hand'));
  assert.equal(hands.length, 2);
  for (const { samples, estimated } of hands) {  // measured before and after
    assert.ok(estimated > 15 && samples - estimated > 30, `${estimated} of ${samples} samples`);
  }
});

test('the stick walks, and stops when its controller goes or the headset shows its menu', async () => {
  const opened = await enter('controller');
  const { page } = opened;
  const at = () => page.evaluate(() => window.headpin.game.view[10]);  // y of X_WP
  const later = () => page.evaluate(() => window.worn.during((t) => t > 0.5));
  const push = (y) => page.evaluate((to) => window.worn.device.controllers.right.updateAxes('thumbstick', 0, to), y);
  const stands = async () => {
    await later();
    const before = await at();
    await later();
    return (await at()) === before;
  };
  await push(-1);
  await until(page, () => window.headpin.game.view[10] > 0.2);
  await page.evaluate(() => window.worn.device.updateVisibilityState('visible-blurred'));
  assert.ok(await stands());
  await page.evaluate(() => window.worn.device.updateVisibilityState('visible'));
  await later();
  assert.ok(!(await stands()));
  await page.evaluate(() => { window.worn.device.controllers.right.connected = false; });
  assert.ok(await stands());
  await push(0);
  await page.evaluate(() => { window.worn.device.controllers.right.connected = true; });
  await later();
  const { told } = await leave(opened, 'walked.lcmlog');
  for (const kind of ['tracking_lost', 'tracking_back']) {
    assert.deepEqual(told(kind).map(({ detail }) => detail), ['hand', 'hand']);
  }
  assert.deepEqual(told('played_with').map(({ detail }) => JSON.parse(detail).inputs.length), [2, 0, 2, 1, 2]);
});

test('late frames are counted, and a pause is told', async () => {
  const opened = await enter('controller');
  const { page } = opened;
  for (const late of [50, 50, 2000]) {
    await page.evaluate((by) => window.comeLate(by), late);
    await page.evaluate(() => window.worn.during((t) => t > 0.1));
  }
  const { told } = await leave(opened, 'late.lcmlog');
  const [{ value: length }, ...more] = told('paused');
  assert.equal(more.length, 0);
  assert.ok(length > 1.8 && length < 2.1, `${length} s`);
  assert.equal(JSON.parse(told('kept_pace')[0].detail).late_frames, 3);
  assert.equal(told('tracking_lost').length, 0);
});
