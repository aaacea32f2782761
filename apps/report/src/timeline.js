// The timeline: play, step and scrub, with the trial's events as marks to go to.
import { kSpeeds } from './clock.js';
import { find, make } from './elements.js';

const kColours = {
  grab: '--mark-hand', release: '--mark-hand', first_contact: '--mark-contact',
  skittle_down: '--mark-down', version: '--mark-other', flies_at_player: '--mark-other',
  tracking_lost: '--mark-other', tracking_back: '--mark-other',
};

export class Timeline {
  constructor(clock) {
    this.clock = clock;
    for (const speed of kSpeeds) {
      find('speed').append(make('option', { value: speed }, `${speed} ×`));
    }
    find('speed').value = '1';
    find('speed').addEventListener('change', (event) => clock.setSpeed(Number(event.target.value)));
    find('scrub').addEventListener('input', (event) => {
      clock.pause();
      clock.go(Number(event.target.value));
    });
    const buttons = { first: () => clock.go(0), previous: () => this.toEvent(-1), back: () => clock.step(-1),
      play: () => clock.toggle(), forward: () => clock.step(1), next: () => this.toEvent(1) };
    for (const [id, action] of Object.entries(buttons)) find(id).addEventListener('click', action);
    clock.onChange(() => this.show());
  }

  load(trial) {
    this.trial = trial;
    find('scrub').max = this.clock.lastTick;
    this.events = trial.json.events.filter((event) => event.tick >= 0 && event.kind !== 'ledger');
    const share = (event) => `${(100 * event.tick) / Math.max(1, this.clock.lastTick)}%`;
    find('marks').replaceChildren(...this.events.slice(0, 1000).map((event) => {
      const words = `${event.kind.replaceAll('_', ' ')} ${event.bodies.join(', ')}`;
      const mark = make('span', { class: 'mark', title: `${event.time_s.toFixed(3)} s: ${words}`,
        onclick: () => this.clock.go(event.tick) });
      mark.style.left = share(event);
      mark.style.setProperty('--colour', `var(${kColours[event.kind] ?? '--mark-minor'})`);
      if (!kColours[event.kind]) mark.classList.add('minor');
      return mark;
    }));
    this.show();
  }

  /** To the next event, or the one before. */
  toEvent(direction) {
    const now = Math.round(this.clock.tick);
    const ticks = this.events.map((event) => event.tick);
    const to = direction > 0 ? ticks.find((tick) => tick > now) : ticks.findLast((tick) => tick < now);
    this.clock.pause();
    if (to !== undefined) this.clock.go(to);
  }

  show() {
    if (!this.trial) return;
    const { tick, lastTick, playing, speed } = this.clock;
    const seconds = this.trial.seconds(tick);
    find('scrub').value = Math.round(tick);
    find('scrub').setAttribute('aria-valuetext', `${seconds.toFixed(3)} seconds, tick ${Math.round(tick)}`);
    find('time').textContent = `${seconds.toFixed(3)} s of ${this.trial.seconds(lastTick).toFixed(3)} s · tick ${Math.round(tick)}`;
    find('play').textContent = playing ? 'Pause' : 'Play';
    find('speed').value = String(speed);
    const last = this.events.findLast((event) => event.tick <= tick);
    find('nearest').textContent = last
      ? `Last event: ${last.kind.replaceAll('_', ' ')} ${last.bodies.join(', ')} at ${last.time_s.toFixed(3)} s`.slice(0, 200)
      : 'No event yet';
  }
}
