// `headpin serve` with a real Chromium: a guest plays, an operator watches, the line is cut.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { launch } from './chromium.mjs';
import { axeFinds, until } from './page.mjs';
import { endAndSave, flick, inputOf, onPage, openGame, pictures, startGame, verified } from './play.mjs';
import { folder, headpin } from './program.mjs';
import { lineTo, serving } from './serve.mjs';

const kHome = [0.35, -0.25, 0.85];  // m: the ball on its stand

let browser;

before(async () => { browser = await launch(); });
after(async () => { await browser?.close(); });

const contextOf = (options) => browser.newContext({ viewport: { width: 640, height: 480 }, acceptDownloads: true, ...options });

async function throwIt(page) {
  const send = await inputOf(page, 'mouse');
  const at = await onPage(page, kHome);
  await send('move', at[0], at[1]);
  await pictures(page);
  await send('down', at[0], at[1]);
  await until(page, () => window.headpin.game.view[4] > 0);
  await pictures(page, 10);
  await flick(send, at);
}

const sentMore = (page) => page.evaluate(() => window.headpin.sender.sent)
  .then((before) => until(page, (least) => window.headpin.sender.sent > least, before));

async function cutFor(page, line) {
  await sentMore(page);
  line.cut();
  await until(page, () => window.headpin.sender.trouble !== '' && window.headpin.sender.made > window.headpin.sender.sent + 20_000);
  line.mend();
  await sentMore(page);
}

test('a game over a line that is cut three times is here as it is there; the operator sees it', async () => {
  const server = await serving('paper-room', '-o', 'games');
  const line = await lineTo(Number(new URL(server.operator).port));
  const context = await contextOf();
  const operator = await context.newPage();
  await operator.goto(server.operator);
  await operator.waitForSelector('html[data-ready]');
  assert.match(await operator.textContent('#guests'), /invited/);

  const link = server.links[0].replace(/:\d+/, `:${line.port}`);
  const { page, said } = await openGame(context, link);
  await page.fill('#participant', 'Ada');
  await startGame(page);
  await cutFor(page, line);
  await throwIt(page);
  await cutFor(page, line);
  await until(page, () => window.headpin.game.score.skittles_down > 0);
  await until(operator, () => /[1-9] down/.test(document.getElementById('now').textContent));
  const { head, hand } = await operator.evaluate(async () => (await (await fetch(`/state${location.search}`)).json()).guests[0].game);
  const view = await page.evaluate(() => [...window.headpin.game.view]);
  const apart = (pose, at) => Math.hypot(...[4, 5, 6].map((i) => pose[i] - view[at + i]));
  assert.ok(apart(head, 19) < 0.1 && apart(hand, 12) < 0.1, `${head}; ${hand}; ${view.slice(12, 26)}`);
  // A busy machine makes gaps in the poses of a browser.
  assert.match(await operator.textContent('#guests'), /Ada.*playing.*(no gaps|[0-9]+ gaps?).*guest-01\.lcmlog/s);
  await operator.screenshot({ path: join(folder, 'operator.png'), fullPage: true });
  if (process.env.KEEP) await operator.screenshot({ path: join(process.env.KEEP, 'operator.png'), fullPage: true });
  await cutFor(page, line);

  const result = await endAndSave(page, 'there.lcmlog');
  await until(page, () => /^All is sent/.test(document.getElementById('sent').textContent));
  assert.ok(readFileSync(join(folder, 'games/guest-01.lcmlog')).equals(readFileSync(join(folder, 'there.lcmlog'))));
  const replayed = verified('games/guest-01.lcmlog');
  assert.equal(replayed.game_hash, result.game);
  assert.equal(replayed.skittles_down, result.down);
  await until(operator, () => /ended/.test(document.getElementById('guests').textContent));
  // The browser itself says that requests failed while the line was cut.
  assert.deepEqual(said.filter((text) => !/Failed to load resource|ERR_/.test(text)), []);

  const again = await page.context().newPage();
  assert.equal((await again.goto(server.links[0])).status(), 403);
  await operator.click('#new-link');
  await operator.waitForSelector('#link a');
  assert.equal((await again.goto(await operator.getAttribute('#link a', 'href'))).status(), 200);
  assert.deepEqual(await axeFinds(operator), []);
  line.close();
  await context.close();
  assert.equal(await server.stop(), 0);
});

test('two pages of one link: the second is told', async () => {
  const server = await serving('paper-room', '-o', 'twice');
  const context = await contextOf();
  const { page: first } = await openGame(context, server.links[0]);
  const { page: second } = await openGame(context, server.links[0]);
  await startGame(first);
  await second.click('#start');
  await second.waitForSelector('#trouble:not([hidden])');
  assert.match(await second.textContent('#trouble'), /this link was used already/);
  await context.close();
  await server.stop();
});

test('a participant of a study plays, and answers', async () => {
  headpin('experiment', 'plan', '-o', 'study');
  const server = await serving('study', '--links', '2');
  assert.equal(server.links.length, 2);
  const context = await contextOf();
  const { page, said } = await openGame(context, server.links[0]);
  assert.match(await page.textContent('#hint'), /Touch the (red|blue) button first/);
  assert.equal(await page.isVisible('#participant'), false);
  await startGame(page);
  for (const key of ['r', 'b']) {
    const games = await page.evaluate(() => window.headpin.game.score.sheets.length);
    await page.keyboard.press(key);
    await until(page, (before) => window.headpin.game.score.sheets.length > before, games);
  }
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  assert.deepEqual(await axeFinds(page), []);
  if (process.env.KEEP) await page.screenshot({ path: join(process.env.KEEP, 'questions.png'), fullPage: true });
  for (const item of await page.locator('#questions-form fieldset').all()) await item.locator('input').nth(2).check();
  await page.click('#send-answers');
  await page.waitForSelector('text=The answers are stored');
  const status = headpin('experiment', 'status', 'study');
  const answers = readFileSync(join(folder, 'study/answers/p001.csv'), 'utf8');
  assert.match(answers, /p001,presence1,3,asked/);
  const { participant, condition } = JSON.parse(headpin('info', 'study/sessions/p001/run-01.lcmlog', '--json'));
  assert.equal(participant, 'p001');
  assert.match(condition, /cell \d{3} of EFS/);
  assert.match(status, /p001/);
  verified('study/sessions/p001/run-01.lcmlog');
  assert.deepEqual(said, []);
  await context.close();
  await server.stop();
});

test('a page that is loaded again asks its questions again, with the answers so far; no other page does', async () => {
  headpin('experiment', 'plan', '-o', 'reloaded');
  const server = await serving('reloaded');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  const dialogs = [];
  page.on('dialog', (dialog) => { dialogs.push(dialog.type()); dialog.accept(); });
  await startGame(page);
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  const questions = await page.locator('#questions-form fieldset').all();
  await questions[0].locator('input').nth(2).check();
  await page.reload();
  await page.waitForSelector('#questions-form');
  assert.deepEqual(dialogs, ['beforeunload']);
  assert.equal(await page.locator('#questions-form input:checked').count(), 1);
  assert.equal(await page.isDisabled('#start'), true);
  const { page: other } = await openGame(context, server.links[0]);
  assert.match(await other.textContent('#hint'), /^This link was used already/);
  assert.equal(await other.isVisible('#questions'), false);
  const slow = await context.newPage();
  await slow.addInitScript(() => { navigator.locks.query = () => new Promise(() => {}); });  // its files are never listed
  await slow.goto(server.links[0]);
  await slow.waitForSelector('#start:disabled');
  assert.match(await slow.textContent('#hint'), /^This link was used already/);
  for (const item of questions.slice(1)) await item.locator('input').nth(1).check();
  await page.click('#send-answers');
  await page.waitForSelector('text=The answers are stored');
  assert.match(readFileSync(join(folder, 'reloaded/answers/p001.csv'), 'utf8'), /p001,presence1,3,asked/);
  assert.equal((await page.reload()).status(), 403);
  assert.equal(dialogs.length, 1);
  await context.close();
  await server.stop();
});

test('of two tabs that ask the questions of one guest, only the first has its answers stored', async () => {
  headpin('experiment', 'plan', '-o', 'copied');
  const server = await serving('copied');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await startGame(page);
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  const { page: copy } = await openGame(context, server.links[0]);
  const kept = await page.evaluate(() => JSON.stringify(sessionStorage));
  await copy.evaluate((all) => Object.assign(sessionStorage, JSON.parse(all)), kept);  // as a browser copies a tab
  await copy.reload();
  await copy.waitForSelector('#questions-form');
  for (const [tab, choice] of [[page, 2], [copy, 1]]) {
    for (const item of await tab.locator('#questions-form fieldset').all()) await item.locator('input').nth(choice).check();
  }
  await page.click('#send-answers');
  await page.waitForSelector('text=The answers are stored');
  await copy.click('#send-answers');
  await copy.waitForSelector('text=The answers that were sent first are stored; these are not.');
  assert.equal(await copy.locator('#questions-form').count(), 0);
  assert.match(readFileSync(join(folder, 'copied/answers/p001.csv'), 'utf8'), /p001,presence1,3,asked/);
  await context.close();
  await server.stop();
});

/** The first request for something arrives, and its answer is lost. */
async function loseAnswer(page, doing) {
  let lost = false;
  await page.route(`**/${doing}?*`, async (route) => {
    if (lost) return route.continue();
    lost = true;
    await route.fetch();
    return route.abort('connectionreset');
  });
}

test('the questions are asked, though the answer to the end was lost', async () => {
  headpin('experiment', 'plan', '-o', 'lost');
  const server = await serving('lost');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await loseAnswer(page, 'end');
  await startGame(page);
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  assert.match(await page.textContent('#sent'), /^All is sent/);
  await context.close();
  await server.stop();
});

test('where the game cannot be sent for good, it is said that the questions are not asked', async () => {
  headpin('experiment', 'plan', '-o', 'refused');
  const server = await serving('refused');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await page.route('**/log?*', (route) => route.fulfill({ status: 413, body: 'the log is too long' }));
  await startGame(page);
  await until(page, () => window.headpin.sender.failed);
  await page.click('#end');
  await page.waitForSelector('text=The questions are not asked here');
  assert.match(await page.textContent('#sent'), /Nothing more can be sent: the log is too long\./);
  await context.close();
  await server.stop();
});

test('a link can be used, though the answer to the beginning was lost; a try leaves no log in the browser', async () => {
  const server = await serving('paper-room', '-o', 'tried');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await loseAnswer(page, 'begin');
  await page.click('#start');
  await page.waitForSelector('#trouble:not([hidden])');
  assert.match(await page.textContent('#trouble'), /the connection is interrupted\. Press Play again\.$/);
  await startGame(page);
  await sentMore(page);
  await endAndSave(page, 'tried.lcmlog');
  await until(page, () => /^All is sent/.test(document.getElementById('sent').textContent));
  assert.equal(await page.locator('#files li').count(), 1);
  assert.ok(readFileSync(join(folder, 'tried/guest-01.lcmlog')).equals(readFileSync(join(folder, 'tried.lcmlog'))));
  await context.close();
  await server.stop();
});

test('the operator can click on Watch while somebody plays, and sees a left hand as one', async () => {
  const server = await serving('paper-room', '-o', 'two', '--links', '2');
  const context = await contextOf();
  const operator = await context.newPage();
  await operator.goto(server.operator);
  await operator.waitForSelector('html[data-ready]');
  const tokens = server.links.map((link) => link.split('/').pop());
  const { page: first } = await openGame(context, server.links[0]);
  await startGame(first);
  const { page: second } = await openGame(context, server.links[1]);
  await second.check('#hands [value=left]');
  await startGame(second);
  await sentMore(second);

  const watch = `#watch-${tokens[1]}`;
  await operator.waitForSelector(watch);
  const tick = () => operator.evaluate((id) => Number(document.querySelector(id).closest('tr').cells[2].textContent), watch);
  await operator.hover(watch);
  await operator.mouse.down();
  const before = await tick();
  await until(operator, ({ id, than }) => Number(document.querySelector(id).closest('tr').cells[2].textContent) > than,
    { id: watch, than: before });
  await operator.mouse.up();
  assert.equal(await operator.evaluate(() => window.headpin.watched), tokens[1]);

  const isMirrored = () => window.headpin.room.hand.objects.every(({ matrixWorld }) => matrixWorld.determinant() < 0);
  await until(operator, isMirrored);
  await operator.click(`#watch-${tokens[0]}`);
  await until(operator, () => window.headpin.room.hand.objects.every(({ matrixWorld }) => matrixWorld.determinant() > 0));
  await context.close();
  await server.stop();
});

test('the operator is told for whom a new link is, and why there is none', async () => {
  headpin('experiment', 'plan', '-o', 'few', '--people', '2');
  const server = await serving('few');
  const context = await contextOf();
  const operator = await context.newPage();
  await operator.goto(server.operator);
  await operator.waitForSelector('html[data-ready]');
  await operator.click('#new-link');
  await operator.waitForSelector('#link a');
  assert.match(await operator.textContent('#link'), /^The new link, for p002: http/);
  await operator.click('#new-link');
  await until(operator, () => /^No link/.test(document.getElementById('link').textContent));
  assert.equal(await operator.textContent('#link'), 'No link was made: everybody of the plan has played or has a link');
  assert.equal(await operator.isVisible('#trouble'), false);
  await until(operator, () => document.querySelectorAll('#guests tbody tr').length === 2);  // it is told once a second
  await context.close();
  await server.stop();
});

test('a participant whose page was closed in a game begins again by another link', async () => {
  headpin('experiment', 'plan', '-o', 'closed', '--people', '1');
  const server = await serving('closed');
  const context = await contextOf();
  const operator = await context.newPage();
  await operator.goto(server.operator);
  await operator.waitForSelector('html[data-ready]');
  const { page: first } = await openGame(context, server.links[0]);
  await startGame(first);
  await sentMore(first);
  await first.close();
  await operator.click(`#again-${server.links[0].split('/').pop()}`);
  await operator.waitForSelector('#link a');
  assert.match(await operator.textContent('#link'), /^The new link, for p001: http/);
  const { page: second } = await openGame(context, await operator.getAttribute('#link a', 'href'));
  await startGame(second);
  await sentMore(second);
  await until(operator, () => document.querySelector('#guests tbody tr').cells[1].textContent === 'cut off');
  await context.close();
  await server.stop();
});

test('by HTTPS to other machines: the page has what a headset needs', async () => {
  const server = await serving('paper-room', '-o', 'https', '--bind', '0.0.0.0');
  assert.match(server.links[0], /^https:/);
  assert.match(server.certificate_sha256, /^([0-9A-F]{2}:){31}[0-9A-F]{2}$/);
  const context = await contextOf({ ignoreHTTPSErrors: true });
  const { page } = await openGame(context, server.links[0].replace(/\/\/[^:/]+/, '//127.0.0.1'));
  assert.ok(await page.evaluate(() => isSecureContext && 'xr' in navigator));
  await startGame(page);
  await until(page, () => window.headpin.sender.sent > 0 && window.headpin.store.stored > 0);
  await context.close();
  await server.stop();
});

test('answers that are changed after the reply to the first ones was lost are not said to be stored', async () => {
  headpin('experiment', 'plan', '-o', 'changed');
  const server = await serving('changed');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await startGame(page);
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  const questions = await page.locator('#questions-form fieldset').all();
  for (const item of questions) await item.locator('input').nth(2).check();
  await loseAnswer(page, 'answers');
  await page.click('#send-answers');
  await page.waitForSelector('text=Please try again.');
  await questions[0].locator('input').nth(1).check();
  await page.click('#send-answers');
  await page.waitForSelector('text=The answers that were sent first are stored; these are not.');
  assert.match(readFileSync(join(folder, 'changed/answers/p001.csv'), 'utf8'), /p001,presence1,3,asked/);
  await context.close();
  await server.stop();
});

test('the answers cannot be sent again while they are sent', async () => {
  headpin('experiment', 'plan', '-o', 'sent-once');
  const server = await serving('sent-once');
  const context = await contextOf();
  const { page } = await openGame(context, server.links[0]);
  await startGame(page);
  await page.click('#end');
  await page.waitForSelector('#questions-form');
  for (const item of await page.locator('#questions-form fieldset').all()) await item.locator('input').nth(2).check();
  const asked = new Promise((resolve) => { page.route('**/answers?*', resolve); });  // it waits for its reply
  await page.click('#send-answers');
  const request = await asked;
  assert.equal(await page.isDisabled('#send-answers'), true);
  await request.abort('connectionreset');
  await page.waitForSelector('#send-answers:enabled');
  await context.close();
  await server.stop();
});
