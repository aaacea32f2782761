// How long a tick of the page of `play` takes: node play_ticks.mjs HEADPIN ENGINE_FOLDER
//
// A game in WebAssembly, as the page plays it: a hand swings the ball at the rack. Each tick is one call of advance(): the
// step, the game, the log, and the poses that the page draws. The game is played several times, with the same bits; the
// shortest time of each tick counts, as other programs interrupt.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { inflateSync } from 'node:zlib';

const kGames = 9;
const kTakes = 0.5, kSwings = 1.0, kLetsGo = 1.5, kFalls = 1.5, kEnds = 8;  // s
const kAim = 0.06, kHeight = 0.3, kSpeed = 7;                 // m, m, m/s
const [headpin, engineFolder] = process.argv.slice(2).map((path) => resolve(path));

/** What the page of a scenario says of it. */
function pageJson(scenario) {
  const folder = mkdtempSync(join(tmpdir(), 'headpin-play-ticks-'));
  try {
    const page = join(folder, 'play.html');
    execFileSync(headpin, ['play', scenario, '-o', page], { stdio: 'ignore' });
    const [, block] = readFileSync(page, 'utf8').match(/data-block="play"[^>]*>([^<]+)</);
    return JSON.parse(inflateSync(Buffer.from(block, 'base64')));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Where the ball is wanted, in the world: from its home back and down to the lane's middle, then faster and faster ahead. */
function ballAt(t, [x, y, z]) {
  const back = Math.min(1, Math.max(0, (t - kTakes) / (kSwings - kTakes)));
  const s = Math.max(0, t - kSwings), far = 0.5 * kSpeed * (kLetsGo - kSwings);
  return [x + back * (kAim - x), y - back * far + (0.5 * kSpeed * s * s) / (kLetsGo - kSwings), z + back * (kHeight - z)];
}

function checked(answer) {
  if (answer.error) throw new Error(answer.error);
  return answer;
}

/** Microseconds of each tick of one game, and what it said at its end. */
function play(engine, json) {
  const [w, qx, qy, qz, ...origin] = json.X_WT;
  const q_TW = [w, -qx, -qy, -qz];  // the hand keeps the axes of the world
  const inT = (p) => [p[0] - origin[0], p[2] - origin[2], -(p[1] - origin[1])];
  const home = json.ball.homes[0];
  const period = 1e6 / json.rate_hz;
  const times = [];
  let down = 0, hit = 0;
  checked(engine.begin({ scenario: json.scenario.text, device: 'mouse' }));
  let pressed = false;
  for (let tick = 1; tick <= kEnds * json.rate_hz; ++tick) {
    const now = Math.round(tick * period), t = now / 1e6;
    if (tick % 4 === 0) {
      const ball = ballAt(Math.min(t, kLetsGo + 0.05), home);
      checked(engine.tracker(1, now, now, [...q_TW, ...inT([origin[0], origin[1], 1.7])], false));
      checked(engine.tracker(2, now, now, [...q_TW, ...inT(ball.map((x, i) => x - json.hand.grip[i]))], false));
      const press = t >= kTakes && t < kLetsGo;
      if (press !== pressed) checked(engine.buttons(now, now, false, false, press));
      pressed = press;
    }
    const begin = process.hrtime.bigint();
    const answer = engine.advance(now);
    times.push(Number(process.hrtime.bigint() - begin) / 1e3);
    checked(answer);
    for (const { kind } of answer.news?.events ?? []) {
      down += kind === 'skittle_down';
      if (kind === 'first_contact') hit ||= tick;
    }
    if (tick % 60 === 0) engine.takeLog();
  }
  if (down === 0) throw new Error('the ball hit nothing');
  return { times, down, hit, hash: JSON.parse(checked(engine.finish(0, 0)).json).game_hash };
}

const factory = createRequire(import.meta.url)(join(engineFolder, 'engine.js'));
const engine = await factory({ wasmBinary: readFileSync(join(engineFolder, 'engine.wasm')) });
console.log('us a tick                  mean   while the rack falls: mean   p99   longest');
for (const scenario of ['regulation-ten-pin', 'uno-slater-1997', 'german-ninepins']) {
  const json = pageJson(scenario);
  const games = Array.from({ length: kGames }, () => play(engine, json));
  const [{ hit, down, hash }] = games;
  if (games.some((game) => game.hash !== hash)) throw new Error(`${scenario}: the games differ`);
  const least = games[0].times.map((_, i) => Math.min(...games.map(({ times }) => times[i])));
  const falling = least.slice(hit - 1, hit - 1 + kFalls * json.rate_hz).sort((a, b) => a - b);
  const mean = (all) => all.reduce((a, b) => a + b) / all.length;
  const cells = [mean(least), mean(falling), falling[Math.floor(0.99 * falling.length)], falling[falling.length - 1]];
  const [all, ...rest] = cells.map((x) => x.toFixed(1));
  console.log(`${scenario.padEnd(20)}${all.padStart(11)}${rest[0].padStart(29)}${rest[1].padStart(6)}${rest[2].padStart(10)}   ${down} down`);
}
