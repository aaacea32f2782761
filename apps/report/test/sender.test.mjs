// How a game's log is sent, without a browser: node --test sender.test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';

import { Sender } from '../src/play/sender.js';

const kTaken = 100_000;  // bytes of a request that arrive before its time is over

/** A line on which larger requests take too long, and the first ones do not arrive. */
function slowLine(taken = kTaken, cut = 0) {
  const bodies = [];
  let size = 0;
  globalThis.location = { pathname: '/play/token' };
  globalThis.fetch = async (url, { body }) => {
    if (url.includes('/log?')) {
      bodies.push(body.size);
      if (body.size > taken || bodies.length <= cut) throw new DOMException('the time is over', 'TimeoutError');
      size += body.size;
    }
    return { ok: true, json: async () => ({ size }) };
  };
  return bodies;
}

test('on a slow line a request becomes smaller until it arrives', async () => {
  const bodies = slowLine();
  const sender = new Sender('key', () => {});
  await sender.begin();
  sender.add(new Uint8Array(150_000));
  sender.add(new Uint8Array(6_000_000));
  await new Promise((resolve) => { const look = () => (sender.sent > 0 ? resolve() : setTimeout(look, 50)); look(); });
  assert.deepEqual(bodies.slice(0, 5), [1_000_000, 500_000, 250_000, 125_000, 62_500]);
  await sender.finish();
  assert.equal(sender.sent, 6_150_000);
  const late = bodies.slice(4);
  const failed = late.filter((size) => size > kTaken).length;  // each takes all of its time
  assert.ok(failed > 0 && failed < late.length / 15, `${failed} of ${late.length}`);
  assert.ok(sender.over && !sender.failed);
});

test('what an interruption keeps back is sent in large requests, as the small one that failed was not too large', async () => {
  const bodies = slowLine(Infinity, 2);
  const sender = new Sender('key', () => {});
  await sender.begin();
  sender.add(new Uint8Array(500));
  await new Promise((resolve) => { const look = () => (bodies.length === 2 ? resolve() : setTimeout(look, 10)); look(); });
  sender.add(new Uint8Array(1_500_000));
  await sender.finish();
  assert.deepEqual(bodies, [500, 500, 1_000_000, 500_500]);
});

test('on a slow line the rest of a log becomes smaller with the first try', async () => {
  const bodies = slowLine();
  const sender = new Sender('key', () => {});
  await sender.begin();
  sender.add(new Uint8Array(300_000));
  await sender.finish();
  assert.deepEqual(bodies, [300_000, 150_000, 75_000, 75_000, 75_000, 75_000]);
});
