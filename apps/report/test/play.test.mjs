// The page of `headpin play` in a real Chromium, played by mouse, touch and keys.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { launch } from './chromium.mjs';
import { axeFinds, until } from './page.mjs';
import { endAndSave, onPage, openGame, pictures, serve, verified } from './play.mjs';
import { headpin } from './program.mjs';

const kHome = [0.35, -0.25, 0.85];  // m: the ball on its stand

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

async function open(options = {}, file = 'room.html') {
  const context = await browser.newContext({ viewport: { width: 640, height: 480 }, acceptDownloads: true, ...options });
  return { context, ...(await openGame(context, `${server.url}/${file}`)) };
}

const down = (page) => page.evaluate(() => window.headpin.game.score.skittles_down);
const held = (page) => until(page, () => window.headpin.game.view[4] > 0);
const felled = (page) => until(page, () => window.headpin.game.score.skittles_down > 0);

/** Moves a pointer as a person does, with time stamps of its own: 60 of them a second. */
async function flick(send, [x, y, height]) {
  const begin = Date.now() / 1000;
  for (let i = 0; i <= 12; ++i) {
    // It speeds up to 2.7 picture heights a second: 6 m/s.
    const up = 1.35 * height * 0.2 * (i / 12) ** 2;
    await send('move', x, y - up, begin + (i * 0.2) / 12);
  }
  await send('up', x, y - 0.27 * height, begin + 0.2);
}

/** Sends the mouse through the browser's own input, each event with its time. */
async function mouseOf(page) {
  const client = await page.context().newCDPSession(page);
  const types = { move: 'mouseMoved', down: 'mousePressed', up: 'mouseReleased' };
  return (kind, x, y, timestamp = Date.now() / 1000) => client.send('Input.dispatchMouseEvent',
    { type: types[kind], x, y, timestamp, button: kind === 'move' ? 'none' : 'left', buttons: kind === 'up' ? 0 : 1, clickCount: 1 });
}

test('a throw by mouse fells skittles, and its log replays to the bit', async () => {
  const { page, said, context } = await open();
  await page.fill('#participant', 'Ünal / 7');
  await page.click('#start');
  await pictures(page);
  const send = await mouseOf(page);
  const at = await onPage(page, kHome);
  await send('move', at[0], at[1]);
  await pictures(page);
  await send('down', at[0], at[1]);
  await held(page);
  await pictures(page, 10);
  await flick(send, at);
  await felled(page);
  await pictures(page);
  assert.match(await page.textContent('#score'), /^Skittles down: [1-9]/);
  const result = await endAndSave(page, 'mouse.lcmlog');
  const replayed = verified('mouse.lcmlog');
  assert.equal(replayed.game_hash, result.game);
  assert.equal(replayed.state_hash, result.state);
  assert.equal(replayed.verified_ticks, result.ticks);
  assert.equal(replayed.skittles_down, result.down);
  assert.ok(replayed.throws[0].speed_mps > 3 && replayed.throws[0].speed_mps < 9, `${replayed.throws[0].speed_mps} m/s`);
  const info = JSON.parse(headpin('info', 'mouse.lcmlog', '--json'));
  assert.equal(info.participant, 'Ünal / 7');
  assert.ok(info.complete);
  assert.deepEqual(said, []);
  await context.close();
});

test('by keys alone: a throw, the end, and the file', async () => {
  const { page, said, context } = await open();
  await page.focus('#start');
  await page.keyboard.press('Enter');
  await pictures(page);
  await page.keyboard.down(' ');
  await held(page);
  await pictures(page, 10);
  await page.keyboard.up(' ');
  await felled(page);
  await page.focus('#end');
  await page.keyboard.press('Enter');
  await until(page, () => document.activeElement.id === 'save-last');
  assert.ok(await page.evaluate(() => window.headpin.last.skittles_down > 0));
  assert.deepEqual(said, []);
  await context.close();
});

test('on a phone held upright, by touch', async () => {
  const { page, said, context } = await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await page.tap('#start');
  await pictures(page);
  const at = await onPage(page, kHome);
  const client = await page.context().newCDPSession(page);
  const types = { move: 'touchMove', down: 'touchStart', up: 'touchEnd' };
  const send = (kind, x, y, timestamp = Date.now() / 1000) => client.send('Input.dispatchTouchEvent',
    { type: types[kind], timestamp, touchPoints: kind === 'up' ? [] : [{ x, y }] });
  await send('down', at[0], at[1]);
  await held(page);
  await pictures(page, 10);
  await flick(send, at);
  await felled(page);
  assert.ok(await down(page) > 0);
  assert.deepEqual(said, []);
  await context.close();
});

test('the red button begins its version', async () => {
  const { page, context } = await open({}, 'experiment.html');
  await page.click('#start');
  await pictures(page);
  const send = await mouseOf(page);
  const at = await onPage(page, [-0.55, 0, 1.1]);
  await send('move', at[0], at[1]);
  await until(page, () => window.headpin.game.score.sheets.length > 0);
  assert.match(await page.textContent('#score'), /^red /);
  await context.close();
});

test('a page that is closed in a game leaves its log to the next one', async () => {
  const { page, context } = await open();
  await page.click('#start');
  await pictures(page);
  await page.keyboard.down(' ');
  await held(page);
  await until(page, () => window.headpin.store.stored > 100_000);
  const stored = await page.evaluate(() => [window.headpin.store.name, window.headpin.store.stored]);
  await page.close({ runBeforeUnload: false });
  const next = (await openGame(context, `${server.url}/room.html`)).page;
  await until(next, () => document.querySelector('#files button') !== null);
  assert.ok((await next.textContent('#files-body')).includes(stored[0]));
  const [download] = await Promise.all([next.waitForEvent('download'), next.click('#files button >> nth=0')]);
  const { join } = await import('node:path');
  const { folder } = await import('./program.mjs');
  await download.saveAs(join(folder, 'left.lcmlog'));
  const replayed = verified('left.lcmlog');
  assert.ok(replayed.verified_ticks > 100);
  next.on('dialog', (dialog) => dialog.accept());
  await next.click('#files button >> nth=1');
  await until(next, () => document.querySelector('#files button') === null);
  await context.close();
});

test('a full disk is told, and the game can still be saved', async () => {
  const { page, context } = await open();
  const client = await page.context().newCDPSession(page);
  await client.send('Storage.overrideQuotaForOrigin', { origin: server.url, quotaSize: 100_000 });
  await page.click('#start');
  await until(page, () => /no room left/.test(document.getElementById('kept').textContent));
  const made = await page.evaluate(() => window.headpin.game.made);
  await page.evaluate((before) => new Promise((resolve) => {
    const look = () => (window.headpin.game.made > before + 500_000 ? resolve() : requestAnimationFrame(look));
    look();
  }), made);
  const result = await endAndSave(page, 'full.lcmlog');
  assert.equal(verified('full.lcmlog').verified_ticks, result.ticks);
  await context.close();
});

test('axe finds nothing wrong', async () => {
  const { page, asked, context } = await open();
  assert.deepEqual(await axeFinds(page), []);
  await page.click('#start');
  await pictures(page);
  assert.deepEqual(await axeFinds(page), []);
  await page.click('#end');
  await page.waitForSelector('#save-last');
  assert.deepEqual(await axeFinds(page), []);
  assert.deepEqual(asked(), []);
  await context.close();
});
