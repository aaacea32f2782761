// Simulating the trial again in the page, under a condition that the reader sets.
import { rawBlock, hasBlock, inflated } from './data.js';
import { find, make } from './elements.js';
import * as engines from './engine.js';
import { againInWords, skittlesInWords } from './words.js';

/** Of one version of the game, where they differ in it: the red one. */
function first(summary, key) {
  return summary[key] ?? summary.versions.red[key];
}

function shellWord(name) {
  return /^[\w./-]+$/.test(name) && !name.startsWith('-') ? name : `'./${name.replaceAll("'", "'\\''")}'`;
}

/** The command that makes a page of a trial's file. */
export function pageCommand(name) {
  return `headpin report ${shellWord(name)} -o trial.html`;
}

/** The command that reads a file which is no trial. */
export function howToReadIt(name) {
  return name.toLowerCase().endsWith('.lcmlog') ? `; what is in it: headpin info ${shellWord(name)}`
    : `; a recording of trackers becomes a trial by: headpin import ${shellWord(name)} -o throw.lcmlog`;
}

export class Again {
  /** @param show  told of every simulation: show(again, which), `again` null for none */
  constructor(show, openTrial) {
    this.show = show;
    this.openTrial = openTrial;
    this.again = null;
    this.running = false;
    this.wanted = false;
    this.told = 'recorded';
    for (const id of ['elasticity', 'friction']) {
      find(id).addEventListener('input', () => this.moved(id));
    }
    for (const id of ['shape', 'response']) find(id).addEventListener('change', () => this.moved(id));
    find('unmoved').addEventListener('click', () => this.unmove());
    find('condition').addEventListener('submit', (event) => event.preventDefault());
    find('shown').addEventListener('change', () => this.tell());
    find('drop').addEventListener('change', (event) => this.openFile(event.target.files[0]));
    document.addEventListener('dragover', (event) => event.preventDefault());
    document.addEventListener('drop', (event) => {
      event.preventDefault();
      this.openFile(event.dataTransfer.files[0], event);
    });
    find('dropped').querySelector('button').addEventListener('click', () => { find('dropped').hidden = true; });
  }

  /** What went wrong with a file: under the engine's heading, and where the file was dropped. */
  refuse(text, where) {
    this.say(text);
    if (!where) return;
    const box = find('dropped');
    box.querySelector('p').textContent = text;
    box.hidden = false;
    const place = (at, size, room) => `${Math.max(8, Math.min(at, room - size - 8))}px`;
    box.style.left = place(where.clientX, box.offsetWidth, innerWidth);
    box.style.top = place(where.clientY, box.offsetHeight, innerHeight);
  }

  say(text) {
    find('again-status').textContent = text;
  }

  /** Starts the engine where the page has it; without, the page shows what is recorded. */
  async start(trial) {
    if (!engines.isThere()) return;
    this.trial = trial;
    find('again').hidden = false;
    this.setControls(trial);
    if (!hasBlock('log')) {
      this.say('The log of this trial is too long to be in the page: drop its file here to simulate it again.');
    }
    this.starting = this.load();
    await this.starting;
    if (hasBlock('log') && this.trial === trial) await this.simulate();
  }

  /** The engine, and the log of the page in it: a file that is opened meanwhile waits. */
  async load() {
    const engine = await engines.Engine.start();
    if (hasBlock('log')) await engine.load(await inflated(rawBlock('log')));
    this.engine = engine;
  }

  setControls(trial) {
    const { summary, responses } = trial.json;
    find('response').replaceChildren(...responses.map(({ name, keeps }) =>
      make('option', { value: name, title: keeps }, name)));
    this.set = {};
    find('elasticity').value = first(summary, 'elasticity').skittle;  // that of all unless objects differ
    find('friction').value = first(summary, 'friction').skittle;
    find('shape').value = first(summary, 'shape');
    find('of-versions').hidden = summary.versions === null;
    find('response').value = summary.response;
    this.label();
  }

  label() {
    for (const id of ['elasticity', 'friction']) {
      find(id).parentElement.querySelector('output').textContent = id in this.set ? String(this.set[id])
        : skittlesInWords(this.trial.json.summary, id);  // the slider itself rounds it to its steps
    }
  }

  moved(id) {
    const { value } = find(id);
    this.set[id] = id === 'elasticity' || id === 'friction' ? Number(value) : value;
    this.label();
    if (find('shown').querySelector(':checked').value === 'recorded') {
      find('shown').querySelector('[value=again]').checked = true;
    }
    return this.simulate();
  }

  unmove() {
    this.setControls(this.trial);
    return this.simulate();
  }

  /** One at a time; what was set meanwhile is simulated next. */
  async simulate() {
    if (!this.engine) return;
    this.wanted = true;
    if (this.running) return;
    this.running = true;
    try {
      while (this.wanted) {
        this.wanted = false;
        const set = { ...this.set }, of = this.trial;
        const { trial, milliseconds } = await this.engine.simulate(set);
        if (of !== this.trial) continue;  // another file was opened, and is simulated next
        trial.looksLike = of;
        this.again = trial;
        this.say(againInWords(this.trial, set, trial, milliseconds));
      }
    } catch (error) {
      this.say(`The engine: ${error.message}`);
    }
    this.running = false;
    this.tell();
  }

  tell() {
    const which = find('shown').querySelector(':checked').value;
    if (which === 'recorded' && this.told === 'recorded') return;
    this.told = which;
    this.show(this.again, which);
  }

  /** Another trial is shown than this one or what was simulated again. */
  leave() {
    find('shown').querySelector('[value=recorded]').checked = true;
    this.told = 'recorded';
  }

  /** @param where  the event that dropped it; none where it was chosen */
  async openFile(file, where) {
    if (!file) return;
    find('dropped').hidden = true;
    if (!engines.isThere()) {
      this.refuse(`${file.name}: this page has no engine to open it with. A page of its own: ${pageCommand(file.name)}`, where);
      return;
    }
    this.say(`Opening ${file.name}`);
    try {
      await this.starting;
      const bytes = new Uint8Array(await file.arrayBuffer());
      const trial = await this.engine.openTrial(bytes);
      trial.json.trial.name = file.name;
      trial.openedHere = true;
      this.trial = trial;
      this.again = null;
      this.setControls(trial);
      find('shown').querySelector('[value=recorded]').checked = true;
      this.openTrial(trial);
      await this.simulate();
    } catch (error) {
      // The engine calls every log `trial`.
      this.refuse(`${file.name}: ${error.message.replace(/^trial: /, '')}${howToReadIt(file.name)}`, where);
    }
  }
}
