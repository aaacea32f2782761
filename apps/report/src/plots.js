// Numbers over time: each as a plot, and as a table.
import uPlot from 'uplot';

import { csvOf } from './csv.js';
import { thinned } from './curves.js';
import { find, make, number, table } from './elements.js';

const kMostRows = 400;    // of a table
const kDashes = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 5], [1, 4]];
const kMarkers = ['solid', 'dashed', 'dotted', 'dashed', 'dashed', 'dotted'];  // the nearest that CSS has

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** What is plotted of a trial: name, unit, times, curves. */
export function chartsOf(trial) {
  const times = trial.rowTimes();
  const series = (column) => trial.column('series', column);
  const ledger = ['gravity', 'hand', 'impact', 'sustained', 'correction'];
  const energies = ledger.map((phase) => series(`${phase}_j`));
  const charts = [
    { name: 'Speed', unit: 'm/s', times, curves: [['ball', series('ball_mps')],
      ['fastest skittle', series('skittle_mps')], ['hand', series('hand_mps')]] },
    { name: 'Energy ledger: what each phase has added', unit: 'J', times, curves: [
      ...ledger.map((phase, i) => [phase, energies[i]]),
      ['all', times.map((_, row) => energies.reduce((sum, energy) => sum + energy[row], 0))]] },
    { name: 'Contact points', unit: '', times, curves: [['points', series('contacts')]] },
  ];
  const contacts = trial.sections.get('contacts');
  if (contacts.rows) {
    const j = ['jx', 'jy', 'jz'].map((axis) => trial.column('contacts', axis));
    const at = trial.column('contacts', 'tick').map((tick) => trial.seconds(tick));
    charts.push({ name: 'Impulses', unit: 'N s', points: true, times: at,
      curves: [['impulse', j[0].map((x, i) => Math.hypot(x, j[1][i], j[2][i]))]] });
    charts.push({ name: 'Speed of approach at contacts', unit: 'm/s', points: true, times: at,
      curves: [['approach', trial.column('contacts', 'approach_mps')]] });
  }
  for (const name of trial.sections.keys()) {
    if (!name.startsWith('clock ') || !trial.sections.get(name).rows) continue;
    const host = trial.column(name, 'host_after_s').map((seconds) => 1e3 * seconds);
    const tick = trial.column(name, 'tick_after_s').map((seconds) => 1e3 * seconds);
    charts.push({ name: `Clocks of ${name.slice(6)}: how long after the device's time`, unit: 'ms', points: true,
      times: trial.column(name, 'device_s'),
      curves: [...(host.some((ms) => ms !== 0) ? [['at the host', host]] : []), ['in a tick', tick]] });
  }
  return charts;
}

/**
 * Columns of two tables by their first one, the time: rows of equal times become one row, in turn where several rows of a table
 * have the same time. (uPlot.join keeps one row a time.)
 */
export function joined(a, b) {
  const out = Array.from({ length: a.length + b.length - 1 }, () => []);
  const [n, m] = [a[0].length, b[0].length];
  for (let i = 0, j = 0; i < n || j < m;) {
    const time = Math.min(i < n ? a[0][i] : Infinity, j < m ? b[0][j] : Infinity);
    const [ofA, ofB] = [i < n && a[0][i] === time, j < m && b[0][j] === time];
    out[0].push(time);
    for (let k = 1; k < a.length; ++k) out[k].push(ofA ? a[k][i] : null);
    for (let k = 1; k < b.length; ++k) out[a.length + k - 1].push(ofB ? b[k][j] : null);
    i += ofA;
    j += ofB;
  }
  return out;
}

/** Two charts as one: a colour for each trial, a dash for each curve. */
function together(chart, other, names) {
  const columns = ({ times, curves }) => [times, ...curves.map(([, values]) => values)];
  const [times, ...values] = joined(columns(chart), columns(other));
  const lines = [chart, other].flatMap((one, who) => one.curves.map(([name], which) => ({ name: `${name}, ${names[who]}`, who, which })));
  return { ...chart, times, curves: lines.map(({ name }, i) => [name, values[i]]), lines,
    plotted: joined(thinned(chart), thinned(other)) };
}

/** The charts of a trial, or of two over each other. A chart that one trial alone has is together with an empty one. */
export function chartsOfBoth(trial, other, names) {
  const charts = chartsOf(trial);
  if (!other) return charts;
  const others = new Map(chartsOf(other).map((chart) => [chart.name, chart]));
  const empty = (chart) => ({ ...chart, times: [], curves: chart.curves.map(([name]) => [name, []]) });
  const both = charts.map((chart) => together(chart, others.get(chart.name) ?? empty(chart), names));
  for (const { name } of charts) others.delete(name);
  return both.concat([...others.values()].map((chart) => together(empty(chart), chart, names)));
}

function tableOf(chart) {
  const rows = chart.times.length;
  const every = Math.max(1, Math.ceil(rows / kMostRows));
  const lines = [];
  for (let row = 0; row < rows; row += every) {
    lines.push([`${chart.times[row].toFixed(4)} s`, ...chart.curves.map(([, values]) => number(values[row], 4))]);
  }
  const caption = `${chart.name}${chart.unit ? ` (${chart.unit})` : ''}${every > 1 ? `, every ${every}th of ${rows} rows` : ''}`;
  return table(caption, ['Time', ...chart.curves.map(([name]) => name)], lines);
}

/** The numbers of a plot as a file. */
function saveCsv(chart) {
  const rows = Array.from(chart.times, (time, row) => [time, ...chart.curves.map(([, values]) => values[row])]);
  const text = csvOf(['time_s', ...chart.curves.map(([name]) => name)], rows);
  const link = make('a', { href: URL.createObjectURL(new Blob([text], { type: 'text/csv' })),
    download: `${chart.name.split(':')[0].toLowerCase().replaceAll(' ', '_')}.csv` });
  link.click();
  URL.revokeObjectURL(link.href);
}

export class Plots {
  constructor(clock) {
    this.clock = clock;
    this.plots = [];
    clock.onChange(() => this.mark());
    new ResizeObserver(() => this.fit()).observe(find('plots-body'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.load(...this.loaded));
  }

  /** @param other  the trial that is compared; null without one */
  load(trial, other = null, names = []) {
    this.trial = trial;
    this.loaded = [trial, other, names];
    const open = new Set(this.plots.filter(({ details }) => details.open).map(({ name }) => name));
    for (const { plot } of this.plots) plot.destroy();
    find('plots-body').replaceChildren();
    const charts = this.charts = chartsOfBoth(trial, other, names);
    const ends = charts.flatMap(({ times }) => [times[0], times[times.length - 1]]).filter(Number.isFinite);
    const range = [Math.min(0, ...ends), Math.max(trial.seconds(trial.lastTick), other ? other.seconds(other.lastTick) : 0, ...ends)];
    this.plots = charts.map((chart) => this.add(chart, range, open.has(chart.name)));
    this.fit();
  }

  /**
   * @param range  of the time axis, the same in all plots [s]
   * @param open   whether its table is open
   */
  add(chart, range, open) {
    const unit = chart.unit ? ` [${chart.unit}]` : '';
    const holder = make('div', { class: 'plot', role: 'img',
      'aria-label': `${chart.name}${unit} over time: ${chart.curves.map(([name]) => name).join(', ')}. The table below has the numbers.` });
    const line = make('div', { class: 'now' });
    const details = make('details', {}, make('summary', {}, 'As a table'));
    const fill = () => {
      if (details.open && details.children.length === 1) {
        details.append(tableOf(chart), make('button', { type: 'button', onclick: () => saveCsv(chart) }, 'Save all rows as CSV'));
      }
    };
    details.addEventListener('toggle', fill);
    details.open = open;
    fill();
    find('plots-body').append(make('figure', { class: 'chart' },
      make('figcaption', {}, `${chart.name}${unit}`), holder, details));
    const lines = chart.lines ?? chart.curves.map(([name], which) => ({ name, who: -1, which }));
    const colour = (who, which) => style(`--curve-${who < 0 ? which : 1 - who}`);  // the second trial is blue, as in the picture
    const axis = { stroke: style('--text'), grid: { stroke: style('--grid'), width: 1 }, ticks: { stroke: style('--line') }, font: '13px system-ui, sans-serif' };
    const plot = new uPlot({
      width: 400, height: 220, cursor: { drag: { x: false, y: false }, sync: { key: 'time' } },
      // Marked as its curve is drawn; under the pointer with its value.
      legend: { live: true, markers: { width: 3, fill: () => 'transparent',
        dash: (_, i) => kMarkers[lines[i - 1]?.which] ?? 'solid' } },
      scales: { x: { time: false, range } },
      axes: [{ ...axis, label: 's', labelSize: 18, labelFont: axis.font }, { ...axis, size: 60 }],
      series: [{ label: 'time', value: (_, at) => (at === null ? '' : `${at.toFixed(3)} s`) }, ...lines.map(({ name, who, which }) => ({
        label: name, stroke: colour(who, which), width: 1.75, dash: kDashes[which], spanGaps: Boolean(chart.lines),
        value: (_, value) => (value === null || value === undefined ? '' : `${number(value, 4)} ${chart.unit}`),
        points: { show: Boolean(chart.points), size: 4, fill: colour(who, which) },
        paths: chart.points ? () => null : undefined,
      }))],
    }, chart.plotted ?? thinned(chart), holder);
    plot.over.append(line);
    plot.over.addEventListener('click', (event) => {
      const seconds = plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, 'x');
      this.clock.pause();
      this.clock.go(Math.round(seconds * this.trial.rate));
    });
    return { plot, holder, line, details, name: chart.name };
  }

  fit() {
    for (const { plot, holder } of this.plots) {
      const width = holder.clientWidth;
      if (width > 0 && width !== plot.width) plot.setSize({ width, height: 220 });
    }
    this.mark();
  }

  /** The clock's time in every plot. */
  mark() {
    if (!this.trial) return;
    const seconds = this.trial.seconds(this.clock.tick);
    for (const { plot, line } of this.plots) {
      line.style.transform = `translateX(${plot.valToPos(seconds, 'x')}px)`;
    }
  }
}
