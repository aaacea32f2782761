// The engine of the page, in node, against the program: node engine.test.mjs HEADPIN ENGINE_FOLDER
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import test, { after } from 'node:test';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const [headpin, engineFolder] = process.argv.slice(2).map((path) => resolve(path));
const demo = join(here, '../../assets/trials/demo.lcmlog');

const folder = mkdtempSync(join(tmpdir(), 'headpin-page-engine-'));
after(() => rmSync(folder, { recursive: true }));
const at = (name) => join(folder, name);
const run = (...words) => JSON.parse(execFileSync(headpin, [...words, '--json'], { maxBuffer: 1 << 28 }));

const factory = createRequire(import.meta.url)(join(engineFolder, 'engine.js'));
const engine = await factory({ wasmBinary: readFileSync(join(engineFolder, 'engine.wasm')) });

function answered(answer) {
  assert.equal(answer.error, undefined);
  return { ...answer, ...JSON.parse(answer.json) };
}

/** What both tell, the program in words of its own. */
function same(summary, replayed) {
  for (const [key, value] of Object.entries(summary)) assert.deepEqual(value, replayed[key], key);
  assert.ok('state_hash' in summary && 'games' in summary && 'ledger' in summary);
}

/** A question and the options that ask the program the same. */
const conditions = [
  {},
  { friction: 0 },
  { friction: 0.3 },
  { elasticity: 0.95 },
  { shape: 'true' },
  { response: 'coulomb' },
  { elasticity: 0.6, friction: 1, shape: 'true', response: 'coulomb' },
];
const options = (moved) => Object.entries(moved).flatMap(([key, value]) => [`--${key}`, `${value}`]);

test('the bundled trial comes to the recorded hash, every tick of it', () => {
  run('replay', demo, '-o', at('recorded.lcmlog'));
  const { hash, floats, meshes } = answered(engine.open(readFileSync(at('recorded.lcmlog'))));
  const { game_replayed: game, game_recorded: recorded, ...states } = hash;
  const again = run('replay', demo);
  assert.deepEqual(states, { replayed: again.state_hash, recorded: again.state_hash, verified_ticks: 1682,
    first_difference: null });
  assert.equal(game, again.game_hash);
  assert.equal(recorded, game);
  assert.ok(floats.length > 0 && floats.every(Number.isFinite));
  assert.ok(meshes.length > 0);
  assert.equal(floats.byteLength, floats.buffer.byteLength);  // a copy, not the memory of the engine
});

test('a moved trial comes to what headpin replay says', () => {
  answered(engine.load(readFileSync(demo)));
  for (const moved of conditions) {
    same(answered(engine.simulate(moved)).summary, run('replay', demo, ...options(moved)));
  }
  assert.equal(answered(engine.simulate({})).meshes.length, 0);
});

test('so does a session of whole games', () => {
  run('synthesize', '--participant', '7', '-o', at('session.lcmlog'));
  answered(engine.load(readFileSync(at('session.lcmlog'))));
  const { summary } = answered(engine.simulate({}));
  same(summary, run('replay', at('session.lcmlog')));
  assert.equal(summary.games.filter((game) => game.over).length, 2);
  // Under another response the recorded hand may come too early for a ball: its game is not over.
  same(answered(engine.simulate({ response: 'coulomb' })).summary,
    run('replay', at('session.lcmlog'), '--response', 'coulomb'));
});

test('a cut-off trial comes to what headpin replay makes of it', () => {
  const whole = readFileSync(demo);
  for (const share of [0.3, 0.77]) {
    writeFileSync(at('cut.lcmlog'), whole.subarray(0, share * whole.length));
    const { summary, trial } = answered(engine.open(readFileSync(at('cut.lcmlog'))));
    same(summary, run('replay', at('cut.lcmlog')));
    assert.equal(trial.complete, false);
  }
});

test('what is no trial is refused in words, and the one before stays', () => {
  answered(engine.load(readFileSync(demo)));
  const whole = readFileSync(demo);
  for (const [bytes, words] of [
    [new Uint8Array(0), /is empty; expected an LCM event log/],
    [new TextEncoder().encode('<script>alert(1)</script>'), /not an LCM event log/],
    [new Uint8Array(1 << 20), /not an LCM event log/],
    [whole.subarray(0, 20), /no whole event in 20 bytes/],
    [whole.subarray(whole.length / 2), /no message on HEADPIN_TRIAL/],
  ]) {
    assert.match(engine.open(bytes).error, words);
    assert.match(engine.load(bytes).error, words);
  }
  assert.equal(answered(engine.simulate({})).summary.state_hash, run('replay', demo).state_hash);
});

test('a question that is none is refused in words', () => {
  answered(engine.load(readFileSync(demo)));
  for (const [moved, words] of [
    [{ friction: 1.5 }, /friction.* 0 to 1.* 1\.5/],
    [{ elasticity: -0.1 }, /elasticity.* 0 to 1.* -0\.1/],
    [{ friction: NaN }, /friction: expected a number, found null/],
    [{ elasticity: '<b>' }, /elasticity: expected a number, found "<b>"/],
    [{ shape: 'cube' }, /collision.shape.* found .*cube/],
    [{ response: 7 }, /response: expected a name, found 7/],
    [{ gravity: 1 }, /found gravity/],
  ]) {
    assert.match(engine.simulate(moved).error, words);
  }
});

test('without a trial the engine says so', async () => {
  const fresh = await factory({ wasmBinary: readFileSync(join(engineFolder, 'engine.wasm')) });
  assert.match(fresh.simulate({}).error, /no trial is open/);
});

test('damaged trials give numbers or words, never a stop', () => {
  const count = Number(process.env.HEADPIN_DAMAGED ?? 100);
  execFileSync('python3', ['-B', join(here, 'damaged_logs.py'), headpin, demo, at('damaged'), `${count}`]);
  let opened = 0;
  for (const name of readdirSync(at('damaged'))) {
    const answer = engine.open(readFileSync(join(at('damaged'), name)));
    assert.doesNotMatch(answer.error ?? '', /^the engine stopped/, name);
    assert.ok(answer.error !== '' && (answer.error === undefined) !== (answer.json === undefined), name);
    opened += answer.error === undefined;
  }
  assert.ok(opened > count / 4 && opened < count, `${opened} of ${count} were opened`);
});
