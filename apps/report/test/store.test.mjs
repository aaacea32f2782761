// How a game's log is kept on a disk that may be full, without a browser: node --test store.test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';

import { keptLogs, removeLog } from '../src/play/store.js';

/** A browser's own file system with room for some bytes. */
class Disk {
  /** @param throws  where the room ends it throws; else it stores what fits */
  constructor(room, throws) {
    this.room = room;
    this.throws = throws;
    this.files = new Map();
    const folder = {
      getFileHandle: async (name) => this.handleOf(name),
      removeEntry: async (name) => {
        if (!this.files.delete(name)) throw new DOMException('no such file', 'NotFoundError');
      },
      entries: () => [...this.files.keys()].map((name) => [name, this.handleOf(name)]),
    };
    const value = {
      storage: { getDirectory: async () => ({ getDirectoryHandle: async () => folder }) },
      locks: { query: async () => ({ held: [] }), request: async (name, options, work) => work({}) },
    };
    Object.defineProperty(globalThis, 'navigator', { value, configurable: true });
  }

  left() {
    return [...this.files.values()].reduce((room, file) => room - file.size, this.room);
  }

  handleOf(name) {
    if (!this.files.has(name)) this.files.set(name, { size: 0 });
    const file = this.files.get(name);
    const write = (bytes, { at }) => {
      const end = Math.min(at + bytes.length, file.size + this.left());
      if (this.throws && end < at + bytes.length) throw new DOMException('no room', 'QuotaExceededError');
      file.size = Math.max(file.size, end);
      return end - at;
    };
    return {
      getFile: async () => {
        if (this.gone === name) throw new DOMException('no such file', 'NotFoundError');
        return { size: file.size };
      },
      createSyncAccessHandle: async () => ({
        getSize: () => file.size, write, truncate: (size) => { file.size = size; }, flush() {}, close() {},
      }),
    };
  }
}

let workers = 0;

/** The worker of a page that keeps a game. @return  asks it */
async function workerOf() {
  const asked = new Map();
  globalThis.self = { postMessage: (answer) => asked.get(answer.id)(answer) };
  await import(`../src/play/store_worker.js?${++workers}`);
  const { onmessage } = self;
  return (kind, piece) => new Promise((resolve) => {
    const id = asked.size;
    asked.set(id, resolve);
    onmessage({ data: { id, kind, name: 'game.lcmlog', piece } });
  });
}

const listed = async () => (await keptLogs()).map(({ name, file: { size }, cut }) => ({ name, size, cut }));

for (const throws of [false, true]) {
  const kind = throws ? 'throws' : 'stores what fits';
  test(`of a game that filled the disk, later pages know that its log is only the beginning: it ${kind}`, async () => {
    const disk = new Disk(100_000, throws);
    const ask = await workerOf();
    assert.equal((await ask('open')).error, undefined);
    assert.equal((await ask('write', new Uint8Array(60_000))).size, 60_000);
    assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 60_000, cut: false }]);
    disk.room = 70_000;
    assert.equal((await ask('write', new Uint8Array(60_000))).full, true);
    assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 60_000, cut: true }]);
    await removeLog('game.lcmlog');
    assert.deepEqual([...disk.files.keys()], []);
  });

  test(`a game that ends while the disk does not take its last pieces is only the beginning: it ${kind}`, async () => {
    const disk = new Disk(100_000, throws);
    const ask = await workerOf();
    await ask('open');
    await ask('write', new Uint8Array(60_000));
    disk.room = 70_000;
    // As the page does at the end of a game, it waits for no answer.
    const answers = await Promise.all([ask('write', new Uint8Array(20_000)), ask('write', new Uint8Array(5_000)), ask('close')]);
    assert.deepEqual(answers.map(({ full }) => full), [true, true, true]);
    assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 60_000, cut: true }]);
  });

  test(`a disk that is full from the first byte has the beginning of nothing: it ${kind}`, async () => {
    new Disk(0, throws);
    const ask = await workerOf();
    assert.equal((await ask('open')).full, true);
    assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 0, cut: true }]);
  });
}

test('a log that is whole up to where it ends is none of these', async () => {
  const disk = new Disk(100_000, true);
  const closed = await workerOf();
  await closed('open');
  disk.gone = 'game.lcmlog.mark';  // its page ends the game while another one lists it
  assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 0, cut: false }]);
  await closed('write', new Uint8Array(1000));
  assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 1000, cut: false }]);  // so where the page is killed
  await closed('close');
  assert.deepEqual(await listed(), [{ name: 'game.lcmlog', size: 1000, cut: false }]);
  assert.deepEqual([...disk.files.keys()], ['game.lcmlog']);  // as a page of an earlier version leaves it
  const taken = await workerOf();
  assert.equal((await taken('open')).taken, true);
  assert.deepEqual([...disk.files.keys()], ['game.lcmlog']);
});
