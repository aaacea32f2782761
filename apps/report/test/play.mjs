// What the tests of the page of `headpin play` share.
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';

import { kWait, listened } from './page.mjs';
import { folder, headpin } from './program.mjs';

/** Serves the folder of the tests: the browser's own file system needs an origin. */
export async function serve() {
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

/** Opens a page of a game; what it says is kept. */
export async function openGame(context, url) {
  const page = await context.newPage();
  page.setDefaultTimeout(kWait);
  const heard = listened(page);
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  return { page, ...heard };
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

/** Waits for a picture that shows the game's view. */
export const pictures = (page, number = 3) => page.evaluate(async (wanted) => {
  for (let i = 0; i < wanted; ++i) await new Promise((resolve) => requestAnimationFrame(resolve));
}, number);

/** Ends the game and keeps its log in the tests' folder. */
export async function endAndSave(page, name) {
  await page.click('#end');
  await page.waitForSelector('#save-last');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-last')]);
  await download.saveAs(join(folder, name));
  return page.evaluate(() => {
    const { game_hash: game, state_hash: state, ticks, skittles_down: down } = window.headpin.last;
    return { game, state, ticks, down };
  });
}

/** What the program finds in a log; it must be the same to the bit. */
export function verified(name) {
  return JSON.parse(headpin('replay', name, '--verify', '--json'));
}
