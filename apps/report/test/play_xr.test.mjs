// The page of `headpin play` with a headset: IWER emulates a Quest 3, its motion is computed here.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';

import { launch } from './chromium.mjs';
import { until } from './page.mjs';
import { openGame, saved, serve, verified } from './play.mjs';
import { headpin } from './program.mjs';

const iwer = createRequire(import.meta.url).resolve('iwer/build/iwer.min.js');

let browser;
let server;

before(async () => {
  headpin('play', '-o', 'room.html');
  headpin('play', 'paper-experiment', '-o', 'experiment.html');
  browser = await launch();
  server = await serve();
});
after(async () => {
  await browser?.close();
  server?.close();
});

/** Runs in the page: a headset, and a person who wears it, as a function of time. */
function wear({ inputs }) {
  const device = new window.IWER.XRDevice(window.IWER.metaQuest3);
  device.installRuntime({ forceInstall: true });  // over Chromium's own, which has no headset
  device.primaryInputMode = inputs;
  device.stereoEnabled = true;
  window.worn = { device };

  // The wearer stands somewhere in the room and looks to the side: the page has to recentre.
  const turn = 0.5;
  const stands = [0.4, 0, -0.3];
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const inRoom = ([x, y, z]) => [stands[0] + c * x + s * z, y, stands[2] - s * x + c * z];
  const yaw = [Math.cos(turn / 2), 0, Math.sin(turn / 2), 0];
  const times = (a, b) => [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]];
  const turned = (q, [x, y, z]) => times(times(q, [0, x, y, z]), [q[0], -q[1], -q[2], -q[3]]).slice(1);
  const put = (object, q, p) => {
    object.position.set(...p);
    object.quaternion.set(q[1], q[2], q[3], q[0]);
  };
  put(device, yaw, inRoom([0, 1.7, 0]));

  const input = (hand) => (inputs === 'hand' ? device.hands[hand] : device.controllers[hand]);
  const press = (hand, down) => (inputs === 'hand' ? input(hand).updatePinchValue(down ? 1 : 0)
    : input(hand).updateButtonValue('trigger', down ? 1 : 0));

  /** Moves a hand: its axes as those of the room, its place p in T; the grip is told from the ray. */
  const move = (hand, p, grip) => {
    const q_HS = hand === 'left' ? [0.5, 0.5, -0.5, -0.5] : [0.5, 0.5, 0.5, 0.5];
    const q = times(times(yaw, q_HS), [grip.q[0], -grip.q[1], -grip.q[2], -grip.q[3]]);
    const [dx, dy, dz] = turned(q, grip.p);
    const [x, y, z] = inRoom(p);
    put(input(hand), q, [x - dx, y - dy, z - dz]);
  };

  /** Where a grip is seen from the ray that it belongs to. */
  const gripOf = (hand) => new Promise((resolve) => {
    const { session } = window.headpin.xr;
    const look = (time, frame) => {
      const source = [...session.inputSources].find(({ handedness }) => handedness === hand);
      const { floor } = window.headpin.xr;
      const [ray, grip] = ['targetRaySpace', 'gripSpace'].map((space) => source && frame.getPose(source[space], floor)?.transform);
      if (!ray || !grip) return session.requestAnimationFrame(look);
      const [q, r] = [ray, grip].map(({ orientation: o }) => [o.w, o.x, o.y, o.z]);
      const back = [q[0], -q[1], -q[2], -q[3]];
      const off = ['x', 'y', 'z'].map((axis) => grip.position[axis] - ray.position[axis]);
      return resolve({ q: times(back, r), p: turned(back, off) });
    };
    session.requestAnimationFrame(look);
  });

  /** Calls `at(seconds)` before each frame until it gives true. Where frames are slow, the motion is. */
  const during = (at) => new Promise((resolve) => {
    const slowest = 0.04;  // s between two frames: poses further apart would tell of no swing
    let moved = 0;
    let before;
    const step = (time) => {
      moved += Math.min(slowest, (time - (before ?? time)) / 1e3);
      before = time;
      if (at(moved)) resolve();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });

  const smooth = (x) => (x <= 0 ? 0 : x >= 1 ? 1 : x ** 3 * (10 + x * (6 * x - 15)));
  const inT = ([x, y, z]) => {
    const [, , , , ox, oy] = window.headpin.game.X_WT;
    return [x - ox, z, -(y - oy)];
  };

  /** Touches a place of the world with the open hand. */
  window.worn.touch = async (hand, place) => {
    const grip = await gripOf(hand);
    const to = inT(place);
    const from = [to[0], to[1], to[2] + 0.4];
    await during((t) => {
      move(hand, from.map((x, i) => x + smooth(t) * (to[i] - x)), grip);
      return t > 1.2;
    });
    await during((t) => {
      move(hand, to.map((x, i) => x + smooth(t) * (from[i] - x)), grip);
      return t > 1.2;
    });
  };

  /** Takes the ball, swings it along the lane at 16 m/s2 and lets it go after 0.4 s. */
  window.worn.throwBall = async (hand) => {
    const { game, json } = window.headpin;
    const grip = await gripOf(hand);
    const home = json.ball.homes[0];
    const reach = (ball) => move(hand, inT(ball).map((x, i) => x - game.grip[i]), grip);
    await during((t) => {
      reach(home.map((x, i) => x + [0, -0.3, 0.4][i] * (1 - smooth(t))));
      return t > 1.3;
    });
    await during((t) => {
      reach(home);
      if (game.view[4] > 0) return true;
      press(hand, Math.floor(t) % 2 === 0);  // once more where it was not taken
      return false;
    });
    let on = true;
    await during((t) => {
      const s = Math.max(0, t - 0.3);
      const across = Math.min(1, s / 0.3);
      const swung = Math.min(s, 0.6);
      reach([(1 - across) * home[0], home[1] + 8 * swung ** 2, home[2] - 0.6 * across]);
      if (on && s >= 0.4) press(hand, on = false);
      return s > 1;
    });
  };
}

async function enter(inputs, { left = false, file = 'room.html' } = {}) {
  const context = await browser.newContext({ viewport: { width: 480, height: 300 }, acceptDownloads: true });
  await context.addInitScript({ path: iwer });
  await context.addInitScript(wear, { inputs });
  const opened = await openGame(context, `${server.url}/${file}`);
  const { page } = opened;
  if (left) await page.check('#hands input[value=left]');
  await page.click('#vr');
  await until(page, () => window.headpin.game?.frames > 3);
  return { context, ...opened };
}

async function felled(page) {
  await until(page, () => window.headpin.game.score.skittles_down > 0);
}

for (const [inputs, hand] of [['controller', 'right'], ['controller', 'left'], ['hand', 'right']]) {
  test(`a throw with the ${hand} ${inputs}`, async () => {
    const { page, said, context } = await enter(inputs, { left: hand === 'left' });
    await page.evaluate((which) => window.worn.throwBall(which), hand);
    await felled(page);
    await page.evaluate(() => window.headpin.xr.session.end());  // the wearer leaves
    const result = await saved(page, `${inputs}-${hand}.lcmlog`);
    const replayed = verified(`${inputs}-${hand}.lcmlog`);
    assert.equal(replayed.game_hash, result.game);
    assert.equal(replayed.verified_ticks, result.ticks);
    assert.equal(replayed.skittles_down, result.down);
    const info = JSON.parse(headpin('info', `${inputs}-${hand}.lcmlog`, '--json'));
    assert.ok(info.complete);
    const told = info.events.filter(({ kind }) => kind === 'played_with');
    assert.equal(told.length, 1);
    const { views, inputs: sources } = JSON.parse(told[0].detail);
    assert.deepEqual(views.map(({ eye }) => eye), ['left', 'right']);
    assert.ok(views.every(({ left, right, up, down }) => left < -30 && right > 30 && up > 30 && down < -30), JSON.stringify(views));
    assert.equal(sources.length, 2);
    assert.equal(info.events.filter(({ kind }) => kind === 'recentred').length, 1);
    // The hand does 6.4 m/s as it lets go, and less where frames are slow.
    const [{ value: speed }] = info.events.filter(({ kind }) => kind === 'release');
    assert.ok(speed > 1 && speed < 9, `${speed} m/s`);
    assert.deepEqual(said.filter((line) => !/GPU stall|GL Driver/.test(line)), []);
    await context.close();
  });
}

test('the hand touches the red button, and its version begins', async () => {
  const { page, context } = await enter('controller', { file: 'experiment.html' });
  await page.evaluate(() => window.worn.touch('right', [-0.55, 0, 1.1]));
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  assert.match(await page.textContent('#score'), /^red /);
  await context.close();
});
