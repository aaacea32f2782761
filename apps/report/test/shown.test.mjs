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
