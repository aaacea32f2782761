// How a game's log is sent, without a browser: node --test sender.test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';

import { Sender } from '../src/play/sender.js';

const kTaken = 100_000;  // bytes of a request that arrive before its time is over

/** A line on which larger requests take too long. */
function slowLine() {
  const bodies = [];
  let size = 0;
  globalThis.location = { pathname: '/play/token' };
  globalThis.fetch = async (url, { body }) => {
    if (url.includes('/log?')) {
      bodies.push(body.size);
      if (body.size > kTaken) throw new DOMException('the time is over', 'TimeoutError');
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
