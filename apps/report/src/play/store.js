// Where a game's log is kept while it grows: the browser's own file system (OPFS), and memory.
import { block } from '../data.js';
import { kFolder, markOf } from './kept_names.js';

const lockOf = (name) => `headpin ${name}`;

async function folderOf(create) {
  const root = await navigator.storage.getDirectory();
  return root.getDirectoryHandle(kFolder, { create });
}

/** Logs that earlier pages left: [{name, file, playing, cut}], the newest first; cut: the disk took only its beginning. */
export async function keptLogs() {
  try {
    const held = (await navigator.locks.query()).held.map(({ name }) => name);
    const files = new Map();
    for await (const [name, handle] of (await folderOf(true)).entries()) {
      if (handle.kind === 'directory') continue;  // not ours
      files.set(name, await handle.getFile().catch(() => null));  // another page may have removed it
    }
    const all = [...files].filter(([name, file]) => file && name.endsWith('.lcmlog')).map(([name, file]) => (
      { name, file, playing: held.includes(lockOf(name)), cut: files.get(markOf(name))?.size === 0 }));
    return all.sort((a, b) => (a.name < b.name ? 1 : -1));
  } catch {
    return [];  // there is no such file system
  }
}

/** @throws  in words, while another page plays the game, or when the file is gone */
export async function removeLog(name) {
  await navigator.locks.request(lockOf(name), { ifAvailable: true }, async (lock) => {
    if (!lock) throw new Error('it is being played');
    try {
      const folder = await folderOf(false);
      await folder.removeEntry(name);
      await folder.removeEntry(markOf(name)).catch(() => {});  // most have none
    } catch (error) {
      throw error.name === 'NotFoundError' ? new Error('it was not there any more') : error;
    }
  });
}

/** Offers a file to the person. */
export function save(name, blob) {
  const url = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** 2026-01-31T12-34-56-NAME.lcmlog: a name that no other game has. */
function newName(participant) {
  const time = new Date().toISOString().slice(0, 23).replace(/[:.]/g, '-');
  const who = participant.replace(/[^\p{L}\p{N}_-]+/gu, '_').slice(0, 40);
  return `${time}${who ? `-${who}` : ''}.lcmlog`;
}

function whyNotStored(error) {
  if (error.cause?.full) return 'The browser has no room left for this game on the disk.';
  if (location.protocol === 'file:') return 'This browser stores no games of a page that is opened from a file.';
  return 'This browser stores no games.';
}

/** The log of one game. */
export class Store {
  /** @param onTrouble  told once, in a sentence, why the log is kept in memory alone */
  constructor(participant, onTrouble) {
    this.participant = participant;
    this.name = newName(participant);
    this.onTrouble = onTrouble;
    this.pieces = [];  // all of them: what could not be stored is saved from here
    this.stored = 0;   // bytes on the disk
    this.asked = 0;
    this.open = new Map();
  }

  async start() {
    try {
      await folderOf(true);
      const code = new TextDecoder().decode(await block('store-worker'));
      this.worker = new Worker(URL.createObjectURL(new Blob([code], { type: 'text/javascript' })));
      this.worker.onmessage = ({ data }) => this.open.get(data.id)?.(data);
      this.worker.onerror = ({ message }) => this.fail(new Error(message));
      while (!(await this.takeName())) this.name = newName(this.participant);  // another time, another name
    } catch (error) {
      this.fail(error);
    }
  }

  /** Opens the file; false when another game has this name. */
  async takeName() {
    if (!(await this.lock())) return false;
    const { taken } = await this.ask({ kind: 'open', name: this.name });
    if (taken) await this.release();
    return !taken;
  }

  /** Says to other pages that the game is played; false when one of them has said so of its own. */
  lock() {
    return new Promise((resolve, reject) => {
      this.locked = navigator.locks.request(lockOf(this.name), { ifAvailable: true }, (lock) => {
        resolve(lock !== null);
        return lock && new Promise((unlock) => { this.unlock = unlock; });
      });
      this.locked.catch(reject);
    });
  }

  async release() {
    this.unlock?.();
    await this.locked;
  }

  ask(question) {
    const id = ++this.asked;
    return new Promise((resolve, reject) => {
      this.open.set(id, (answer) => {
        this.open.delete(id);
        if (answer.error) reject(new Error(answer.error, { cause: answer }));
        else resolve(answer);
      });
      this.worker.postMessage({ id, ...question });
    });
  }

  fail(error) {
    if (this.failed) return;
    this.failed = true;
    this.worker?.terminate();
    for (const answered of [...this.open.values()]) answered({ error: error.message });
    this.onTrouble(whyNotStored(error));
  }

  /** Takes a piece of the log. */
  add(piece) {
    this.pieces.push(piece);
    if (this.failed) return;
    this.ask({ kind: 'write', piece })
      .then(({ size }) => { this.stored = size; })
      .catch((error) => this.fail(error));
  }

  /** Nothing was played: leaves no log behind. */
  async discard() {
    await this.finish();
    await removeLog(this.name).catch(() => {});  // where nothing can be stored there is none
  }

  /** The whole log, once the disk has all of it or has failed. */
  async finish() {
    if (!this.failed) await this.ask({ kind: 'close', name: this.name }).catch((error) => this.fail(error));
    await this.release().catch(() => {});  // where nothing can be stored there may be no locks
    return new Blob(this.pieces, { type: 'application/octet-stream' });
  }
}
