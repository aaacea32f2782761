// The one clock of the page: a tick that everything shows, played or moved by hand.

export const kSpeeds = [0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Clock {
  constructor(lastTick, rate) {
    this.reset(lastTick, rate);
    this.playing = false;
    this.speed = 1;
    this.listeners = [];
  }

  reset(lastTick, rate) {
    this.lastTick = lastTick;
    this.rate = rate;
    this.tick = Math.min(this.tick ?? 0, lastTick);
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  changed() {
    for (const listener of this.listeners) listener(this);
  }

  /** Whole ticks when moved by hand; played, what lies between them too. */
  go(tick) {
    this.tick = Math.max(0, Math.min(this.lastTick, tick));
    this.changed();
  }

  step(ticks) {
    this.pause();
    this.go(Math.round(this.tick) + ticks);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.changed();
  }

  faster(steps) {
    const at = kSpeeds.indexOf(this.speed);
    this.setSpeed(kSpeeds[Math.max(0, Math.min(kSpeeds.length - 1, at + steps))]);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.tick >= this.lastTick) this.tick = 0;
    this.playing = true;
    let before = performance.now();
    cancelAnimationFrame(this.frame);  // of a play that was paused within this picture
    const frame = (now) => {
      if (!this.playing) return;
      const tick = this.tick + ((now - before) / 1000) * this.speed * this.rate;
      before = now;
      if (tick >= this.lastTick) this.playing = false;
      this.go(tick);
      if (this.playing) this.frame = requestAnimationFrame(frame);
    };
    this.frame = requestAnimationFrame(frame);
    this.changed();
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.go(Math.round(this.tick));
  }
}
