// The engine in a worker of its own: the page asks, and goes on drawing.
import { block, hasBlock } from './data.js';
import { Trial } from './trial.js';

export function isThere() {
  return hasBlock('engine-js') && hasBlock('engine-wasm');
}

export class Engine {
  /** @throws  what the engine says when it cannot start */
  static async start() {
    const text = async (name) => new TextDecoder().decode(await block(name));
    const code = `${await text('engine-js')}\n${await text('engine-worker')}`;
    const url = URL.createObjectURL(new Blob([code], { type: 'text/javascript' }));
    const engine = new Engine(new Worker(url));
    await engine.ask({ kind: 'start', wasm: await block('engine-wasm') });
    return engine;
  }

  constructor(worker) {
    this.worker = worker;
    this.open = new Map();
    this.asked = 0;
    worker.onmessage = ({ data }) => this.open.get(data.id)(data);
    worker.onerror = (event) => {
      for (const settle of this.open.values()) settle({ error: event.message || 'the engine stopped' });
    };
  }

  ask(question) {
    const id = ++this.asked;
    return new Promise((resolve, reject) => {
      this.open.set(id, (answer) => {
        this.open.delete(id);
        if (answer.error) reject(new Error(answer.error));
        else resolve(answer);
      });
      this.worker.postMessage({ id, ...question });
    });
  }

  /** Makes a log the one that is simulated. */
  load(bytes) {
    return this.ask({ kind: 'load', bytes });
  }

  /** Another trial, with all that is seen of it. */
  async openTrial(bytes) {
    const { json, floats } = await this.ask({ kind: 'open', bytes });
    return new Trial(JSON.parse(json), floats);
  }

  /** @return  the trial under another condition, without meshes, and how long that took [ms] */
  async simulate(moved) {
    const { json, floats, milliseconds } = await this.ask({ kind: 'simulate', moved });
    return { trial: new Trial(JSON.parse(json), floats), milliseconds };
  }
}
