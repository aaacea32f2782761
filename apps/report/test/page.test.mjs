import assert from 'node:assert/strict';
import { copyFileSync, readFileSync, rmSync, statSync, truncateSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { launch, open } from './chromium.mjs';
import { axeFinds, differenceOver, drawnAt, pixelsOf, until } from './page.mjs';
import { demo, folder, headpin, refused, root, urlOf } from './program.mjs';

let browser;

before(async () => {
  headpin('replay', demo, '-o', 'game.lcmlog');
  headpin('report', 'game.lcmlog', '-o', 'game.html');
  headpin('frames', 'game.lcmlog', '--frames', '0-119', '--video', 'stereo.mkv');
  browser = await launch();
});
after(() => browser.close());

test('the page opens by itself: nothing is fetched, nothing goes wrong', async () => {
  const { page, said, asked } = await open(browser, 'game.html');
  await page.keyboard.press('Space');
  await until(page, () => window.headpin.clock.tick > 5);
  await page.keyboard.press('Space');
  for (const key of ['2', '3', '4', '1', 't', 'v', 'c', ']', ']', '[', '+', '-', 'w', 'd', 'r', 'End', 'Home']) {
    await page.keyboard.press(key);
  }
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.context().close();
});

test('it is no larger than a mail takes', () => {
  assert.ok(statSync(join(folder, 'game.html')).size < 2e6);
});

test('ball and skittle are where the trial has them, as the eyes see them, at three times', async () => {
  const frames = [280, 300, 312];
  headpin('frames', 'game.lcmlog', '-o', 'frames', '--frames', frames.join(','), '--ids');
  const { page } = await open(browser, 'game.html');
  await page.keyboard.press('c');  // arrows are not what the eyes see
  for (const [mode, eye] of [['left', 'left'], ['right', 'right']]) {
    await page.evaluate((to) => window.headpin.setMode(to), mode);
    for (const frame of frames) {
      const name = join(folder, 'frames', `${eye}_${String(frame).padStart(6, '0')}`);
      for (const [body, id] of [['ball', 10], ['skittle 10', 109]]) {
        const pixels = pixelsOf(name, id);
        assert.ok(pixels.mask.length >= 8, `${body} in frame ${frame}: ${pixels.mask.length} pixels`);
        await drawnAt(page, 4 * frame);
        const there = await differenceOver(page, pixels);
        // Its mirror image and its shade aside, which are not of its own pixels, it looks the same.
        assert.ok(there < 26, `${body} in the ${eye} eye's frame ${frame}: ${there} levels off`);
        if (body === 'ball') {  // and would be seen to be elsewhere a tenth of a second later
          await drawnAt(page, 4 * frame + 24);
          const later = await differenceOver(page, pixels);
          assert.ok(later > 1.5 * there, `${later} a tenth of a second later, ${there} at its time`);
        }
      }
    }
  }
  await page.context().close();
});

test('the score board has the text of the tick, as the eyes see it', async () => {
  headpin('replay', demo, ...['rules=ten-pin', 'ball_back_s=2.5', 'show_score=true'].flatMap((key) => ['--set', `game.${key}`]),
    '-o', 'board.lcmlog');
  headpin('report', 'board.lcmlog', '-o', 'board.html');
  const { events } = JSON.parse(headpin('info', 'board.lcmlog', '--json'));
  const counted = Math.ceil(events.find(({ kind }) => kind === 'delivery').tick / 4);
  const frames = [counted - 5, counted + 5];
  headpin('frames', 'board.lcmlog', '-o', 'board', '--frames', frames.join(','), '--ids');
  const { page } = await open(browser, 'board.html');
  await page.evaluate(() => window.headpin.setMode('left'));
  for (const [frame, other] of [frames, frames.toReversed()]) {
    const pixels = pixelsOf(join(folder, 'board', `left_${String(frame).padStart(6, '0')}`), 6);
    assert.ok(pixels.mask.length > 300, `${pixels.mask.length} pixels`);
    await drawnAt(page, 4 * frame);
    const there = await differenceOver(page, pixels);
    await drawnAt(page, 4 * other);
    const then = await differenceOver(page, pixels);
    assert.ok(there < 26 && then > 1.2 * there, `${there} levels off in frame ${frame}, ${then} with the text of ${other}`);
  }
  await page.context().close();
});

test('rings of oil come one by one, and stay on their ball', async () => {
  headpin('replay', demo, '--elasticity', '0', '--set', 'ball.rings=true', '--set', 'hand.spin=[60, 0, 0]', '-o', 'rings.lcmlog');
  headpin('report', 'rings.lcmlog', '-o', 'rings.html');
  const { page } = await open(browser, 'rings.html');
  const ringsAt = async (tick) => {
    await drawnAt(page, tick);
    return page.evaluate(() => {
      const { cast, trial, tick: now } = window.headpin.view;
      const [ball] = trial.actors('ball');
      const { group } = cast.rings;
      const p = trial.pose(ball, now, new Float32Array(7)).slice(4);
      const seen = group.children.filter(({ visible }) => visible);
      return {
        count: seen.length,
        widest: Math.max(0, ...seen.map(({ scale }) => scale.x)),
        off: Math.hypot(group.position.x - p[0], group.position.y - p[1], group.position.z - p[2]),
      };
    });
  };
  const release = JSON.parse(headpin('info', 'rings.lcmlog', '--json')).events.find(({ kind }) => kind === 'release').tick;
  assert.equal((await ringsAt(release)).count, 0);
  const [early, late] = [await ringsAt(release + 150), await ringsAt(1682)];
  assert.ok(early.count > 0 && late.count > early.count, `${early.count}, then ${late.count}`);
  assert.ok(late.off < 1e-6 && late.widest > 0.1 && late.widest < 0.109, JSON.stringify(late));
  assert.equal((await ringsAt(release + 150)).count, early.count);
  await page.context().close();
});

test('every tick is reached by keys', async () => {
  const { page } = await open(browser, 'game.html');
  const tick = () => page.evaluate(() => window.headpin.clock.tick);
  await page.focus('#scrub');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  assert.equal(await tick(), 3);
  await page.keyboard.press('ArrowLeft');
  assert.equal(await tick(), 2);
  await page.keyboard.press('End');
  assert.equal(await tick(), 1682);
  await page.keyboard.press('Home');
  await page.keyboard.press(']');
  const grab = JSON.parse(headpin('info', 'game.lcmlog', '--json')).events.find((e) => e.kind === 'grab');
  assert.equal(await tick(), grab.tick);
  assert.match(await page.textContent('#nearest'), /grab ball/);
  assert.match(await page.textContent('#time'), new RegExp(`tick ${grab.tick}$`));
  await page.click('#marks .mark:nth-child(2)');
  assert.match(await page.textContent('#nearest'), /release ball/);
  await page.context().close();
});

test('a picture that rests becomes fine, however late it was drawn', async () => {
  const { page } = await open(browser, 'game.html');
  await page.evaluate(() => {
    window.headpin.clock.go(700);
    for (const from = performance.now(); performance.now() < from + 500;);  // longer than it settles
  });
  await until(page, () => document.getElementById('view').width >= document.getElementById('view').clientWidth);
  await page.context().close();
});

test('the hash shown is that of headpin replay', async () => {
  const { page } = await open(browser, 'game.html');
  const { state_hash: hash } = JSON.parse(headpin('replay', 'game.lcmlog', '--json'));
  assert.equal(await page.textContent('#hash'), hash);
  assert.match(await page.textContent('#verdict'), /equal to the bit in 1682 recorded ticks/);
  await page.context().close();
});

test('every plot is a table too', async () => {
  const { page } = await open(browser, 'game.html');
  const charts = await page.locator('.chart').count();
  assert.ok(charts >= 6);
  for (let i = 0; i < charts; ++i) {
    const chart = page.locator('.chart').nth(i);
    await chart.locator('summary').click();
    await chart.locator('tbody tr').nth(100).waitFor();
  }
  await page.context().close();
});

test('hostile names are shown as text', async () => {
  const name = `</script><script>window.hurt = 1</script><img src=x onerror="window.hurt = 1">'"&amp;${'x'.repeat(10_000)}`;
  headpin('synthesize', '-o', 'hostile.lcmlog', '--name', name, '--condition', '"><b>', '--duration', '7');
  headpin('report', 'hostile.lcmlog', '-o', 'hostile.html');
  const { page, said, asked } = await open(browser, 'hostile.html', { width: 390 });
  assert.equal(await page.evaluate(() => window.hurt), undefined);
  assert.ok((await page.textContent('#provenance-body')).includes(name));
  assert.equal(await page.locator('main img, main b').count(), 0);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.context().close();
});

test('a trial that is cut off says so; an empty one is refused', async () => {
  writeFileSync(join(folder, 'cut.lcmlog'), readFileSync(join(folder, 'game.lcmlog')));
  truncateSync(join(folder, 'cut.lcmlog'), Math.floor(0.7 * statSync(join(folder, 'game.lcmlog')).size));
  headpin('report', 'cut.lcmlog', '-o', 'cut.html');
  const { page, said } = await open(browser, 'cut.html');
  for (const id of ['devices-body', 'subtitle', 'verdict']) assert.match(await page.textContent(`#${id}`), /not complete/);
  assert.deepEqual(said, []);
  await page.context().close();
  writeFileSync(join(folder, 'empty.lcmlog'), '');
  const { status, stderr } = refused('report', 'empty.lcmlog', '-o', 'empty.html');
  assert.equal(status, 1);
  assert.match(stderr, /empty\.lcmlog/);
});

for (const options of [{ width: 1400 }, { width: 390, height: 844 }, { colorScheme: 'dark' }, { reducedMotion: 'reduce' }]) {
  test(`axe-core finds no fault: ${JSON.stringify(options)}`, async () => {
    const { page } = await open(browser, 'game.html', options);
    for (const id of ['plots', 'provenance']) await page.locator(`#${id} summary`).first().click();
    assert.deepEqual(await axeFinds(page), []);
    await page.context().close();
  });
}

test('other releases of a throw: pictures, the window of success, each moment as a table', async () => {
  headpin('report', 'game.lcmlog', '-o', 'whatif.html', '--whatif', '1');
  const lines = headpin('whatif', 'game.lcmlog', '--speed', '1', '--direction', '0', '--height', '0', '--spin', '0');
  const { page, said } = await open(browser, 'whatif.html');
  const [, words] = /window of success +(.*)/.exec(lines);
  assert.ok((await page.textContent('#whatif-body')).includes(words), words);
  await until(page, () => [...document.querySelectorAll('#whatif img')].every((image) => image.naturalWidth > 400));
  assert.equal(await page.locator('#whatif img').count(), 2);
  await page.locator('#whatif summary').click();
  assert.equal(await page.locator('#whatif tbody tr').count(), 301);
  assert.deepEqual(await axeFinds(page, '#whatif'), []);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('two trials: the first different tick and body, and both in the room', async () => {
  headpin('replay', 'game.lcmlog', '--friction', '0.3', '-o', 'smooth.lcmlog');
  const { first_difference_tick: tick, first_difference_body: body } =
    JSON.parse(headpin('compare', 'game.lcmlog', 'smooth.lcmlog', '--json'));
  headpin('report', 'game.lcmlog', 'smooth.lcmlog', '-o', 'two.html');
  const { page, said } = await open(browser, 'two.html');
  const words = await page.textContent('#first-difference');
  assert.ok(words.includes(`First different tick: ${tick} `) && words.includes(`in the ${body}`), words);
  await page.click('#first-difference button');
  assert.equal(await page.evaluate(() => window.headpin.clock.tick), tick);
  assert.ok(await page.evaluate(() => window.headpin.view.otherCast.group.children.length) >= 11);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('two trials are compared in plots, events, scores, and shown one by one by a key', async () => {
  const [a, b] = ['game', 'smooth'].map((name) => JSON.parse(headpin('info', `${name}.lcmlog`, '--json')));
  const { page, said } = await open(browser, 'two.html');
  const down = (one) => `${one.result.skittles_down} of 10 skittles down`;
  const head = await page.textContent('#subtitle');
  assert.ok(head.includes(down(a)) && head.includes(`B: ${down(b)}`), head);

  // Plots: a colour for each trial, a dash for each curve.
  const lines = await page.evaluate(() => window.headpin.plots.plots[0].plot.series.slice(1).map((one) =>
    [one.label, one.stroke(), String(one.dash ?? ''), one.spanGaps]));
  assert.deepEqual(lines.map(([label]) => label), ['ball, A', 'fastest skittle, A', 'hand, A', 'ball, B', 'fastest skittle, B', 'hand, B']);
  assert.equal(new Set(lines.slice(0, 3).map(([, stroke]) => stroke)).size, 1);
  assert.notEqual(lines[0][1], lines[3][1]);
  assert.equal(lines[1][2], lines[4][2]);
  const speeds = await page.evaluate(() => {
    const { data } = window.headpin.plots.plots[0].plot;
    const most = (values) => Math.max(...values.filter((value) => value !== null && value !== undefined));
    return [most(data[1]), most(data[4])];
  });
  for (const [i, name] of ['game', 'smooth'].entries()) {
    const peak = await page.evaluate((which) => Math.max(...(which ? window.headpin.other : window.headpin.trial).column('series', 'ball_mps')), i);
    assert.ok(Math.abs(speeds[i] - peak) < 1e-9, `${name}: ${speeds[i]}, ${peak}`);
  }

  // Every impulse of both, though many have one time.
  const impulses = await page.evaluate(() => {
    const { curves } = window.headpin.plots.charts.find(({ name }) => name === 'Impulses');
    return curves.map(([, values]) => values.filter((value) => value !== null).length);
  });
  assert.deepEqual(impulses, await page.evaluate(() => [window.headpin.trial, window.headpin.other].map((trial) => trial.sections.get('contacts').rows)));

  // Events: one list, each event of each trial once, both in a row where the same thing happened.
  const rows = await page.locator('#events-body tbody tr').evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  for (const [column, { events }] of [a, b].entries()) {
    const told = events.filter(({ kind }) => kind !== 'ledger' && kind !== 'game_hash').map(({ time_s: time }) => time);
    const times = rows.map((row) => row[column]).filter((time) => time !== '–').map(parseFloat).sort((one, other) => one - other);
    assert.equal(times.length, told.length);
    told.forEach((time, i) => assert.ok(Math.abs(time - times[i]) < 1e-3, `${times[i]}, ${time}`));
  }
  const release = rows.find(([, , what]) => what === 'release');
  assert.ok(release[0] === release[1] && release[4].endsWith(' m/s') && release[5].endsWith(' m/s'), release.join());
  assert.ok(rows.some(([time]) => time === '–') && rows.some(([, time]) => time === '–'));

  const shown = () => page.evaluate(() => [window.headpin.view.trial === window.headpin.other, Boolean(window.headpin.view.otherCast),
    window.headpin.plots.plots[0].plot.series.length]);
  assert.deepEqual(await shown(), [false, true, 7]);
  await page.keyboard.press('b');
  assert.deepEqual(await shown(), [false, false, 4]);
  await page.keyboard.press('b');
  assert.deepEqual(await shown(), [true, false, 4]);
  assert.equal(await page.locator('#pair :checked').getAttribute('value'), 'b');
  await page.keyboard.press('b');
  assert.deepEqual(await shown(), [false, true, 7]);
  assert.deepEqual(await axeFinds(page), []);
  assert.deepEqual(said, []);
  await page.context().close();
});

/** Opens the page and waits for what the engine says of the unmoved trial. */
async function withEngine(file) {
  const opened = await open(browser, file);
  await opened.page.waitForSelector('html[data-engine=yes]');
  return opened;
}

test('the engine in the page comes to the recorded hash and says so', async () => {
  const { page, said, asked } = await withEngine('game.html');
  const { state_hash: hash } = JSON.parse(headpin('replay', 'game.lcmlog', '--json'));
  const words = await page.textContent('#again-status');
  assert.ok(words.includes(hash) && words.includes('equal to the bit with the recording'), words);
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.context().close();
});

test('a moved slider gives what headpin replay gives under that condition', async () => {
  const { page } = await withEngine('game.html');
  const moves = [['friction', '0.2'], ['elasticity', '1'], ['shape', 'ellipsoid'], ['response', 'coulomb'], ['shape', 'true']];
  const words = {};
  for (const [name, value] of moves) {
    words[`--${name}`] = value;
    await page.evaluate(([id, to]) => {
      const control = document.getElementById(id);
      control.value = to;
      control.dispatchEvent(new Event(control.matches('select') ? 'change' : 'input', { bubbles: true }));
    }, [name, value]);
    const { state_hash: hash, skittles_down: down } = JSON.parse(headpin('replay', 'game.lcmlog', ...Object.entries(words).flat(), '--json'));
    await until(page, ([want, felled]) => {
      const text = document.getElementById('again-status').textContent;
      return text.includes(want) && text.includes(`${felled} of `);
    }, [hash, down]);
  }
  await page.click('#unmoved');
  await until(page, () => document.getElementById('again-status').textContent.includes('equal to the bit'));
  await page.context().close();
});

test('a slider says what the trial has until it is moved, however it rounds', async () => {
  headpin('replay', 'game.lcmlog', '--friction', '0.004', '-o', 'slippery.lcmlog');
  headpin('report', 'slippery.lcmlog', '-o', 'slippery.html');
  const { page } = await withEngine('slippery.html');
  const said = () => page.textContent('label:has(#friction) output');
  assert.equal(await said(), '0.004');
  await page.fill('#friction', '0.2');
  assert.equal(await said(), '0.2');
  await page.click('#unmoved');
  assert.equal(await said(), '0.004');
  await page.context().close();
});

test('of a game with two versions a slider sets both', async () => {
  headpin('synthesize', '--participant', '7', '--throws', '1', '-o', 'versions.lcmlog');
  headpin('report', 'versions.lcmlog', '-o', 'versions.html');
  const { page } = await withEngine('versions.html');
  assert.equal(await page.isVisible('#of-versions'), true);
  const { game_hash: hash, games } = JSON.parse(headpin('replay', 'versions.lcmlog', '--friction', '0.3', '--json'));
  await page.evaluate(() => {
    const control = document.getElementById('friction');
    control.value = '0.3';
    control.dispatchEvent(new Event('input', { bubbles: true }));
  });
  await until(page, (want) => document.getElementById('again-status').textContent.includes(want), hash);
  for (const { sheet } of games) assert.ok((await page.textContent('#again-status')).includes(sheet), sheet);
  await page.context().close();
});

test('another log dropped on the page is opened', async () => {
  headpin('synthesize', '-o', 'another.lcmlog', '--seed', '9', '--name', 'somebody else');
  const { page, said } = await withEngine('game.html');
  const bytes = readFileSync(join(folder, 'another.lcmlog')).toString('base64');
  await page.evaluate((text) => {
    const files = new DataTransfer();
    files.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], 'another.lcmlog'));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: files, bubbles: true }));
  }, bytes);
  const { state_hash: hash } = JSON.parse(headpin('replay', 'another.lcmlog', '--json'));
  await until(page, (want) => document.getElementById('hash').textContent === want, hash);
  assert.match(await page.textContent('#subtitle'), /somebody else/);
  for (const id of ['verdict', 'again-status']) assert.doesNotMatch(await page.textContent(`#${id}`), /program/);
  writeFileSync(join(folder, 'junk.lcmlog'), 'junk');
  await page.setInputFiles('#drop', join(folder, 'junk.lcmlog'));
  await until(page, () => /^junk\.lcmlog: ./.test(document.getElementById('again-status').textContent));
  assert.equal(await page.textContent('#hash'), hash);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('what both eyes saw is in the page, on the same clock', async () => {
  headpin('report', 'game.lcmlog', '-o', 'video.html', '--video', 'stereo.mp4');
  const { page, said, asked } = await open(browser, 'video.html');
  await page.waitForSelector('#video:not([hidden])');
  await drawnAt(page, 240);
  await until(page, () => Math.abs(document.querySelector('video').currentTime - 1) < 0.01);
  assert.deepEqual(said, []);
  assert.deepEqual(asked(), []);
  await page.context().close();
});

test('of two sessions the points of every game are told side by side', async () => {
  for (const seed of ['7', '8']) {
    headpin('synthesize', '--participant', seed, '--throws', '4', '-o', `player${seed}.lcmlog`);
  }
  headpin('report', 'player7.lcmlog', 'player8.lcmlog', '-o', 'players.html');
  const { page, said } = await open(browser, 'players.html');
  const row = page.locator('#compared-body tr', { hasText: 'Points' });
  const cells = await row.locator('td').allTextContents();
  for (const [i, seed] of ['7', '8'].entries()) {
    const { games } = JSON.parse(headpin('replay', `player${seed}.lcmlog`, '--json'));
    assert.ok(games.length > 0);
    for (const { points } of games) assert.match(cells[i], new RegExp(`\\b${points}\\b`));
  }
  assert.equal(cells[2], cells[0] === cells[1] ? 'no' : 'yes');
  assert.deepEqual(said, []);
  await page.context().close();
});

test('of two sessions it is told what differs, which throws are lost, and what is simulated again', async () => {
  headpin('synthesize', '--participant', '7', '--throws', '2', '-o', 'samples.lcmlog');
  headpin('replay', 'samples.lcmlog', '-o', 'session.lcmlog');
  headpin('replay', 'session.lcmlog', '--friction', '0', '--set', 'game.ball_back_s=100', '--set', 'lane.masking_panel=true',
    '-o', 'late.lcmlog');
  headpin('report', 'session.lcmlog', 'late.lcmlog', '-o', 'sessions.html', '--video', 'stereo.mp4');
  const { scenario_differences: keys, a, b, bodies_only_in_b: bodies } = JSON.parse(headpin('compare', 'session.lcmlog', 'late.lcmlog', '--json'));
  const { page, said } = await open(browser, 'sessions.html');
  const text = (id) => page.textContent(`#${id}`);
  const compared = await text('compared-body');
  for (const { key } of keys) assert.ok(compared.includes(key), key);
  assert.ok(keys.length > 2 && bodies.length === 1 && compared.includes(bodies[0]));
  assert.ok(a.throws_without_counterpart.length > 0);
  for (const { throw: number, why } of a.throws_without_counterpart) assert.ok(compared.includes(`throw ${number} (`) && compared.includes(why));
  assert.match(await text('first-difference'), /^Of the bodies that both have: /);
  for (const { sheet } of a.games) {  // of both versions
    assert.ok((await text('subtitle')).includes(sheet), sheet);
    assert.ok((await text('result-body')).includes(sheet), sheet);
  }
  assert.match(await text('result-body'), /red version: elasticity 0\.7 each, friction 0\.7 each.*blue version: elasticity 0\.7 each, friction 0 each/);
  const { throws } = JSON.parse(headpin('replay', 'session.lcmlog', '--json'));
  const ways = page.locator('#result-body table', { hasText: 'The ways of the balls' });
  const told = (name) => ways.locator('tr', { hasText: name }).locator('td').allTextContents();
  assert.ok(throws.length > 1 && throws.every(({ board }) => board !== null));
  assert.deepEqual(await told('Exit board'), throws.map(({ exit_board: board, gutter_m: gutter }) =>
    (gutter === null ? board?.toFixed(1) ?? '–' : `gutter at ${gutter.toFixed(1)} m`)));
  assert.deepEqual(await told('Track flare'), throws.map(({ flare_mm: flare }) => flare?.toFixed(0) ?? '–'));
  assert.deepEqual(await told('Touched'), throws.map(({ touched }) => touched || '–'));
  assert.equal(await text('game-hash'), a.game_hash);
  assert.notEqual(a.game_hash, b.game_hash);

  assert.equal(await text('video-caption'), 'What both eyes saw');
  await page.evaluate(() => window.headpin.showAgain(window.headpin.other, 'again'));
  for (const id of ['events-heading', 'plots-heading', 'result-heading']) assert.match(await text(id), /simulated again/);
  assert.match(await text('video-caption'), /not of what is simulated again/);
  assert.match(await text('subtitle'), /recorded: .*simulated again/);
  await page.evaluate(() => window.headpin.showAgain(null, 'recorded'));
  assert.doesNotMatch(await text('subtitle'), /simulated again/);
  assert.equal(await text('video-caption'), 'What both eyes saw');
  assert.deepEqual(said, []);
  await page.context().close();
});

test('past 20 MB it lies beside the page, and is shown from there', async () => {
  const padding = Buffer.alloc(21e6);  // a box of the file that players pass over
  padding.writeUInt32BE(padding.length);
  padding.write('free', 4);
  writeFileSync(join(folder, 'long.mp4'), Buffer.concat([readFileSync(join(folder, 'stereo.mp4')), padding]));
  headpin('report', 'game.lcmlog', '-o', 'beside.html', '--video', 'long.mp4');
  const { page, said, asked } = await open(browser, 'beside.html');
  await page.waitForSelector('#video:not([hidden])');
  await drawnAt(page, 240);
  await until(page, () => Math.abs(document.querySelector('video').currentTime - 1) < 0.01);
  assert.deepEqual(said, []);
  assert.deepEqual([...new Set(asked())], [urlOf('beside.mp4')]);
  await page.context().close();
});

test('where a mesh file is gone, the page says that a body is not as the eyes saw it', async () => {
  copyFileSync(join(root, 'assets/meshes/skittle_hull.obj'), join(folder, 'pin.obj'));
  writeFileSync(join(folder, 'pin.toml'), "[skittle]\nmesh = {file = 'pin.obj'}\n");
  headpin('synthesize', '-o', 'pin.lcmlog', '--scenario', 'pin.toml', '--duration', '7');
  rmSync(join(folder, 'pin.obj'));
  headpin('report', 'pin.lcmlog', '-o', 'pin.html');
  const { page, said } = await withEngine('pin.html');
  assert.match(await page.textContent('#not-as-seen'), /skittles.*pin\.obj/);
  await page.setInputFiles('#drop', join(folder, 'pin.lcmlog'));
  await until(page, () => document.getElementById('again-status').textContent.includes('holds no states to compare with'));
  assert.match(await page.textContent('#not-as-seen'), /skittles.*pin\.obj/);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('without WebGL only the picture is missing', async () => {
  const without = await launch(['--disable-3d-apis']);
  const { page } = await open(without, 'game.html');
  await page.waitForSelector('html[data-engine=yes]');
  assert.match(await page.textContent('#seen'), /^No picture: this browser cannot draw in 3D \(.+\)/);
  for (const id of ['view', 'modes', 'from-field', 'layers']) assert.equal(await page.isVisible(`#${id}`), false, id);
  assert.equal(await page.isVisible('#trouble'), false);
  for (const key of ['2', '1', 't', 'w', 'r', ']']) await page.keyboard.press(key);
  assert.match(await page.textContent('#nearest'), /grab ball/);
  const { state_hash: hash } = JSON.parse(headpin('replay', 'game.lcmlog', '--json'));
  assert.equal(await page.textContent('#hash'), hash);
  assert.ok((await page.textContent('#again-status')).includes(hash));
  assert.ok(await page.locator('.plot canvas').count() >= 6);
  assert.ok(await page.locator('#events-body tbody tr').count() > 10);
  await page.fill('#friction', '0.2');
  const { state_hash: other } = JSON.parse(headpin('replay', 'game.lcmlog', '--friction', '0.2', '--json'));
  await until(page, (want) => document.getElementById('again-status').textContent.includes(want), other);
  assert.deepEqual(await axeFinds(page), []);
  await without.close();
});

/** Whether all of an element is on the screen. */
const onScreen = (page, selector) => page.locator(selector).evaluate((element) => {
  const { top, bottom, left, right } = element.getBoundingClientRect();
  return top >= 0 && left >= 0 && bottom <= innerHeight && right <= innerWidth;
});

for (const [width, height] of [[360, 640], [390, 844], [768, 1024], [1366, 768], [1920, 1080], [2560, 1440]]) {
  test(`the first screen has picture, clock, score and what was recorded: ${width} x ${height}`, async () => {
    const { page } = await open(browser, 'game.html', { width, height });
    for (const id of ['#title', '#subtitle', '#view', '#play', '#time', '#scrub']) assert.ok(await onScreen(page, id), id);
    assert.match(await page.textContent('#subtitle'), /9 of 10 skittles down/);
    assert.ok((await page.locator('#view').boundingBox()).height >= 0.25 * height);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    if (width >= 1366) {
      for (const panel of ['again', 'plots', 'events', 'provenance']) {
        await page.click(`#jump a[href="#${panel}"]`);
        for (const id of ['#view', '#play', '#time', `#${panel}-heading`]) assert.ok(await onScreen(page, id), `${panel}: ${id}`);
      }
    }
    await page.context().close();
  });
}

test('the row of the last event is marked and follows the clock', async () => {
  const { page } = await open(browser, 'game.html', { width: 1366, height: 768 });
  const events = JSON.parse(headpin('info', 'game.lcmlog', '--json')).events  // in time; sums come after all
    .filter(({ kind }) => kind !== 'ledger' && kind !== 'game_hash');
  assert.equal(await page.locator('#events-body tr[aria-current]').count(), 0);
  await page.evaluate(() => scrollTo(0, 0));
  for (const tick of [events[0].tick, 1215, 1682, 1300]) {
    await page.evaluate((to) => window.headpin.clock.go(to), tick);
    const { row, seen } = await page.locator('#events-body tr[aria-current]').evaluate((element) => {
      const [a, b] = [element, element.closest('.scroll')].map((one) => one.getBoundingClientRect());
      return { row: element.cells[1].textContent, seen: a.top >= b.top && a.bottom <= b.bottom + 1 };
    });
    assert.equal(Number(row), events.findLast((event) => event.tick <= tick).tick);
    assert.ok(seen, `the row of tick ${row}`);
  }
  assert.equal(await page.evaluate(() => scrollY), 0);  // the page itself stays
  await page.locator('#events-body button').first().click();
  assert.equal(await page.evaluate(() => window.headpin.clock.tick), events[0].tick);
  await page.context().close();
});

test('Space plays, whatever was clicked before; after a Tab it is of what has the focus', async () => {
  const { page } = await open(browser, 'game.html');
  const plays = () => page.evaluate(() => window.headpin.clock.playing);
  for (const id of ['#layers [value=trails]', '#modes [value=left]', '#first', '#speed', '#plots summary', '#view']) {
    await page.click(id);
    if (id === '#speed') await page.keyboard.press('Escape');
    const shown = await page.evaluate(() => window.headpin.view.layers.trails);
    await page.keyboard.press('Space');
    assert.equal(await plays(), true, id);
    await page.keyboard.press('Space');
    assert.equal(await plays(), false, id);
    assert.equal(await page.evaluate(() => window.headpin.view.layers.trails), shown, id);
  }
  await page.focus('#layers [value=frusta]');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.value), 'contacts');
  await page.keyboard.press('Space');
  assert.equal(await plays(), false);
  assert.equal(await page.evaluate(() => window.headpin.view.layers.contacts), false);
  await page.context().close();
});

test('the wheel scrolls until the picture is clicked or Ctrl is held', async () => {
  const { page } = await open(browser, 'game.html');
  const away = () => page.evaluate(() => window.headpin.view.orbit.away);
  const { x, y } = await page.locator('#view').boundingBox();
  const first = await away();
  await page.mouse.move(x + 100, y + 100);
  await page.mouse.wheel(0, 200);
  await until(page, () => scrollY > 0);
  assert.equal(await away(), first);
  await page.keyboard.down('Control');
  await page.mouse.wheel(0, 100);
  await until(page, (from) => window.headpin.view.orbit.away > from, first);
  await page.keyboard.up('Control');
  await page.evaluate(() => scrollTo(0, 0));
  await page.mouse.click(x + 100, y + 100);
  const before = await away();
  await page.mouse.wheel(0, 100);
  await until(page, (from) => window.headpin.view.orbit.away > from, before);
  assert.equal(await page.evaluate(() => scrollY), 0);
  await page.context().close();
});

test('on a phone a swipe over the picture scrolls; two fingers turn it and pinch', async () => {
  const { page } = await open(browser, 'game.html', { width: 390, height: 844, hasTouch: true, isMobile: true });
  const orbit = () => page.evaluate(() => { const { away, turn, rise } = window.headpin.view.orbit; return { away, turn, rise }; });
  const { x, y } = await page.locator('#view').boundingBox();
  const touch = await page.context().newCDPSession(page);
  const first = await orbit();
  const fingers = async (...steps) => {  // each step a list of places
    for (const [i, step] of steps.entries()) {
      await touch.send('Input.dispatchTouchEvent', { type: i ? 'touchMove' : 'touchStart',
        touchPoints: step.map(([right, down], id) => ({ x: x + right, y: y + down, id })) });
    }
    await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  };
  await fingers([[100, 100], [200, 100]], [[80, 100], [220, 100]], [[50, 120], [250, 120]]);
  const pinched = await orbit();
  assert.ok(Math.abs(pinched.away / first.away - 0.5) < 1e-9, `${pinched.away} of ${first.away}`);
  assert.ok(pinched.rise > first.rise && pinched.turn === first.turn);
  assert.equal(await page.evaluate(() => scrollY), 0);
  await fingers([[100, 300]], [[100, 260]], [[100, 200]], [[100, 100]], [[100, 40]]);
  await until(page, () => scrollY > 50);
  assert.deepEqual(await orbit(), pinched);
  await page.context().close();
});

test('what went wrong with a dropped file is said where it was dropped, with the command for it', async () => {
  const { page, said } = await withEngine('game.html');
  const drop = (name, x, y) => page.evaluate(([file, clientX, clientY]) => {
    const files = new DataTransfer();
    files.items.add(new File(['time,x,y,z\n'], file));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: files, bubbles: true, clientX, clientY }));
  }, [name, x, y]);
  const box = page.locator('#dropped');
  await drop("it's mine.csv", 300, 200);
  await box.waitFor();
  assert.match(await box.textContent(), /^it's mine\.csv: .+; .*headpin import '\.\/it'\\''s mine\.csv' -o throw\.lcmlog/);
  const place = await box.boundingBox();
  assert.ok(Math.abs(place.x - 300) < 1 && Math.abs(place.y - 200) < 1, JSON.stringify(place));
  await box.locator('button').click();
  assert.equal(await box.isVisible(), false);
  await drop('cut.LCMLOG', 1275, 890);  // in a corner
  await box.waitFor();
  assert.match(await box.textContent(), /headpin info cut\.LCMLOG/);
  const corner = await box.boundingBox();
  assert.ok(corner.x + corner.width <= 1280 && corner.y + corner.height <= 900, JSON.stringify(corner));
  assert.deepEqual(await axeFinds(page), []);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a page without an engine says so of a dropped file', async () => {
  const html = readFileSync(join(folder, 'game.html'), 'utf8');
  const without = html.replace(/<script[^>]*data-block="engine-wasm"[^>]*>[^<]*<\/script>/, '');
  assert.ok(without.length < html.length);
  writeFileSync(join(folder, 'plain.html'), without);
  const { page, said } = await open(browser, 'plain.html');
  await page.waitForSelector('html[data-engine=no]');
  await page.evaluate(() => {
    const files = new DataTransfer();
    files.items.add(new File(['x'], 'other.lcmlog'));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: files, bubbles: true, clientX: 300, clientY: 200 }));
  });
  assert.match(await page.locator('#dropped').textContent(), /^other\.lcmlog: this page has no engine.*headpin report other\.lcmlog -o/);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('plots have one time axis and one unit each, and say the value under the pointer in all', async () => {
  const { page } = await withEngine('game.html');
  const ranges = await page.evaluate(() => window.headpin.plots.plots.map(({ plot }) => [plot.scales.x.min, plot.scales.x.max]));
  assert.ok(ranges.length >= 6);
  for (const range of ranges) assert.deepEqual(range, ranges[0]);
  const captions = await page.locator('.chart figcaption').allTextContents();
  assert.ok(captions.includes('Impulses [N s]') && captions.includes('Speed of approach at contacts [m/s]'), captions.join());
  await page.locator('.plot .u-over').first().scrollIntoViewIfNeeded();
  await page.locator('.plot .u-over').first().hover();
  await until(page, () => [...document.querySelectorAll('.plot')].slice(0, 2).every((plot) =>
    /\d\.\d{3} s$/.test(plot.querySelector('.u-series .u-value').textContent)));
  assert.match(await page.locator('.plot').first().locator('.u-value').nth(1).textContent(), / m\/s$/);
  await page.context().close();
});

test('a table that is open stays open when the trial is simulated again', async () => {
  const { page } = await withEngine('game.html');
  await page.locator('.chart summary').nth(1).click();
  await page.locator('.chart').nth(1).locator('tbody tr').nth(5).waitFor();
  const before = await page.locator('.chart').nth(1).locator('tbody tr').last().textContent();
  await page.fill('#friction', '0.1');
  await until(page, (old) => {
    const rows = document.querySelectorAll('.chart')[1].querySelectorAll('tbody tr');
    return rows.length > 5 && rows[rows.length - 1].textContent !== old;
  }, before);
  assert.equal(await page.locator('.chart details[open]').count(), 1);
  await page.context().close();
});

test('simulating again and again does not fill the memory', async () => {
  const { page, said } = await withEngine('game.html');
  await page.focus('#view');
  await page.keyboard.press('b');
  await page.keyboard.press('b');
  assert.equal(await page.locator('#shown [value=both]').isChecked(), true);
  const devtools = await page.context().newCDPSession(page);
  const heap = async () => {
    await devtools.send('HeapProfiler.collectGarbage');
    return (await devtools.send('Runtime.getHeapUsage')).usedSize;
  };
  const simulate = (times) => page.evaluate(async (most) => {
    const { again, view } = window.headpin;
    for (let i = 0; i < most; ++i) {
      again.set = { friction: i / most };
      await again.simulate();
      view.drawNow(true);
    }
    const { geometries, textures } = view.renderer.info.memory;
    return { geometries, textures, programs: view.renderer.info.programs.length };
  }, times);
  const held = await simulate(25);  // compiled and optimised by then
  const before = await heap();
  assert.deepEqual(await simulate(40), held);
  const grown = (await heap()) - before;
  assert.ok(grown < 40 * 10_000, `${grown} bytes in 40 simulations`);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('values of events have the units of docs/events.md', async () => {
  const { page } = await open(browser, 'game.html');
  const told = readFileSync(join(root, 'docs/events.md'), 'utf8');
  const rows = await page.locator('#events-body tbody tr').evaluateAll((all) => all.map((row) =>
    [...row.querySelectorAll('td')].map((cell) => cell.textContent)));
  let units = 0;
  for (const [, what, , value] of rows) {
    const line = told.split('\n').find((one) => one.startsWith(`| \`${what.replaceAll(' ', '_')}\` |`));
    const unit = /\[([^\]]+)\] \|$/.exec(line)?.[1] ?? '';
    if (value === '–') continue;
    assert.equal(value.split(' ')[1] ?? '', unit, `${what}: ${value}`);
    units += unit !== '';
  }
  assert.ok(units > 5);
  await page.context().close();
});

test('on paper, what cannot be pressed is gone, and plots and tables are there', async () => {
  const { page } = await open(browser, 'game.html');
  await page.emulateMedia({ media: 'print' });
  assert.equal(await page.isVisible('#play'), false);
  assert.equal(await page.isVisible('#provenance-body'), true);
  assert.equal(await page.isVisible('.plot canvas'), true);
  assert.ok((await page.pdf()).length > 50_000);
  await page.context().close();
});
