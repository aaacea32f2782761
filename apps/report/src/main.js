// The page: one clock, and everything that shows a trial at its time.
import { Again, pageCommand } from './again.js';
import { Clock } from './clock.js';
import { block, hasBlock, jsonBlock, numbersOf } from './data.js';
import { find, make } from './elements.js';
import { differencesTable, resultTable, showDevices, showEvents, showHead, showMissing, showProvenance, showResult, sheets, unpairedList } from './facts.js';
import { listen } from './keys.js';
import { Plots } from './plots.js';
import { Timeline } from './timeline.js';
import { Trial } from './trial.js';
import { Video } from './video.js';
import { openView } from './view.js';
import { showWhatIf } from './whatif.js';
import { eyeInWords, firstDifferenceInWords } from './words.js';

async function trialOf(which) {
  const json = await jsonBlock(`json${which}`);
  return new Trial(json, numbersOf(await block(`numbers${which}`), json.sections));
}

/** What two trials have in common and what not. */
function showCompared(trial, other, about) {
  const { first_difference: difference, bodies_only_in_a: onlyA, bodies_only_in_b: onlyB } = about;
  const [a, b] = [trial, other].map(({ json }) => json.trial.name.slice(0, 80));
  find('compared').hidden = false;
  const go = difference && make('button', { type: 'button', onclick: () => page.clock.go(difference.tick) }, 'Go there');
  const others = [[a, onlyA], [b, onlyB]].filter(([, names]) => names.length > 0);
  find('compared-body').replaceChildren(
    ...others.map(([name, bodies]) => make('p', {}, `Other bodies: only ${name} has ${bodies.join(', ')}.`)),
    make('p', { id: 'first-difference' }, firstDifferenceInWords(difference, others.length > 0), ' ', go ?? ''),
    ...differencesTable(about.scenario_differences, a, b),
    ...unpairedList(`Throws of ${a} that have no counterpart in ${b}:`, about.only_thrown_in_a),
    ...unpairedList(`Throws of ${b} that have no counterpart in ${a}:`, about.only_thrown_in_b),
    resultTable('Both in numbers', [[a, trial], [b, other]]),
    ...(other.json.summary.games.length ? [make('p', {}, `Score sheets of ${b}:`), ...sheets(other.json.summary)] : []));
}

function controls(page) {
  const { view, clock, timeline } = page;
  find('modes').addEventListener('change', (event) => page.setMode(event.target.value));
  find('pair').addEventListener('change', (event) => page.showPair(event.target.value));
  find('from').addEventListener('change', (event) => view.orbit.look(event.target.value));
  find('layers').addEventListener('change', (event) => {
    view.layers[event.target.value] = event.target.checked;
    view.draw();
  });
  listen({
    toggle: () => clock.toggle(),
    step: (ticks) => clock.step(ticks),
    tenth: () => Math.round(clock.rate / 10),
    go: (tick) => { clock.pause(); clock.go(tick); },
    event: (direction) => timeline.toEvent(direction),
    faster: (steps) => clock.faster(steps),
    mode: (mode) => { find('modes').querySelector(`[value=${mode}]`).checked = true; page.setMode(mode); },
    pair: () => page.nextOfPair(),
    layer: (name) => find('layers').querySelector(`[value=${name}]`).click(),
    orbit: (key) => view.orbit.key(key),
  });
}

/** Links to the panels that are there. */
function listPanels() {
  const panels = [...document.querySelectorAll('#panels > section:not([hidden])')];
  find('jump').replaceChildren(...panels.map((panel) =>
    make('a', { href: `#${panel.id}` }, panel.querySelector('h2').dataset.brief ?? panel.querySelector('h2').textContent)));
}

class Page {
  async open() {
    this.about = await jsonBlock('about');
    this.trial = await trialOf('');
    this.clock = new Clock(this.trial.lastTick, this.trial.rate);
    this.other = hasBlock('json-other') ? await trialOf('-other') : null;
    if (this.other?.json.meshes.length === 0) this.other.looksLike = this.trial;
    this.view = openView(find('view'), this.trial, this.other);
    this.timeline = new Timeline(this.clock);
    this.clock.onChange(() => this.view.show(this.clock.tick));
    this.clock.onChange(() => this.markEvent?.(this.clock.tick));
    this.view.drawNow(true);
    performance.mark('first picture');
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    this.view.addOverlays();
    this.plots = new Plots(this.clock);
    this.video = new Video(this.clock, this.about, this.trial.seconds(this.trial.lastTick));
    controls(this);
    this.show(this.trial, null, this.other);
    if (this.other) {
      this.nameOther('B (blue)');
      showCompared(this.trial, this.other, this.about);
    }
    await showWhatIf();
    listPanels();
    document.documentElement.dataset.ready = 'yes';
    this.again = new Again((again, which) => this.showAgain(again, which), (trial) => this.openTrial(trial));
    await this.again.start(this.trial);
    listPanels();
    document.documentElement.dataset.engine = this.again.engine ? 'yes' : 'no';
  }

  /**
   * All of the page but the 3D view, of the trial that is shown.
   * @param beside  the trial that is compared with it; null without one
   * @param names   of both
   */
  show(trial, again = null, beside = null, names = ['A', 'B']) {
    this.clock.reset(Math.max(trial.lastTick, beside?.lastTick ?? 0), trial.rate);
    showHead(this.trial, again, this.other);
    showResult(this.trial);
    this.markEvent = showEvents(trial, (tick) => { this.clock.pause(); this.clock.go(tick); }, beside, names);
    this.markEvent(this.clock.tick);
    showMissing(this.trial);
    showDevices(this.trial);
    showProvenance(this.trial, this.about);
    this.timeline.load(trial);
    this.plots.load(trial, beside, names);
    this.describe();
  }

  describe() {
    if (this.view.why) {
      for (const id of ['modes', 'layers', 'from-field']) find(id).hidden = true;
      find('seen').textContent = `No picture: this browser cannot draw in 3D (${this.view.why}). It needs WebGL 2. `
        + 'All else on this page works; headpin frames draws what the eyes saw.';
      return;
    }
    const what = { around: 'the room from outside', left: 'what the left eye sees', right: 'what the right eye sees',
      both: 'what both eyes see' }[this.view.mode];
    find('view').setAttribute('aria-label', `3D view: ${what}. Keys are listed at the end of the page.`);
    find('seen').textContent = this.view.mode === 'around'
      ? 'Drag to turn, with Shift to slide; click, or hold Ctrl, and turn the wheel to come nearer. With fingers: two turn, and pinch. Keys: w a s d r f. Trails: head orange, hand green, ball blue.'
      : eyeInWords(this.view.trial.json.eyes[0]);
    find('from').disabled = this.view.mode !== 'around';
  }

  setMode(mode) {
    this.view.setMode(mode);
    this.describe();
  }

  nameOther(name) {
    find('other-layer').hidden = name === null;
    if (name !== null) find('other-layer').querySelector('span').textContent = name;
  }

  /** Of two trials the first, the second, or both. */
  showPair(which) {
    if (!this.other) return;
    find('pair').querySelector(`[value=${which}]`).checked = true;
    this.again?.leave();
    const shown = which === 'b' ? this.other : this.trial;
    const beside = which === 'both' ? this.other : null;
    this.view.load(shown, beside);
    this.nameOther(beside && 'B (blue)');
    this.show(shown, null, beside);
    this.view.show(this.clock.tick);
  }

  /** Goes on from the first trial to the second, to both: of two trials, or of one and what was simulated again. */
  nextOfPair() {
    const buttons = [...find(this.other ? 'pair' : 'shown').querySelectorAll('input')];
    const next = buttons[(buttons.findIndex(({ checked }) => checked) + 1) % buttons.length];
    next.checked = true;
    next.dispatchEvent(new Event('change', { bubbles: true }));
  }

  /** The trial, what the engine made of it, or both. */
  showAgain(again, which) {
    const shown = again && which === 'again' ? again : this.trial;
    this.view.load(shown, which === 'both' && again ? again : which === 'again' ? null : this.other);
    this.nameOther(which === 'both' ? 'Simulated again (blue)' : this.other && which !== 'again' ? 'B (blue)' : null);
    const shownAgain = again && which !== 'recorded' ? again : null;
    if (which === 'both' && again) this.show(shown, shownAgain, again, ['trial', 'again']);
    else this.show(shown, shownAgain, shownAgain ? null : this.other);
    for (const button of find('pair').querySelectorAll('input')) button.checked = !shownAgain && button.value === 'both';
    if (shownAgain) {
      find('result-body').append(...differencesTable(again.json.scenario_differences, 'the trial', 'again'),
        ...unpairedList('Throws of the trial that have no counterpart here:', again.json.throws_without_counterpart),
        resultTable('Simulated again', [['the trial', this.trial], ['again', again]]));
    }
    this.view.show(this.clock.tick);
  }

  openTrial(trial) {
    this.trial = trial;
    this.other = null;
    find('compared').hidden = true;
    find('whatif').hidden = true;
    find('video').hidden = true;
    this.about = { ...this.about, command: pageCommand(trial.json.trial.name), log_left_out: false };
    this.view.load(trial, null);
    this.nameOther(null);
    this.show(trial);
    listPanels();
    this.view.show(this.clock.tick);
  }
}

const page = new Page();
window.headpin = page;  // for those who look from the console, and for tests
page.open().catch((error) => {
  find('trouble').hidden = false;
  find('trouble').textContent = `This page cannot show the trial: ${error.message}`;
  throw error;
});
