// The page of `headpin play` in a real Chromium, played by mouse, touch and keys.
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { launch } from './chromium.mjs';
import { axeFinds, until } from './page.mjs';
import { endAndSave, flick, inputOf, onPage, openGame, pictures, rooms, startGame, verified } from './play.mjs';
import { folder, headpin } from './program.mjs';

const kHome = [0.35, -0.25, 0.85];  // m: the ball on its stand
const kRed = [-0.55, 0, 1.1];       // m: the button that begins the red version

let browser;
let server;

before(async () => ({ browser, server } = await rooms()));
after(async () => {
  await browser?.close();
  server?.close();
});

const contextOf = (options) => browser.newContext({ viewport: { width: 640, height: 480 }, acceptDownloads: true, ...options });

async function open(options = {}, file = 'room.html') {
  const context = await contextOf(options);
  return { context, ...(await openGame(context, `${server.url}/${file}`)) };
}

const held = (page) => until(page, () => window.headpin.game.view[4] > 0);
const felled = (page) => until(page, () => window.headpin.game.score.skittles_down > 0);
const hint = (page) => page.textContent('#hint');
const infoOf = (name) => JSON.parse(headpin('info', name, '--json'));

/** Takes the ball, and throws it. */
async function throwBy(page, device, how, home = kHome) {
  const send = await inputOf(page, device);
  const at = await onPage(page, home);
  if (device === 'mouse') await send('move', at[0], at[1]);
  await pictures(page);
  await send('down', at[0], at[1]);
  await held(page);
  await pictures(page, 10);
  await flick(send, at, how);
}

test('it is no larger than a mail takes', () => {
  assert.ok(statSync(join(folder, 'room.html')).size < 1.6e6);
});

test('a throw by mouse fells skittles, and its log replays to the bit', async () => {
  const { page, said, context } = await open();
  await page.fill('#participant', 'Ünal / 7');
  await startGame(page);
  await throwBy(page, 'mouse');
  await felled(page);
  await until(page, () => /^Skittles down: [1-9]/.test(document.getElementById('score').textContent));
  const result = await endAndSave(page, 'mouse.lcmlog');
  const replayed = verified('mouse.lcmlog');
  assert.equal(replayed.game_hash, result.game);
  assert.equal(replayed.state_hash, result.state);
  assert.equal(replayed.verified_ticks, result.ticks);
  assert.equal(replayed.skittles_down, result.down);
  const [{ release_speed_mps: speed, velocity_mps: v }] = replayed.throws;
  assert.ok(speed > 4 && speed < 8, `${speed} m/s`);
  assert.ok(Math.abs(v[2]) < 1, `${v[2]} m/s up`);
  const info = infoOf('mouse.lcmlog');
  assert.equal(info.participant, 'Ünal / 7');
  assert.ok(info.complete);
  assert.deepEqual(said, []);
  await context.close();
});

test('in a room with sound the page plays, to the bit, what `frames --sound` writes of its log', async () => {
  headpin('play', '--set', 'sound.on=true', '-o', 'loud.html');
  const { page, said, context } = await open({}, 'loud.html');
  await page.evaluate(() => {
    const { sound } = window.headpin;
    const play = sound.play.bind(sound);
    window.samples = [];
    sound.play = (samples) => {
      window.samples.push(...samples);
      play(samples);
    };
  });
  await startGame(page);
  assert.equal(await page.isVisible('#mute'), true);
  await throwBy(page, 'mouse');
  await felled(page);
  await until(page, () => window.headpin.sound.played > 48_000);
  const volume = () => page.evaluate(() => window.headpin.sound.volume.gain.value);
  assert.equal(await volume(), 1);
  await page.keyboard.press('m');
  assert.equal(await volume(), 0);
  assert.equal(await page.getAttribute('#mute', 'aria-pressed'), 'true');
  await page.click('#mute');
  assert.equal(await volume(), 1);
  const { ticks } = await endAndSave(page, 'loud.lcmlog');
  const heard = await page.evaluate(() => window.samples);
  assert.equal(heard.length, 2 * 200 * ticks);  // 48000 Hz over 240 Hz, two ears
  headpin('frames', 'loud.lcmlog', '--sound', 'loud.wav');
  const wav = readFileSync(join(folder, 'loud.wav'));
  const written = new Int16Array(wav.buffer.slice(wav.byteOffset + 44, wav.byteOffset + wav.length));
  const common = Math.min(heard.length, written.length);
  assert.ok(common > 0.9 * heard.length);
  const differs = heard.findIndex((sample, i) => i < common && sample !== written[i]);
  assert.equal(differs, -1);
  assert.ok(heard.some((sample) => Math.abs(sample) > 1000));  // the ball has struck
  assert.deepEqual(said, []);
  await context.close();
});

/** The text that the score board of the page shows. */
const boardOf = (page) => page.evaluate(() => {
  const { board } = window.headpin.room;
  const known = Object.entries(board.characters);
  const characterOf = ({ visible, geometry }) => (visible ? known.find(([, number]) => board.looks.geometry(number) === geometry)[0] : ' ');
  return board.cells.map((row) => row.map(characterOf).join(''));
});

test('the score board has what the ball counts', async () => {
  headpin('play', '--set', 'game.rules=ten-pin', '--set', 'game.show_score=true', '-o', 'board.html');
  const { page, said, context } = await open({}, 'board.html');
  await startGame(page);
  assert.deepEqual(await boardOf(page), ['_         ', 'F1       0']);
  await throwBy(page, 'mouse');
  await until(page, () => / = [1-9]/.test(window.headpin.game.score.sheets[0]));
  const [, points] = /ten-pin: \S+ = (\d+)/.exec(await page.evaluate(() => window.headpin.game.score.sheets[0]));
  const [balls, total] = await boardOf(page);
  assert.match(balls, points === '10' ? /^F?X _/ : new RegExp(`^F?${points}_`));
  assert.equal(total.slice(-3).trim(), points);
  assert.deepEqual(said, []);
  await context.close();
});

test('a room without sound offers none', async () => {
  const { page, context } = await open();
  await startGame(page);
  assert.equal(await page.isVisible('#mute'), false);
  assert.equal(await page.evaluate(() => window.headpin.sound.context), undefined);
  await context.close();
});

test('a swing that goes back first', async () => {
  const { page, context } = await open();
  await startGame(page);
  await throwBy(page, 'mouse', { back: 0.1 });
  await felled(page);
  await endAndSave(page, 'back.lcmlog');
  const [thrown] = verified('back.lcmlog').throws;
  assert.ok(thrown.release_speed_mps > 4 && thrown.release_speed_mps < 12, `${thrown.release_speed_mps} m/s`);
  assert.ok(thrown.position_m[2] < 0.5, `${thrown.position_m[2]} m above the lane`);
  assert.ok(Math.abs(thrown.velocity_mps[2]) < 1, `${thrown.velocity_mps[2]} m/s up`);
  await context.close();
});

test('a throw with the left hand', async () => {
  const { page, context } = await open();
  await page.check('#hands [value=left]');
  await startGame(page);
  // Hand and ball are drawn as mirror images.
  const sides = () => page.evaluate(() => [window.headpin.room.hand, ...window.headpin.room.balls]
    .flatMap(({ objects }) => objects.map(({ matrixWorld }) => Math.sign(matrixWorld.determinant()))));
  assert.ok((await sides()).every((side) => side === -1));
  await throwBy(page, 'mouse', undefined, [-kHome[0], kHome[1], kHome[2]]);
  await felled(page);
  await endAndSave(page, 'left_hand.lcmlog');
  const [{ position_m: [x] }] = verified('left_hand.lcmlog').throws;
  assert.ok(Math.abs(x) < 0.02, `${x} m beside the middle of the lane`);
  await context.close();
});

test('by keys alone: a throw, the end, and the file', async () => {
  const { page, said, context } = await open();
  await page.focus('#start');
  await startGame(page, () => page.keyboard.press('Enter'));
  await page.keyboard.down(' ');
  await held(page);
  await until(page, () => /^Let the space bar go/.test(document.getElementById('hint').textContent));
  await page.keyboard.up(' ');
  await felled(page);
  await page.focus('#end');
  await page.keyboard.press('Enter');
  await until(page, () => document.activeElement.id === 'save-last');
  assert.ok(await page.evaluate(() => window.headpin.last.skittles_down > 0));
  assert.deepEqual(said, []);
  await context.close();
});

test('a throw by the space bar has the speed of its swing, however long it was held', async () => {
  headpin('play', '--set', 'game.rules=plain', '--set', 'game.frames=100', '--set', 'game.ball_back_s=2', '-o', 'frames.html');
  const { page, context } = await open({}, 'frames.html');
  await startGame(page);
  for (const held_ms of [60, 330, 590, 810, 1100]) {
    await until(page, () => /^Press on the ball/.test(document.getElementById('hint').textContent));
    await page.keyboard.down(' ');
    await held(page);
    await page.waitForTimeout(held_ms);  // of what is tested any would do
    await page.keyboard.up(' ');
    await until(page, () => /^Wait/.test(document.getElementById('hint').textContent));
  }
  await endAndSave(page, 'held.lcmlog');
  const { throws } = verified('held.lcmlog');
  headpin('export', 'held.lcmlog', '-o', 'held');
  const rows = readFileSync(join(folder, 'held', 'buttons.csv'), 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
  const pressed = ([, , , , trigger]) => trigger === '1';
  const presses = rows.filter((row, i) => pressed(row) !== (i > 0 && pressed(rows[i - 1]))).map(([time]) => Number(time));
  assert.equal(presses.length, 2 * throws.length);
  throws.forEach(({ release_speed_mps: speed, samples_left_out: out, extrapolated_s: after }, i) => {
    // Held for h s, it has v = 4 + 4 h m/s, 8 at most, after 2 * 0.85 m / v.
    const took = presses[2 * i + 1] - presses[2 * i], b = 4 + 4 * took;
    const v = Math.min(8, (b + Math.sqrt(b * b - 16 * 1.7)) / 2);
    assert.ok(Math.abs(speed / v - 1) < 0.04, `${speed} m/s for ${v} after ${took} s`);
    assert.equal(out, 0);
    assert.ok(after === null || after < 0.001, `extrapolated by ${after} s`);
  });
  await context.close();
});

test('a ball that is out of reach is not taken by a key', async () => {
  const { page, context } = await open();
  await startGame(page);
  await page.keyboard.down(' ');
  await held(page);
  await page.keyboard.up(' ');
  await felled(page);
  assert.match(await hint(page), /The ball is thrown/);
  await page.keyboard.down(' ');
  const made = await page.evaluate(() => window.headpin.game.made);
  await until(page, (since) => window.headpin.game.made > since + 200_000, made);
  assert.equal(await page.evaluate(() => window.headpin.game.view[4]), 0);
  await context.close();
});

test('a key that is down when the page loses the keys does not walk on', async () => {
  const { page, context } = await open();
  await startGame(page);
  const walked = () => page.evaluate(() => window.headpin.game.view[10]);  // y of X_WP
  await page.keyboard.down('w');
  await until(page, () => window.headpin.game.view[10] > 0.05);
  await page.focus('#end');
  await until(page, () => !window.headpin.game.pressed.left);
  let stopped;
  do {  // one that walks on ends at a wall
    stopped = await walked();
    await pictures(page, 20);
  } while (await walked() !== stopped);
  assert.ok(stopped < 1.5, `walked ${stopped} m`);
  await context.close();
});

test('a space bar that is down when the page loses the keys throws', async () => {
  const { page, context } = await open();
  await startGame(page);
  await page.keyboard.down(' ');
  await held(page);
  await page.focus('#end');
  await felled(page);
  await context.close();
});

test('on a phone held upright, by touch; a second finger changes nothing', async () => {
  const { page, said, context } = await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  const start = await page.locator('#start').boundingBox();
  assert.ok(start.y + start.height < 844, `the button is at ${start.y}`);
  await startGame(page, () => page.tap('#start'));
  await throwBy(page, 'touch');
  await felled(page);
  await page.evaluate(() => {
    const { hand } = window.headpin;
    hand.finger = 7;
    hand.moved(new PointerEvent('pointermove', { pointerId: 8, clientX: 1, clientY: 1 }));
    hand.lifted(new PointerEvent('pointerup', { pointerId: 8 }));
    if (hand.finger !== 7) throw new Error('the second finger let go');
  });
  assert.deepEqual(said, []);
  await context.close();
});

test('the red button begins its version when it is pressed, and no pointer that passes does', async () => {
  const { page, context } = await open({}, 'experiment.html');
  await startGame(page);
  assert.match(await hint(page), /^Press on the red or the blue ball/);
  const send = await inputOf(page, 'mouse');
  const at = await onPage(page, kRed);
  await send('move', at[0], at[1]);
  const made = await page.evaluate(() => window.headpin.game.made);
  await until(page, (since) => window.headpin.game.made > since + 300_000, made);
  assert.equal(await page.evaluate(() => window.headpin.game.score.sheets.length), 0);
  await send('down', at[0], at[1]);
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  await send('up', at[0], at[1]);
  assert.match(await page.textContent('#score'), /^red /);
  await context.close();
});

test('a version by keys alone: it counts, and the ball comes back', async () => {
  const { page, context } = await open({}, 'experiment.html');
  await startGame(page);
  await page.keyboard.down('b');
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  await page.keyboard.up('b');
  await page.keyboard.down(' ');
  await held(page);
  await page.keyboard.up(' ');
  await until(page, () => !/no ball/.test(document.getElementById('score').textContent));
  assert.match(await page.textContent('#score'), /^blue /);
  // On its way the hand has touched no other button.
  assert.equal(await page.evaluate(() => window.headpin.game.score.sheets.length), 1);
  await until(page, () => /^Press on the ball/.test(document.getElementById('hint').textContent));
  await page.keyboard.press('r', { delay: 100 });
  await until(page, () => window.headpin.game.score.sheets.length === 2);
  const { game } = await endAndSave(page, 'version.lcmlog');
  assert.match(await hint(page), /^The game was ended before its last frame\. blue .* \(not over\); red .*no ball = 0 \(not over\)\.$/);
  const replayed = verified('version.lcmlog');
  assert.equal(replayed.game_hash, game);
  assert.equal(replayed.throws[0].foul, false);
  await context.close();
});

test('after the first of two versions the page says what begins the other one', async () => {
  headpin('play', 'paper-experiment', '--set', 'game.frames=1', '--set', 'game.balls=1', '-o', 'versions.html');
  const { page, said, context } = await open({}, 'versions.html');
  await startGame(page);
  await page.keyboard.press('r', { delay: 100 });
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  await page.keyboard.down(' ');
  await held(page);
  await page.keyboard.up(' ');
  await until(page, () => window.headpin.game.score.last_over);
  await until(page, () => document.getElementById('hint').textContent
    === 'This version is over. Press on the blue ball: the next version begins. Or press the key B.');
  await page.click('#end');
  await page.waitForSelector('#save-last');
  await until(page, () => /^The game is over\. The blue version was not played\. red [^;]*\.$/
    .test(document.getElementById('hint').textContent));
  assert.deepEqual(said, []);
  await context.close();
});

test('a foul is told', async () => {
  const { page, context } = await open({ viewport: { width: 640, height: 640 } }, 'experiment.html');
  await startGame(page);
  await page.keyboard.press('r', { delay: 100 });
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  await throwBy(page, 'mouse', { up: 0.6 });
  await until(page, () => /^You let go beyond the foul line/.test(document.getElementById('hint').textContent));
  await context.close();
});

test('a browser that cannot draw says so', async () => {
  const flat = await launch(['--disable-gpu', '--disable-software-rasterizer']);
  const page = await flat.newPage();
  await page.goto(`${server.url}/room.html`);
  await page.waitForSelector('#trouble:not([hidden])');
  assert.match(await page.textContent('#trouble'), /cannot draw in 3D/);
  await flat.close();
});

test('two clicks begin one game', async () => {
  const { page, context } = await open();
  await startGame(page, () => page.evaluate(() => {
    for (let i = 0; i < 2; ++i) document.getElementById('start').click();
  }));
  await endAndSave(page, 'once.lcmlog');
  assert.equal(await page.locator('#files li').count(), 1);
  assert.ok(verified('once.lcmlog').complete);
  await context.close();
});

test('a pause is left out of the session', async () => {
  const { page, context } = await open();
  await startGame(page);
  const made = await page.evaluate(() => {
    for (const from = performance.now(); performance.now() < from + 2000;);  // as a hidden page: nothing is drawn
    return window.headpin.game.made;
  });
  await until(page, (since) => window.headpin.game.made > since + 500_000, made);
  await endAndSave(page, 'pause.lcmlog');
  const { events } = infoOf('pause.lcmlog');
  const longest = Math.max(...events.filter(({ kind }) => kind === 'paused').map(({ value }) => value));
  assert.ok(longest > 1.5, `${longest} s`);
  assert.deepEqual(events.filter(({ kind }) => kind === 'tracking_lost'), []);
  assert.ok(verified('pause.lcmlog').complete);
  await context.close();
});

for (const options of [{}, { viewport: { width: 390, height: 844 } }, { colorScheme: 'dark' }]) {
  test(`axe finds nothing wrong: ${JSON.stringify(options)}`, async () => {
    const { page, asked, context } = await open(options, 'experiment.html');
    assert.deepEqual(await axeFinds(page), []);
    await startGame(page);
    assert.deepEqual(await axeFinds(page), []);
    await page.click('#end');
    await page.waitForSelector('#save-last');
    assert.deepEqual(await axeFinds(page), []);
    assert.deepEqual(asked(), []);
    await context.close();
  });
}
