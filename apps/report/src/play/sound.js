// The sound of a game: the engine's samples, queued one after the other.
const kRate = 48_000;  // samples a second, as the engine makes them
const kDelay = 0.06;   // s from a tick to its sound: longer than three pictures take
const kApart = 0.03;   // s: further from that, the sound is put right again

export class Sound {
  muted = false;

  /** To be called while the browser still knows of a click or a key: only then may a page sound. */
  begin() {
    this.context ??= new AudioContext({ sampleRate: kRate });
    this.volume ??= new GainNode(this.context);
    this.volume.connect(this.context.destination);
    this.mute(this.muted);
    this.due = 0;
    this.played = 0;
    this.context.resume().catch(() => {});  // the game goes on without sound
  }

  /** @param samples  Int16Array, left and right in turn: those after the last call's, up to the newest tick */
  play(samples) {
    const { context } = this;
    const count = samples.length / 2;
    if (context?.state !== 'running' || count === 0) return;
    const now = context.currentTime;
    const inStep = now + kDelay - count / kRate;
    if (Math.abs(this.due - inStep) > kApart) this.due = inStep;
    const late = Math.max(0, now - this.due);  // after a long picture its beginning is left out
    const buffer = context.createBuffer(2, count, kRate);
    for (const ear of [0, 1]) {
      buffer.copyToChannel(Float32Array.from({ length: count }, (_, i) => samples[2 * i + ear] / 32_768), ear);
    }
    const source = new AudioBufferSourceNode(context, { buffer });
    source.connect(this.volume);
    source.start(this.due + late, late);
    this.due += count / kRate;
    this.played += count;
  }

  mute(muted) {
    this.muted = muted;
    if (this.volume) this.volume.gain.value = muted ? 0 : 1;
  }

  end() {
    this.context?.suspend().catch(() => {});
  }
}
