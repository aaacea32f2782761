// What the tests of the page of `headpin play` share.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';

import { launch } from './chromium.mjs';
import { kWait, listened, until } from './page.mjs';
import { folder, headpin } from './program.mjs';

/** Serves the folder of the tests: the browser's own file system needs an origin. */
async function serve() {
  const server = createServer((request, response) => {
    try {
      const bytes = readFileSync(join(folder, request.url.slice(1)));
      response.setHeader('content-type', 'text/html');
      response.end(bytes);
    } catch {
      response.statusCode = 404;
      response.end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

/** A browser, and a server with the pages of two rooms. */
export async function rooms() {
  headpin('play', '-o', 'room.html');
  headpin('play', 'paper-experiment', '-o', 'experiment.html');
  return { browser: await launch(), server: await serve() };
}

/** Opens a page of a game; what it says is kept. */
export async function openGame(context, url) {
  const page = await context.newPage();
  page.setDefaultTimeout(kWait);
  const heard = listened(page);
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  return { page, ...heard };
}

/** Begins a game, and waits until it is drawn. */
export async function startGame(page, press = () => page.click('#start')) {
  await press();
  await until(page, () => window.headpin.game?.frames > 2 && document.activeElement.id === 'view');
}

/** Where a point of the world is on the page [CSS pixels]. */
export async function onPage(page, point) {
  const box = await page.locator('#view').boundingBox();
  const [x, y] = await page.evaluate((p) => {
    const { room } = window.headpin;
    const at = room.rig.position.clone().set(...p).project(room.camera);
    return [at.x, at.y];
  }, point);
  return [box.x + ((x + 1) / 2) * box.width, box.y + ((1 - y) / 2) * box.height, box.height];
}

/** Waits for pictures of the game. */
export const pictures = (page, number = 3) => page.evaluate(async (wanted) => {
  for (let i = 0; i < wanted; ++i) await new Promise((resolve) => requestAnimationFrame(resolve));
}, number);

const kTypes = {
  mouse: { move: 'mouseMoved', down: 'mousePressed', up: 'mouseReleased' },
  touch: { move: 'touchMove', down: 'touchStart', up: 'touchEnd' },
};

/**
 * Input through the browser itself, each event with a time stamp of its own [s].
 * @return  (kind, x, y, timestamp): kind is move, down or up
 */
export async function inputOf(page, device) {
  const client = await page.context().newCDPSession(page);
  return (kind, x, y, timestamp = Date.now() / 1000) => {
    const type = kTypes[device][kind];
    if (device === 'touch') {
      return client.send('Input.dispatchTouchEvent', { type, timestamp, touchPoints: kind === 'up' ? [] : [{ x, y }] });
    }
    return client.send('Input.dispatchMouseEvent',
      { type, x, y, timestamp, button: kind === 'move' ? 'none' : 'left', buttons: kind === 'up' ? 0 : 1, clickCount: 1 });
  };
}

const kSwing = 0.2;   // s, up
const kUp = 0.35;     // picture heights
const kBefore = 0.1;  // s from now to the first event: all are there in time on a busy machine

/** Moves up faster and faster, and lets go. The browser has the 60 events a second at once, as after a long frame. */
export async function flick(send, [x, y, height], { back = 0, up: most = kUp } = {}) {
  const begin = Date.now() / 1000 + kBefore;
  const sent = [];
  const move = (up, time) => sent.push(send('move', x, y - up * height, begin + time));
  const down = back ? 12 : 0;
  for (let i = 1; i <= down; ++i) move((-back * i) / down, (i * kSwing) / 12);
  const from = (down * kSwing) / 12;
  for (let i = 1; i <= 12; ++i) move(-back + (most + back) * (i / 12) ** 2, from + (i * kSwing) / 12);
  sent.push(send('up', x, y - most * height, begin + from + kSwing));
  await Promise.all(sent);
}

/** Presses a button that saves a log, and keeps it in the tests' folder. */
export async function saveBy(page, button, name) {
  await page.waitForSelector(button);
  const [download] = await Promise.all([page.waitForEvent('download'), page.click(button)]);
  await download.saveAs(join(folder, name));
  return download.suggestedFilename();
}

/** Ends the game and keeps its log in the tests' folder. */
export async function endAndSave(page, name) {
  await page.click('#end');
  return saved(page, name);
}

/** Keeps the log of a game that has ended. */
export async function saved(page, name) {
  await saveBy(page, '#save-last', name);
  return page.evaluate(() => {
    const { game_hash: game, state_hash: state, ticks, skittles_down: down } = window.headpin.last;
    return { game, state, ticks, down };
  });
}

/** What the program finds in a log; it must be the same to the bit. */
export function verified(name) {
  return JSON.parse(headpin('replay', name, '--verify', '--json'));
}
