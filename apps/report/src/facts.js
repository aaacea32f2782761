// What is known of a trial, in words and tables.
import { facts, find, make, number, table } from './elements.js';
import { conditionInWords, framesOf, hashInWords, headInWords, lostEnergy, resultInBrief, unpairedInWords, versionInWords } from './words.js';

const kNone = '–';

const kDigits = 3, kMostDigits = 17;  // of a number; more only where fewer hide a difference

const kRows = [
  ['Skittles down', (s) => (s.games.length ? `${s.skittles_down} of all racks`
    : `${s.skittles_down} of ${s.skittles}`)],
  ['Points', (s) => s.games.map(({ name, rules, points }) => `${name ? `${name} ` : ''}${rules} ${points}`).join(', ') || kNone],
  ['Ball at release', (s, digits) => withUnit(s.release_speed_mps, 'm/s', digits)],
  ['Ball at the first skittle', (s, digits) => withUnit(s.impact_speed_mps, 'm/s', digits)],
  ['Elasticity', (s, digits) => conditionInWords(s, 'elasticity', digits)],
  ['Friction', (s, digits) => conditionInWords(s, 'friction', digits)],
  ['Skittles collide as', (s) => conditionInWords(s, 'shape')],
  ['Impulses', (s) => s.response],
  ['Detection', (s) => conditionInWords(s, 'detection')],
  ['Simulated', (s, digits) => `${number(s.simulated_s, Math.max(6, digits))} s, ${s.ticks} ticks`],
  ['Impacts', (s) => number(s.statistics.impacts)],
  ['Deepest overlap', (s, digits) => withUnit(s.statistics.deepest_overlap_m * 1000, 'mm', digits)],
  ['Energy lost in impacts', (s, digits) => withUnit(lostEnergy(s.ledger), 'J', digits)],
  ['State hash', (s) => s.state_hash],
  ['Game hash', (s) => s.game_hash],
];

function withUnit(value, unit, digits) {
  return value === null || value === undefined ? kNone : `${number(value, digits)} ${unit}`;
}

/**
 * What is told of results side by side: [name, words of each, whether they differ]. Values that differ have as many digits as
 * show it.
 */
export function resultRows(summaries) {
  return kRows.map(([name, of]) => {
    const words = (digits) => summaries.map((summary) => of(summary, digits));
    for (let digits = kDigits; digits <= kMostDigits; ++digits) {
      const told = words(digits);
      if (new Set(told).size > 1) return [name, told, true];
    }
    return [name, words(kDigits), false];
  });
}

/** What is not drawn as the trial's eyes saw it. */
export function showMissing({ json }) {
  find('not-as-seen').replaceChildren(...json.missing_meshes.map((sentence) =>
    make('p', { class: 'note' }, sentence)));
}

/** @param columns  [heading, trial] of each, side by side */
export function resultTable(caption, columns) {
  const several = columns.length > 1;
  const whole = table(caption, ['What', ...columns.map(([heading]) => heading), ...(several ? ['Differs'] : [])],
    resultRows(columns.map(([, trial]) => trial.json.summary)).map(([name, told, differs]) => {
      const cells = name.endsWith('hash') ? told.map((hash) => make('code', {}, hash)) : told;
      return [name, ...cells, ...(several ? [differs ? 'yes' : 'no'] : [])];
    }));
  whole.classList.add('whole');
  return whole;
}

export function sheets(summary) {
  return summary.games.map((game) => {
    const frames = framesOf(game);
    const condition = versionInWords(summary, game.name);
    return make('div', {},
      table(`Score sheet: ${game.name ? `${game.name} ` : ''}${game.rules}, ${game.points} points${game.over ? '' : ' (not over)'}`,
        ['Frame', ...frames.map((_, i) => i + 1)],
        [['Skittles', ...frames]]),
      make('p', { class: 'sheet' }, game.sheet),
      condition && make('p', { class: 'note' }, `${game.name} version: ${condition}`));
  });
}

/** What is told of a throw: name, value. Boards count from the right gutter. */
const kOfThrow = [
  ['Board', ({ board }) => fixed(board, 1)],
  ['Angle', ({ launch_angle_deg: angle }) => aside(angle)],
  ['Speed [m/s]', ({ level_speed_mps: speed }) => fixed(speed, 2)],
  ['Revolutions [1/min]', ({ revs_per_min: revs }) => fixed(revs, 0)],
  ['Axis rotation, tilt', ({ axis_rotation_deg: rotation, axis_tilt_deg: tilt }) => `${whole(rotation)}°, ${whole(tilt)}°`],
  ['Touches the lane at [m]', ({ loft_end_m: at }) => fixed(at, 1)],
  ['Hooks from, rolls from [m]', ({ skid_end_m: hooks, hook_end_m: rolls }) => `${fixed(hooks, 1)}, ${fixed(rolls, 1)}`],
  ['Breakpoint', ({ breakpoint_board: board, breakpoint_m: at }) => (known(board) ? `board ${fixed(board, 1)} at ${fixed(at, 1)} m` : kNone)],
  ['Entry', ({ entry_board: board, entry_angle_deg: angle }) => (known(board) ? `board ${fixed(board, 1)}${known(angle) ? `, ${aside(angle)}` : ''}` : kNone)],
  ['Track flare [mm]', ({ flare_mm: flare }) => fixed(flare, 0)],
  ['Touched', ({ touched }) => touched || kNone],
  ['Left', ({ leave, counted }) => leave || (counted ? 'none' : kNone)],
  ['Exit board', ({ exit_board: board, gutter_m: gutter }) => (known(gutter) ? `gutter at ${fixed(gutter, 1)} m` : fixed(board, 1))],
];

const known = (value) => value !== null && value !== undefined;

function fixed(value, digits) {
  return known(value) ? value.toFixed(digits) : kNone;
}

/** Without a sign before 0. */
function whole(value) {
  return known(value) ? Math.round(value) || 0 : kNone;
}

/** "2.0° right" */
function aside(degrees) {
  if (!known(degrees)) return kNone;
  return `${Math.abs(degrees).toFixed(1)}° ${degrees < 0 ? 'left' : 'right'}`;
}

/** The way of each ball, in the words of coaches. Nothing of trials that do not say it. */
export function throwsTable({ throws }) {
  const told = throws.map((one, i) => [i + 1, one]).filter(([, one]) => known(one.board));
  return told.length === 0 ? [] : [table('The ways of the balls; board 1 is at the right gutter, 20 in the middle',
    ['Throw', ...told.map(([i]) => i)],
    kOfThrow.map(([name, of]) => [name, ...told.map(([, one]) => of(one))]))];
}

export function showResult(trial) {
  const { summary, approaches, why_nothing_fell: why } = trial.json;
  find('result-body').replaceChildren(
    make('p', { class: 'verdict', id: 'verdict' }, hashInWords(trial)),
    ...(why ? [make('p', {}, why)] : []),
    ...sheets(summary),
    ...throwsTable(summary),
    ...approaches.map((line) => make('p', {}, line)),
    resultTable('The trial in numbers', [['Value', trial]]));
}

/** The throws of one session that another has not. */
export function unpairedList(heading, throws) {
  return throws.length === 0 ? [] : [make('p', {}, heading),
    make('ul', {}, throws.slice(0, 100).map((one) => make('li', {}, unpairedInWords(one))))];
}

/** Keys of the scenario that differ. */
export function differencesTable(differences, a, b) {
  const brief = (text) => (text.length > 120 ? `${text.slice(0, 120)}…` : text || kNone);
  return differences.length === 0 ? []
    : [table('What differs in the scenario', ['Key', a, b], differences.map((one) => [one.key, brief(one.a), brief(one.b)]))];
}

/** Units of the values of events, as docs/events.md has them; '' of a number alone. */
const kValueUnits = { release: 'm/s', first_contact: 'm/s', touch: 'm/s', ball_touch: 'm/s', hand_touch: 'm/s', missed_grab: 'm',
  foul: 'm', flies_at_player: 's', passed_player: 'm', tracking_lost: 's', tracking_back: 's', paused: 's', imported: 's',
  skittle_down: '', game: '', dead_wood: '', set_again: '', delivery: '', frame: '', game_over: '' };

/** A value of 0 is one where the kind has values: a ball that felled nothing. */
export function valueOf(event) {
  const told = event && (event.value || Object.hasOwn(kValueUnits, event.kind));
  return told ? `${number(event.value)} ${kValueUnits[event.kind] ?? ''}`.trim() : kNone;
}

function impulseOf(event) {
  return Math.hypot(...event.j) ? `${number(Math.hypot(...event.j))} N s` : kNone;
}

/** Indices [i, j] of ticks of two lists, each in order, at most `most` apart: the next of each that are, in turn. */
function pairsInTurn(a, b, most) {
  const pairs = [];
  for (let i = 0, j = 0; i < a.length && j < b.length;) {
    if (Math.abs(a[i] - b[j]) <= most) pairs.push([i++, j++]);
    else if (a[i] < b[j]) ++i;
    else ++j;
  }
  return pairs;
}

/** The same with the nearest first; no pair crosses another. Where very many are near, in turn. */
function nearestPairs(a, b, most) {
  const kMostNear = 100_000;
  const near = [];
  for (let i = 0, from = 0; i < a.length; ++i) {
    while (from < b.length && b[from] < a[i] - most) ++from;
    for (let j = from; j < b.length && b[j] <= a[i] + most; ++j) near.push([Math.abs(b[j] - a[i]), i, j]);
    if (near.length > kMostNear) return pairsInTurn(a, b, most);
  }
  near.sort(([one], [other]) => one - other);
  const pairs = [];  // in order
  for (const [, i, j] of near) {
    let [at, end] = [0, pairs.length];
    while (at < end) {
      const middle = (at + end) >> 1;
      if (pairs[middle][0] < i) at = middle + 1;
      else end = middle;
    }
    const [before, after] = [pairs[at - 1], pairs[at]];
    const crosses = (before && before[1] >= j) || (after && (after[0] === i || after[1] <= j));
    if (!crosses) pairs.splice(at, 0, [i, j]);
  }
  return pairs;
}

/**
 * Events of two trials in one list. What happens to the same bodies in both within a second is one row: the nearest first, each in its order.
 * @param rate  ticks a second of both
 */
export function paired(a, b, rate) {
  const byName = (events) => {
    const all = new Map();
    for (const event of events) {
      const name = [event.kind, ...event.bodies].join();
      if (!all.has(name)) all.set(name, []);
      all.get(name).push(event);
    }
    for (const alike of all.values()) alike.sort((one, other) => one.tick - other.tick);
    return all;
  };
  const partner = new Map();  // event of a -> event of b
  const others = byName(b);
  for (const [name, alike] of byName(a)) {
    const there = others.get(name) ?? [];
    const ticks = (events) => events.map(({ tick }) => tick);
    for (const [i, j] of nearestPairs(ticks(alike), ticks(there), rate)) partner.set(alike[i], there[j]);
  }
  const taken = new Set(partner.values());
  const rows = a.map((event) => (partner.has(event) ? { a: event, b: partner.get(event) } : { a: event }));
  const tick = ({ a: one, b: other }) => Math.min(one?.tick ?? Infinity, other?.tick ?? Infinity);
  return rows.concat(b.filter((event) => !taken.has(event)).map((event) => ({ b: event }))).sort((one, other) => tick(one) - tick(other));
}

/**
 * @param other  the trial that is compared; null without one
 * @param names  of both trials
 * @return       marks the row of the last event up to a tick, and brings it into the table's view
 */
export function showEvents(trial, go, other = null, names = []) {
  const { events: all, event_kinds: kinds } = trial.json;
  const most = 2000;
  const entries = other ? paired(all, other.json.events, trial.rate) : all.map((a) => ({ a }));
  const shown = entries.slice(0, most);
  const at = (event) => (event ? make('button', { type: 'button', class: 'link', onclick: () => go(Math.max(0, event.tick)) },
    `${event.time_s.toFixed(3)} s`) : kNone);
  const what = ({ kind }) => make('span', { title: kinds[kind] ?? '' }, kind.replaceAll('_', ' '));
  const bodies = (event) => event.bodies.concat(event.known || []).join(', ')
    || (event.detail.startsWith('{') ? '' : event.detail);
  const [a, b] = names;
  find('events-body').replaceChildren(
    ...(entries.length > most ? [make('p', { class: 'note' }, `The first ${most} of ${entries.length}.`)] : []),
    other
      ? table('Events of both; click a time to go there', [`Time, ${a}`, `Time, ${b}`, 'What', 'To what', `Value, ${a}`, `Value, ${b}`],
        shown.map((row) => [at(row.a), at(row.b), what(row.a ?? row.b), bodies(row.a ?? row.b), valueOf(row.a), valueOf(row.b)]))
      : table('Events; click a time to go there', ['Time', 'Tick', 'What', 'To what', 'Value', 'Impulse'],
        shown.map(({ a: event }) => [at(event), event.tick < 0 ? kNone : event.tick, what(event), bodies(event), valueOf(event), impulseOf(event)])));
  const rows = [...find('events-body').querySelectorAll('tbody tr')];
  const ticks = shown.map((row) => Math.min(...[row.a, row.b].filter(Boolean).map(({ tick }) => (tick < 0 ? Infinity : tick))));
  const scroll = find('events-body').querySelector('.scroll');
  let marked = null;
  return (tick) => {
    const row = rows[ticks.findLastIndex((one) => one <= tick)] ?? null;
    if (row === marked) return;
    marked?.removeAttribute('aria-current');
    row?.setAttribute('aria-current', 'true');
    marked = row;
    if (!row) return;
    const head = rows[0].parentElement.previousElementSibling.offsetHeight;
    const above = row.offsetTop - head - scroll.scrollTop;
    const below = row.offsetTop + row.offsetHeight - scroll.clientHeight - scroll.scrollTop;
    if (above < 0) scroll.scrollTop += above;
    else if (below > 0) scroll.scrollTop += below;
  };
}

export function showDevices(trial) {
  const { devices, skipped, trouble, backwards, late, complete } = trial.json.trial;
  const amiss = Object.entries(skipped).filter(([, count]) => count > 0);
  find('devices-body').replaceChildren(
    table('Samples of each device', ['Device', 'Samples', 'Rate', 'Longest gap', 'Lost', 'Bad'],
      devices.map((d) => [d.device, d.samples, d.device === '3D mouse' ? kNone : `${number(d.rate_hz, 5)} Hz`,
        `${number(d.longest_gap_s)} s`, d.lost, d.bad])),
    make('p', {}, complete ? 'The log is complete.'
      : 'The log is not complete: it has no end, or messages are missing.'),
    ...(amiss.length || backwards || late ? [make('p', {}, `Not used: ${[
      ...amiss.map(([kind, count]) => `${count} ${kind.replaceAll('_', ' ')}`),
      ...(backwards ? [`${backwards} samples not later than the one before (kept)`] : []),
      ...(late ? [`${late} samples that came late (kept)`] : [])].join(', ')}.`)] : []),
    ...(trouble.length ? [table('Problems in the recording', ['What', 'Of', 'Messages', 'From', 'To'],
      trouble.map((t) => [t.kind, t.device, t.messages, `${number(t.from_s, 6)} s`, `${number(t.to_s, 6)} s`]))] : []));
}

export function showProvenance(trial, about) {
  const { trial: t, drawn, hash, rate_hz: rate } = trial.json;
  const notes = [];
  if (drawn.every > 1) notes.push(`Of this long trial every ${drawn.every}th of ${drawn.last_tick} ticks is drawn; poses between them are interpolated.`);
  if (drawn.contacts_left_out) notes.push(`The ${drawn.contacts_left_out} weakest impulses are left out.`);
  if (about.log_left_out) notes.push('The log itself is too long to be in the page.');
  find('provenance-body').replaceChildren(
    facts([
      ['Trial', t.name], ['Participant', t.participant || kNone], ['Condition', t.condition || kNone],
      ['Seed', t.seed], ['Scenario', t.scenario_name], ['Length', `${number(t.duration_s, 6)} s, ${rate} ticks a second`],
      ['Recorded by', `headpin ${t.version || '?'} (${t.commit || 'no commit'}), format ${t.format_version}`],
      ['State hash, simulated', make('code', { id: 'hash' }, hash.replayed)],
      ['State hash, recorded', make('code', {}, hash.recorded ?? kNone)],
      ['Game hash, simulated', make('code', { id: 'game-hash' }, hash.game_replayed)],
      ['Game hash, recorded', make('code', {}, hash.game_recorded ?? kNone)],
      ['Page made by', `headpin ${about.version} (${about.commit || 'no commit'})`],
      ['Command', make('code', {}, about.command)]]),
    make('div', { id: 'left-out' }, notes.map((note) => make('p', { class: 'note' }, note))),
    make('details', {}, make('summary', {}, 'The whole scenario'),
      make('pre', { tabindex: 0, role: 'region', 'aria-label': 'Scenario' }, t.scenario)));
}

/**
 * @param again  what is shown in place of the trial or with it; null for none
 * @param other  a second trial that the page has; null without one
 */
export function showHead(trial, again, other = null) {
  const brief = ({ json: { trial: { name } } }) => (name.length > 120 ? `${name.slice(0, 120)}…` : name);
  document.title = `${brief(trial)} – headpin`;
  find('title').textContent = other ? `A: ${brief(trial)}, B: ${brief(other)}` : brief(trial);
  find('subtitle').textContent = headInWords(trial, again)
    + (other ? ` · B: ${resultInBrief(other.json.summary)}` : '');
  for (const [id, heading] of [['events', 'Events'], ['plots', 'Over time']]) {
    find(`${id}-heading`).textContent = again ? `${heading}, simulated again` : heading;
  }
  find('result-heading').textContent = again ? 'Result, as in the trial, and simulated again' : 'Result';
  find('video-caption').textContent = again
    ? 'What both eyes saw of the trial, not of what is simulated again' : 'What both eyes saw';
}
