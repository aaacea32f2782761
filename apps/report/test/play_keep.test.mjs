// The page of `headpin play` in a real Chromium: where its games are kept, and what is left of them when something fails.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { axeFinds, until } from './page.mjs';
import { endAndSave, openGame, rooms, saveBy, startGame, verified } from './play.mjs';
import { headpin, urlOf } from './program.mjs';

let browser;
let server;

before(async () => ({ browser, server } = await rooms()));
after(async () => {
  await browser?.close();
  server?.close();
});

const contextOf = () => browser.newContext({ viewport: { width: 640, height: 480 }, acceptDownloads: true });

async function open(file = 'room.html') {
  const context = await contextOf();
  return { context, ...(await openGame(context, `${server.url}/${file}`)) };
}

const held = (page) => until(page, () => window.headpin.game.view[4] > 0);
const infoOf = (name) => JSON.parse(headpin('info', name, '--json'));

test('a page that is closed in a game leaves its log to the next one', async () => {
  const { page, context } = await open();
  await startGame(page);
  await page.keyboard.down(' ');
  await held(page);
  await until(page, () => window.headpin.store.stored > 100_000);
  const name = await page.evaluate(() => window.headpin.store.name);
  await page.close({ runBeforeUnload: false });
  const next = (await openGame(context, `${server.url}/room.html`)).page;
  await next.waitForSelector('#files button');
  assert.equal(await saveBy(next, '#files button >> nth=0', 'left.lcmlog'), name);
  assert.equal(infoOf('left.lcmlog').complete, false);
  assert.ok(verified('left.lcmlog').verified_ticks > 100);
  next.once('dialog', (dialog) => dialog.dismiss());
  await next.click('#files button >> nth=1');
  assert.ok((await next.textContent('#files-body')).includes(name));
  next.once('dialog', (dialog) => dialog.accept());
  await next.click('#files button >> nth=1');
  await until(next, () => document.querySelector('#files button') === null);
  await context.close();
});

test('a page that is killed at any of twenty moments leaves all but its last second', async () => {
  const { context, page: watcher } = await open();
  const lost = [];
  for (let i = 0; i < 20; ++i) {
    const { page } = await openGame(context, `${server.url}/room.html`);
    await startGame(page);
    await page.keyboard.down(' ');
    // 0.1 to 3.9 s into the game, in an order without pattern.
    const moment = 100_000 + 200_000 * ((7 * i + 3) % 20);
    await until(page, (least) => window.headpin.game.made > least && window.headpin.store.stored > 0, moment);
    const { made, name } = await page.evaluate(() => ({ made: window.headpin.game.made, name: window.headpin.store.name }));
    const client = await context.newCDPSession(page);
    client.send('Page.crash').catch(() => {});  // nobody is left to answer
    await page.waitForEvent('crash');
    await page.close();
    await watcher.reload();
    await watcher.waitForSelector('#files button');
    assert.equal(await saveBy(watcher, '#files button >> nth=0', 'killed.lcmlog'), name);
    const { verified_ticks: ticks, unverified_ticks: without } = verified('killed.lcmlog');
    lost.push((made * 240) / 1e6 - ticks);
    assert.ok(ticks > 0 && without <= 240, `${ticks} ticks, ${without} without a state`);
  }
  assert.ok(Math.max(...lost) <= 240, `ticks lost: ${lost.map(Math.round)}`);
  await context.close();
});

test('a full disk is told, and the game can still be saved', async () => {
  const { page, context } = await open();
  const client = await page.context().newCDPSession(page);
  await client.send('Storage.overrideQuotaForOrigin', { origin: server.url, quotaSize: 100_000 });
  await startGame(page);
  await until(page, () => /no room left/.test(document.getElementById('kept').textContent));
  const made = await page.evaluate(() => window.headpin.game.made);
  await until(page, (since) => window.headpin.game.made > since + 500_000, made);
  const result = await endAndSave(page, 'full.lcmlog');
  const name = await page.evaluate(() => window.headpin.last.name);
  const beginning = page.locator('#files li', { hasText: name });
  assert.match(await beginning.textContent(), /\(only its beginning; the whole game is above\)/);
  assert.equal(await saveBy(page, '#files button >> nth=0', 'beginning.lcmlog'), name.replace('.lcmlog', '-beginning.lcmlog'));
  assert.match(await page.textContent('#kept'), /no room left/);
  assert.equal(verified('full.lcmlog').verified_ticks, result.ticks);
  const { events } = infoOf('full.lcmlog');
  assert.match(events.find(({ kind }) => kind === 'not_stored').detail, /no room left/);
  // The saved game makes room for the next one in memory.
  await startGame(page);
  await until(page, () => /\(only its beginning\)/.test(document.getElementById('files-body').textContent));
  // A page that knows nothing of that game says the same; with the log, all that tells of it is deleted.
  const next = (await openGame(context, `${server.url}/room.html`)).page;
  const listed = next.locator('#files li', { hasText: name });
  assert.match(await listed.textContent(), /\(only its beginning\)/);
  next.once('dialog', (dialog) => dialog.accept());
  await listed.locator('button', { hasText: 'Delete' }).click();
  await until(next, (gone) => !document.getElementById('files-body').textContent.includes(gone), name);
  const left = await next.evaluate(async () => {
    const folder = await (await navigator.storage.getDirectory()).getDirectoryHandle('headpin');
    const names = [];
    for await (const one of folder.keys()) names.push(one);
    return names;
  });
  assert.deepEqual(left.filter((one) => one.startsWith(name)), []);
  await context.close();
});

test('a scenario can say that a game ends with the room on the disk', async () => {
  headpin('play', '--set', 'game.not_stored=ends', '-o', 'ends.html');
  const { page, context } = await open('ends.html');
  const client = await page.context().newCDPSession(page);
  await client.send('Storage.overrideQuotaForOrigin', { origin: server.url, quotaSize: 100_000 });
  await startGame(page);
  await page.waitForSelector('#save-last');
  assert.match(await page.textContent('#kept'), /no room left/);
  await saveBy(page, '#save-last', 'ends.lcmlog');
  assert.ok(verified('ends.lcmlog').complete);
  await context.close();
  // Nothing begins where nothing can be stored.
  const fromFile = await contextOf();
  const opened = await openGame(fromFile, urlOf('ends.html'));
  await opened.page.click('#start');
  await opened.page.waitForSelector('#trouble:not([hidden])');
  assert.match(await opened.page.textContent('#trouble'), /stores no games of a page that is opened from a file/);
  assert.equal(await opened.page.evaluate(() => window.headpin.game ?? null), null);
  await fromFile.close();
});

test('a page that is opened from a file says that it stores nothing, and can be played', async () => {
  const context = await contextOf();
  const { page } = await openGame(context, urlOf('room.html'));
  await startGame(page);
  await until(page, () => /stores no games of a page that is opened from a file/.test(document.getElementById('kept').textContent));
  await endAndSave(page, 'file.lcmlog');
  assert.ok(verified('file.lcmlog').complete);
  await context.close();
});

test('a page that is opened from a file keeps every game until it is saved', async () => {
  const context = await contextOf();
  const { page } = await openGame(context, urlOf('room.html'));
  const results = [];
  for (let game = 0; game < 2; ++game) {
    await startGame(page);
    await until(page, () => window.headpin.game.made > 300_000);
    await page.click('#end');
    await page.waitForSelector('#save-last');
    results.push(await page.evaluate(() => ({ name: window.headpin.last.name, ticks: window.headpin.last.ticks })));
  }
  assert.match(await page.textContent('#in-memory'), /Earlier games that are in memory alone/);
  assert.deepEqual(await axeFinds(page), []);
  await saveBy(page, '#save-last', 'second.lcmlog');
  assert.equal(await page.evaluate(() => window.headpin.isUnsaved()), true);
  assert.equal(await page.locator('#in-memory-body button').count(), 1);
  assert.equal(await saveBy(page, '#in-memory-body button', 'first.lcmlog'), results[0].name);
  assert.match(await page.textContent('#in-memory-body'), /Saved\.$/);
  assert.equal(await page.evaluate(() => window.headpin.isUnsaved()), false);
  assert.equal(verified('first.lcmlog').verified_ticks, results[0].ticks);
  assert.equal(verified('second.lcmlog').verified_ticks, results[1].ticks);
  // What is saved is in memory no longer than until the next game.
  await startGame(page);
  assert.equal(await page.evaluate(() => window.headpin.inMemory.length), 0);
  assert.equal(await page.isVisible('#in-memory'), false);
  await context.close();
});

test('an engine that stops is told, and the log up to there can be saved', async () => {
  const { page, context } = await open();
  await startGame(page);
  await until(page, () => window.headpin.game.made > 300_000);
  await page.evaluate(() => { window.headpin.game.engine.advance = () => ({ error: 'of this test' }); });
  assert.equal(await saveBy(page, '#save-last', 'stopped.lcmlog'), await page.evaluate(() => window.headpin.last.name));
  assert.match(await page.textContent('#trouble'), /of this test/);
  assert.ok(verified('stopped.lcmlog').verified_ticks > 60);
  await context.close();
});

test('an engine that fails at the end of a game is told, and the log up to there can be saved', async () => {
  const { page, context } = await open();
  await startGame(page);
  await until(page, () => window.headpin.game.made > 300_000);
  await page.evaluate(() => { window.headpin.game.engine.finish = () => ({ error: 'of this test' }); });
  await page.click('#end');
  assert.equal(await saveBy(page, '#save-last', 'unfinished.lcmlog'), await page.evaluate(() => window.headpin.last.name));
  assert.match(await page.textContent('#trouble'), /of this test/);
  assert.ok(verified('unfinished.lcmlog').verified_ticks > 60);
  await context.close();
});

test('a game that another page plays is not deleted, and what goes wrong with a list ends no game', async () => {
  const { page, context } = await open();
  await startGame(page);
  await until(page, () => window.headpin.store.stored > 100_000);
  await page.click('#end');
  await page.waitForSelector('#files button');
  const name = await page.evaluate(() => window.headpin.store.name);
  const other = (await openGame(context, `${server.url}/room.html`)).page;
  for (const one of [page, other]) one.on('dialog', (dialog) => dialog.accept());
  await startGame(page);
  // The other page listed the first game alone; it deletes it, and tries the one that goes on.
  await other.click('#files button:has-text("Delete")');
  await until(other, () => document.querySelector('#files button') === null);
  await other.evaluate((played) => window.headpin.remove(played), await page.evaluate(() => window.headpin.store.name));
  assert.match(await other.textContent('#files-trouble'), /was not deleted: it is being played\./);
  await page.bringToFront();
  await page.click('#files button:has-text("Delete")');
  await until(page, () => document.getElementById('files-trouble').textContent !== '');
  assert.equal(await page.textContent('#files-trouble'), `${name} was not deleted: it was not there any more.`);
  assert.equal(await page.isVisible('#trouble'), false);
  const stored = await page.evaluate(() => window.headpin.store.stored);
  await until(page, (before) => window.headpin.store.stored > before + 100_000, stored);
  await endAndSave(page, 'goes-on.lcmlog');
  assert.ok(verified('goes-on.lcmlog').complete);
  await context.close();
});

test('a game whose name another one has gets another name', async () => {
  const { page, context } = await open();
  await page.evaluate(async () => {
    const { toISOString } = Date.prototype;
    const root = await navigator.storage.getDirectory();
    const folder = await root.getDirectoryHandle('headpin', { create: true });
    const older = await (await folder.getFileHandle('2026-01-31T12-34-56-789.lcmlog', { create: true })).createWritable();
    await older.write('older');
    await older.close();
    Date.prototype.toISOString = function once() {
      Date.prototype.toISOString = toISOString;
      return '2026-01-31T12:34:56.789Z';
    };
  });
  await startGame(page);
  assert.notEqual(await page.evaluate(() => window.headpin.store.name), '2026-01-31T12-34-56-789.lcmlog');
  await endAndSave(page, 'newer.lcmlog');
  assert.ok(verified('newer.lcmlog').complete);
  const older = page.locator('#files li', { hasText: '2026-01-31T12-34-56-789.lcmlog, 0.0 MB' });
  assert.equal(await older.count(), 1);
  await context.close();
});

test('of two lists of files that are made meanwhile the newest is shown', async () => {
  const { page, context } = await open();
  await page.evaluate(async () => {
    const folder = await (await navigator.storage.getDirectory()).getDirectoryHandle('headpin', { create: true });
    await folder.getFileHandle('kept.lcmlog', { create: true });
    let fail;
    navigator.locks.query = () => new Promise((resolve, reject) => { fail = reject; });
    const slow = window.headpin.listFiles();
    delete navigator.locks.query;
    await window.headpin.listFiles();
    fail(new Error('too late'));  // the list would be empty
    await slow;
  });
  assert.match(await page.textContent('#files-body'), /^kept\.lcmlog/);
  await context.close();
});
