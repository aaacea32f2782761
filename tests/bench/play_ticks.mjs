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
const kTakes = 0.5, kSwings = 0.8, kLetsGo = 1.3, kEnds = 7;  // s
const kLift = 0.05, kSpeed = 7;                               // m, m/s
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

/** Where the ball is wanted, in the world: at its home, a bit up and back, then faster and faster down the lane. */
function ballAt(t, [x, y, z]) {
  const lifted = z + kLift * Math.min(1, Math.max(0, (t - kTakes) / (kSwings - kTakes)));
  const s = Math.max(0, t - kSwings);
  return [x, y + (0.5 * kSpeed * s * s) / (kLetsGo - kSwings), lifted];
}

/** Microseconds of each tick of one game, and what it said at its end. */
function play(engine, json) {
  const [w, qx, qy, qz, ...origin] = json.X_WT;
  const q_TW = [w, -qx, -qy, -qz];  // the hand keeps the axes of the world
  const inT = (p) => [p[0] - origin[0], p[2] - origin[2], -(p[1] - origin[1])];
  const home = json.ball.homes[0];
  const period = 1e6 / json.rate_hz;
  const times = [];
  engine.begin({ scenario: json.scenario.text, device: 'mouse' });
  let pressed = false;
  for (let tick = 1; tick <= kEnds * json.rate_hz; ++tick) {
    const now = Math.round(tick * period), t = now / 1e6;
    if (tick % 4 === 0) {
      const ball = ballAt(Math.min(t, kLetsGo + 0.1), home);
      engine.tracker(1, [...q_TW, ...inT([origin[0], origin[1], 1.7])], now, now, false);
      engine.tracker(2, [...q_TW, ...inT(ball.map((x, i) => x - json.hand.grip[i]))], now, now, false);
      const press = t >= kTakes && t < kLetsGo;
      if (press !== pressed) engine.buttons(now, now, false, false, press);
      pressed = press;
    }
    const begin = process.hrtime.bigint();
    const { error } = engine.advance(now);
    times.push(Number(process.hrtime.bigint() - begin) / 1e3);
    if (error) throw new Error(error);
    if (tick % 60 === 0) engine.takeLog();
  }
  const end = engine.finish(0, 0);
  return { times, end: JSON.parse(end.json) };
}

const factory = createRequire(import.meta.url)(join(engineFolder, 'engine.js'));
const engine = await factory({ wasmBinary: readFileSync(join(engineFolder, 'engine.wasm')) });
console.log('scenario              skittles down   mean   p99   longest [us a tick]');
for (const scenario of ['regulation-ten-pin', 'uno-slater-1997', 'german-ninepins']) {
  const json = pageJson(scenario);
  const games = Array.from({ length: kGames }, () => play(engine, json));
  const hashes = new Set(games.map(({ end }) => end.game_hash));
  if (hashes.size !== 1) throw new Error(`${scenario}: the games differ: ${[...hashes].join(', ')}`);
  const least = games[0].times.map((_, i) => Math.min(...games.map(({ times }) => times[i])));
  const sorted = [...least].sort((a, b) => a - b);
  const mean = least.reduce((a, b) => a + b) / least.length;
  const at = (part) => sorted[Math.floor(part * (sorted.length - 1))];
  console.log(scenario.padEnd(22), String(games[0].end.skittles_down).padStart(13),
    ...[mean, at(0.99), at(1)].map((x) => x.toFixed(1).padStart(x === mean ? 6 : 5)));
}
