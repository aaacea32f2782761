// What is said of a trial, as text alone: what was recorded, what was simulated, and by whom.

/** A number as people read it; what only rounding left is none. */
export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (Number.isInteger(value)) return String(value);
  return Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3)
    ? value.toExponential(digits - 1) : Number(value.toPrecision(digits)).toString();
}

/** "9 of 10 skittles down"; of games, every score sheet. */
export function resultInBrief(summary) {
  return summary.games.length ? summary.games.map(({ sheet }) => sheet).join('; ')
    : `${summary.skittles_down} of ${summary.skittles} skittles down`;
}

/** The number that all objects share, else each with its object's name. */
function perObject(values, digits) {
  const all = Object.entries(values);
  if (all.every(([, value]) => value === all[0][1])) return `${number(all[0][1], digits)} each`;
  return all.map(([name, value]) => `${name} ${number(value, digits)}`).join(', ');
}

function inCondition(value, digits) {
  return typeof value === 'object' ? perObject(value, digits) : value;
}

/** Elasticity, friction, shape or detection: of each version where they differ in it. */
export function conditionInWords(summary, key, digits) {
  if (summary[key] !== null) return inCondition(summary[key], digits);
  return Object.entries(summary.versions).map(([name, version]) =>
    `${name} ${inCondition(version[key], digits)}`).join('; ');
}

/** Elasticity or friction of the skittles with all their digits: of each version where they differ in it. */
export function skittlesInWords(summary, key) {
  if (summary[key] !== null) return String(summary[key].skittle);
  return Object.entries(summary.versions).map(([name, version]) => `${name} ${version[key].skittle}`).join(', ');
}

/** Of a version, all of its condition. */
export function versionInWords(summary, name) {
  const version = summary.versions?.[name];
  if (!version) return '';
  const detection = summary.detection === null ? `, detection ${version.detection}` : '';
  return `elasticity ${inCondition(version.elasticity)}, friction ${inCondition(version.friction)}, shape ${version.shape}${detection}`;
}

/** Energy that is gone [J]; sums of doubles leave some 1e-13 of nothing. */
export function lostEnergy(ledger) {
  return Math.abs(ledger.impact_j) < 1e-9 ? 0 : -ledger.impact_j;
}

/** Balls of each frame in the sheet's own signs, with its strikes and spares. */
export function framesOf(game) {
  const rolls = game.rolls.filter((balls) => balls.length);
  const from = game.sheet.indexOf(': ') + 2;
  const frames = game.sheet.slice(from, game.sheet.lastIndexOf(' = ')).split(' | ');
  return frames.length === rolls.length ? frames : rolls.map((balls) => balls.join(' '));
}

/** "throw 7 (red, 63.200 s): not thrown: the hand closed on nothing" */
export function unpairedInWords({ throw: which, name, time_s: time, why }) {
  return `throw ${which} (${name ? `${name}, ` : ''}${time.toFixed(3)} s): ${why}`;
}

/** Who simulated a trial: the program, or the engine in the page where it was opened there. */
function by(trial) {
  return trial.openedHere ? 'in this page' : 'by the program that made this page';
}

const kCut = 'The log is not complete: it has no end, or messages are missing.';

/** Whether simulating a trial gives what was recorded. */
export function hashInWords(trial) {
  const { hash, rate_hz: rate, trial: log } = trial.json;
  const cut = log.complete ? '' : ` ${kCut}`;
  if (hash.recorded === null) {
    return `The trial holds no states to compare with; simulated ${by(trial)}, it comes to the game hash ${hash.game_replayed}.${cut}`;
  }
  if (hash.first_difference === null) {
    const ticks = `${hash.verified_ticks} recorded ticks`;
    return `Simulated again ${by(trial)}: equal to the bit in ${log.complete ? ticks : `the ${ticks} that are left`}, game hash ${hash.game_replayed}.${cut}`;
  }
  const { tick, body } = hash.first_difference;
  return `Simulated again ${by(trial)}, it differs from what was recorded, first at tick ${tick} (${number(tick / rate, 6)} s)`
    + `${body ? ` in the ${body}` : ''}: recorded state ${hash.recorded}, simulated ${hash.replayed}. Bodies are shown as recorded.${cut}`;
}

/** The header: who, what, how long, and what it came to. */
export function headInWords(trial, again = null) {
  const { trial: t, summary, hash } = trial.json;
  const brief = (text) => (text.length > 120 ? `${text.slice(0, 120)}…` : text);
  const was = hash.recorded === null ? `simulated ${by(trial)}: ` : again ? 'recorded: ' : '';
  return [
    t.participant && `participant ${brief(t.participant)}`, t.condition && `condition ${brief(t.condition)}`,
    brief(t.scenario_name), `${number(t.duration_s, 4)} s`, !t.complete && 'the log is not complete',
    was + resultInBrief(summary),
    again && `simulated again, with what is set below: ${resultInBrief(again.json.summary)}`,
  ].filter(Boolean).join(' · ');
}

/** " 2 throws of the trial have no counterpart: throw 7 (...): ..." */
function lostInWords(lost) {
  if (lost.length === 0) return '';
  const most = 20;
  return ` ${lost.length} ${lost.length > 1 ? 'throws of the trial have' : 'throw of the trial has'} no counterpart: `
    + `${lost.slice(0, most).map(unpairedInWords).join('; ')}${lost.length > most ? ' ...' : ''}.`;
}

/** What the engine in the page came to. */
export function againInWords(trial, set, { json }, milliseconds) {
  const { state_hash: state, game_hash: game, simulated_s: seconds, ticks } = json.summary;
  const pace = `${number(1e3 * seconds / Math.max(milliseconds, 0.1), 3)} times real time`;
  const hashes = `state hash ${state}, game hash ${game}`;
  if (Object.keys(set).length > 0) {
    return `Simulated again: ${resultInBrief(json.summary)}, ${hashes}, ${pace}.${lostInWords(json.throws_without_counterpart)}`;
  }
  const { hash } = trial.json;
  const is = `Simulated again in this page: ${hashes}`;
  if (hash.recorded === null && trial.openedHere) return `${is}; the trial holds no states to compare with; ${ticks} ticks, ${pace}.`;
  const whom = hash.recorded === null ? 'what the program that made this page came to'
    : `the recording${trial.json.trial.complete ? '' : ', as far as it goes'}`;
  const same = game === hash.game_replayed && (hash.recorded === null || hash.first_difference === null);
  return same ? `${is}, equal to the bit with ${whom}; ${ticks} ticks, ${pace}.`
    : `${is}, but not equal to ${whom}${hash.recorded === null ? `, ${hash.game_replayed}` : ''}.`;
}

/** Where two trials part. */
export function firstDifferenceInWords(difference, otherBodies) {
  const others = otherBodies ? 'Of the bodies that both have: ' : '';
  if (difference === null) return `${others}simulated tick by tick, they are equal to the bit.`;
  return `${others}First different tick: ${difference.tick} (${number(difference.time_s, 6)} s)${difference.body ? `, in the ${difference.body}` : ', where the shorter one ends'}.`;
}

/** What does not fit between a video and its trial, by how long both last [s]; empty where they fit. */
export function videoInWords(video, trial) {
  const differ = Math.abs(video - trial) > 0.1;  // the last frame of a slow display ends that much later
  if (!differ) return '';
  const still = video < trial ? ' After its end its last picture stays.' : '';
  return `(The video lasts ${video.toFixed(3)} s, the trial ${trial.toFixed(3)} s. It is shown from the trial's beginning:`
    + ` if it does not begin there, it is not in step with the clock.${still})`;
}

/** The pixels of an eye's picture. The page draws them as if the display had no lens. */
export function eyeInWords({ width, height, pixel_aspect: aspect, lens }) {
  return `${width} × ${height} pixels a picture, each ${number(aspect)} times as wide as high, as the display has them.`
    + (lens ? ' Here the picture is drawn without the distortion of the display\'s lens; headpin frames draws it as it was shown.' : '');
}
