// What the page says, without a browser: node --test words.test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';

import { csvOf } from '../src/csv.js';
import { thinned } from '../src/curves.js';
import { paired, resultRows, valueOf } from '../src/facts.js';
import { againInWords, conditionInWords, eyeInWords, firstDifferenceInWords, framesOf, hashInWords, headInWords, lostEnergy, number, resultInBrief,
  skittlesInWords, versionInWords, videoInWords } from '../src/words.js';

const each = (value) => ({ skittle: value, ball: value, lane: value, wall: value });

function summary(parts = {}) {
  return { games: [], skittles: 10, skittles_down: 9, elasticity: each(0.7), friction: each(0.7), shape: 'true', versions: null,
    state_hash: 'aaaa', game_hash: 'bbbb', simulated_s: 7, ticks: 1682, ...parts };
}

/** A trial as the page has it: simulated to `game`, recorded whole unless said otherwise. */
function trialOf({ hash = {}, log = {}, openedHere = false, ...parts } = {}) {
  return {
    openedHere,
    json: {
      rate_hz: 240,
      summary: summary(parts),
      hash: { game_replayed: 'bbbb', game_recorded: 'bbbb', replayed: 'aaaa', recorded: 'aaaa', verified_ticks: 1682, first_difference: null, ...hash },
      trial: { name: 't.lcmlog', participant: '', condition: '', scenario_name: 'paper-room', duration_s: 7, complete: true, ...log },
    },
  };
}

const again = (parts = {}, lost = []) => ({ json: { summary: summary(parts), throws_without_counterpart: lost } });

const tenFrames = { name: '', rules: 'ten-pin', points: 112, over: true, rolls: [[6, 4], [10], [3, 4]],
  sheet: 'ten-pin: 6 / | X | 3 4 = 112' };
const red = { ...tenFrames, name: 'red', sheet: 'red ten-pin: 6 / | X | 3 4 = 112' };
const blue = { ...tenFrames, name: 'blue', sheet: 'blue ten-pin: 3 4 = 7 (not over)', rolls: [[3, 4]], points: 7 };

test('a game of ten frames is told by its sheet, never as 64 of 10', () => {
  const of = { games: [tenFrames], skittles_down: 64 };
  for (const words of [resultInBrief(summary(of)), againInWords(trialOf(), { friction: 0 }, again(of), 10), headInWords(trialOf(of))]) {
    assert.doesNotMatch(words, /64 of/);
    assert.match(words, /6 \/ \| X \| 3 4 = 112/);
  }
  assert.equal(resultInBrief(summary()), '9 of 10 skittles down');
});

test('what a slider would round is told as the trial has it', () => {
  assert.equal(skittlesInWords(summary({ friction: each(0.004) }), 'friction'), '0.004');
  assert.equal(skittlesInWords(summary({ elasticity: each(0.8185) }), 'elasticity'), '0.8185');
  const versions = { red: { friction: each(0.7125) }, blue: { friction: each(0.004) } };
  assert.equal(skittlesInWords(summary({ friction: null, versions }), 'friction'), 'red 0.7125, blue 0.004');
});

test('a spare is a spare in the table too', () => {
  assert.deepEqual(framesOf(tenFrames), ['6 /', 'X', '3 4']);
  assert.deepEqual(framesOf(blue), ['3 4']);
  assert.deepEqual(framesOf({ ...blue, rolls: [[3, 4], []] }), ['3 4']);
});

test('of two versions the header tells both', () => {
  const words = headInWords(trialOf({ games: [red, blue] }));
  assert.ok(words.includes(red.sheet) && words.includes(blue.sheet), words);
});

test('who simulated a trial is told: the program, or the page that it was opened in', () => {
  assert.match(hashInWords(trialOf()), /by the program that made this page: equal to the bit in 1682 recorded ticks/);
  const dropped = hashInWords(trialOf({ openedHere: true }));
  assert.match(dropped, /in this page: equal to the bit/);
  assert.doesNotMatch(dropped, /program/);
  const raw = { hash: { recorded: null, game_recorded: null, verified_ticks: 0 } };
  assert.match(hashInWords(trialOf(raw)), /no states to compare with; simulated by the program/);
  const rawDropped = trialOf({ ...raw, openedHere: true });
  for (const words of [hashInWords(rawDropped), againInWords(rawDropped, {}, again(), 10), headInWords(rawDropped)]) {
    assert.doesNotMatch(words, /program|equal|recorded/);
  }
  assert.match(againInWords(trialOf(raw), {}, again(), 10), /equal to the bit with what the program that made this page came to/);
});

test('a log that is cut is not told as sound', () => {
  const cut = trialOf({ log: { complete: false }, hash: { verified_ticks: 840, game_recorded: null } });
  assert.match(headInWords(cut), /the log is not complete/);
  assert.match(hashInWords(cut), /the 840 recorded ticks that are left/);
  assert.match(hashInWords(cut), /not complete/);
  assert.match(againInWords(cut, {}, again(), 10), /as far as it goes/);
});

test('equal is said of the whole game, not of its last state', () => {
  const other = againInWords(trialOf(), {}, again({ game_hash: 'cccc' }), 10);
  assert.match(other, /not equal to the recording/);
  const differs = trialOf({ hash: { first_difference: { tick: 24, time_s: 0.1, body: 'ball' } } });
  assert.match(againInWords(differs, {}, again(), 10), /not equal to the recording/);
  assert.match(hashInWords(differs), /first at tick 24 \(0\.1 s\) in the ball/);
});

test('recorded and simulated are told apart in the header', () => {
  const words = headInWords(trialOf(), again({ skittles_down: 3 }));
  assert.match(words, /recorded: 9 of 10/);
  assert.match(words, /simulated again, with what is set below: 3 of 10/);
});

test('throws without a counterpart are told', () => {
  const lost = [{ throw: 7, name: 'red', time_s: 63.2, why: 'not thrown: the hand closed on nothing' }];
  assert.match(againInWords(trialOf(), { friction: 0 }, again({}, lost), 10),
    /1 throw of the trial has no counterpart: throw 7 \(red, 63\.200 s\): not thrown/);
});

test('of versions that differ each has its own condition', () => {
  const versions = { red: { elasticity: each(0.7), friction: each(0.7), shape: 'true' }, blue: { elasticity: each(0.7), friction: each(0), shape: 'true' } };
  const s = summary({ friction: null, versions });
  assert.equal(conditionInWords(s, 'friction'), 'red 0.7 each; blue 0 each');
  assert.equal(conditionInWords(s, 'elasticity'), '0.7 each');
  assert.equal(versionInWords(s, 'blue'), 'elasticity 0.7 each, friction 0 each, shape true');
});

test('what rounding leaves of no energy is none', () => {
  assert.equal(number(lostEnergy({ impact_j: 7.8e-14 })), '0');
  assert.equal(number(lostEnergy({ impact_j: -12.5 })), '12.5');
});

test('other bodies are said before what the rest differs in', () => {
  assert.match(firstDifferenceInWords(null, true), /^Of the bodies that both have: /);
  assert.match(firstDifferenceInWords({ tick: 5, time_s: 0.02, body: 'ball' }, false), /^First different tick: 5 /);
});

test('a table as CSV has as many fields in its head as in its rows, whatever its names are', () => {
  assert.equal(csvOf(['time_s', 'ball, A', 'a "b"'], [[0, 1, null], [0.5, 2, 3]]),
    'time_s,"ball, A","a ""b"""\r\n0,1,\r\n0.5,2,3');
});

test('a video that lasts otherwise than its trial is told', () => {
  assert.equal(videoInWords(421 / 60, 1682 / 240), '');  // a frame longer
  assert.equal(videoInWords(71 / 10, 1682 / 240), '');   // likewise, of a slow display
  assert.match(videoInWords(0.5, 1682 / 240), /video lasts 0\.500 s, the trial 7\.008 s.*last picture stays/);
  assert.match(videoInWords(9, 1682 / 240), /video lasts 9\.000 s/);
  assert.doesNotMatch(videoInWords(9, 1682 / 240), /last picture/);
});

test('the pixels of a display are told, and that its lens is not drawn', () => {
  const eye = { width: 360, height: 240, pixel_aspect: 1.0795, lens: true };
  assert.match(eyeInWords(eye), /^360 × 240 pixels a picture, each 1\.08 times as wide as high.* without the distortion/);
  assert.doesNotMatch(eyeInWords({ ...eye, lens: false }), /lens/);
});

function whole(parts = {}) {
  return summary({ release_speed_mps: 6.5512, impact_speed_mps: 4.84, response: 'paper', detection: 'x',
    statistics: { impacts: 12, deepest_overlap_m: 0 }, ledger: { impact_j: -12.5 }, ...parts });
}

test('numbers that differ are told to differ, with the digits that show it', () => {
  const rows = (parts) => new Map(resultRows([whole(), whole(parts)]).map(([name, ...told]) => [name, told]));
  assert.deepEqual(rows({}).get('Ball at release'), [['6.55 m/s', '6.55 m/s'], false]);
  assert.deepEqual(rows({ release_speed_mps: 6.5549 }).get('Ball at release'), [['6.551 m/s', '6.555 m/s'], true]);
  const last = rows({ impact_speed_mps: 4.840000000000001 }).get('Ball at the first skittle');
  assert.deepEqual(last, [['4.84 m/s', '4.840000000000001 m/s'], true]);
  assert.deepEqual(rows({ friction: each(0.7001) }).get('Friction'), [['0.7 each', '0.7001 each'], true]);
  assert.deepEqual(rows({ ledger: { impact_j: -12.51 } }).get('Energy lost in impacts'), [['12.5 J', '12.51 J'], true]);
  assert.equal(rows({ game_hash: 'cccc' }).get('Game hash')[1], true);
  assert.deepEqual(resultRows([whole()]).map(([, told, differs]) => [told.length, differs]), resultRows([whole()]).map(() => [1, false]));
});

test('an event has its value of 0 where its kind has values', () => {
  const of = (kind, value) => valueOf({ kind, value });
  assert.equal(of('delivery', 0), '0');
  assert.equal(of('game_over', 0), '0');
  assert.equal(of('release', 0), '0 m/s');
  assert.equal(of('release', 6.55), '6.55 m/s');
  assert.equal(of('grab', 0), '–');
  assert.equal(of('constructor', 0), '–');
  assert.equal(valueOf(undefined), '–');
});

test('what is thinned keeps its extremes at their own times, in order', () => {
  const n = 20_000;
  // Events with pauses: a burst, a minute of nothing, a burst.
  const times = Float64Array.from({ length: n }, (_, i) => i * 1e-3 + (i < n / 2 + 3 ? 0 : 60));
  const wave = (k) => Float64Array.from(times, (_, i) => ((i * k) % 9973) + 1);
  const curves = [['a', wave(7)], ['b', wave(31)]];
  const [at, ...values] = thinned({ times, curves });
  assert.ok(at.length <= 3002 && at.length > 1000, `${at.length}`);
  assert.ok(at.every((time, i) => i === 0 || time > at[i - 1]));
  const rowOf = new Map(Array.from(times, (time, i) => [time, i]));
  values.forEach((column, which) => column.forEach((value, i) => assert.equal(value, curves[which][1][rowOf.get(at[i])])));
  curves.forEach(([, all], which) => {
    assert.equal(Math.max(...values[which]), Math.max(...all));
    assert.equal(Math.min(...values[which]), Math.min(...all));
  });
  assert.deepEqual([at[0], at[at.length - 1]], [times[0], times[n - 1]]);
  const few = { times: [0, 1], curves: [['a', [2, 3]]] };
  assert.deepEqual(thinned(few), [[0, 1], [2, 3]]);
  const gaps = thinned({ times, curves: [['a', new Float64Array(n).fill(NaN)]] });
  assert.ok(gaps[0].length > 0 && gaps[1].every(Number.isNaN));
});

test('events of two trials are paired with the nearest', () => {
  const at = (tick, kind = 'touch', bodies = ['ball', 'lane']) => ({ tick, kind, bodies });
  const ticks = (rows) => rows.map(({ a, b }) => [a?.tick, b?.tick]);
  assert.deepEqual(ticks(paired([at(300)], [at(100), at(290), at(305)], 240)), [[undefined, 100], [undefined, 290], [300, 305]]);
  assert.deepEqual(ticks(paired([at(100), at(200)], [at(195)], 240)), [[100, undefined], [200, 195]]);
  assert.deepEqual(ticks(paired([at(100)], [at(341)], 240)), [[100, undefined], [undefined, 341]]);
  assert.deepEqual(ticks(paired([at(100)], [at(100, 'touch', ['ball', 'wall'])], 240)), [[100, undefined], [undefined, 100]]);
});

test('pairs of events of two trials keep their order, also where very many are alike', () => {
  const at = (tick) => ({ tick, kind: 'touch', bodies: ['ball', 'lane'] });
  const ticks = (rows) => rows.map(({ a, b }) => [a?.tick, b?.tick]);
  assert.deepEqual(ticks(paired([100, 150].map(at), [145, 160].map(at), 240)), [[100, undefined], [150, 145], [undefined, 160]]);
  assert.deepEqual(ticks(paired([100, 100].map(at), [100, 100].map(at), 240)), [[100, 100], [100, 100]]);
  const many = Array.from({ length: 20_000 }, (_, i) => at(i % 200));
  const rows = paired(many, many.slice(1), 240);
  assert.equal(rows.length, 20_000);
  assert.equal(rows.filter(({ a, b }) => a && b).length, 19_999);
});

test('of two versions that differ in detection each is told', () => {
  const version = (detection) => ({ elasticity: each(0.7), friction: each(0.7), shape: 'true', detection });
  const s = whole({ detection: null, versions: { blue: version('paper'), red: version('converged') } });
  const told = new Map(resultRows([s]).map(([name, [words]]) => [name, words]));
  assert.equal(told.get('Detection'), 'blue paper; red converged');
  assert.equal(versionInWords(s, 'red'), 'elasticity 0.7 each, friction 0.7 each, shape true, detection converged');
});
