// What is drawn, without a browser: node --test world.test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';

import { BoxGeometry, Mesh, Scene } from 'three';

import { reachOf } from '../src/world.js';

test('a camera sees to the other end of a long room', () => {
  const room = new Scene();
  const hall = new Mesh(new BoxGeometry(4, 200, 3));
  hall.position.set(0, 90, 0);
  hall.updateMatrix();
  hall.matrixAutoUpdate = false;
  room.add(hall);
  assert.ok(reachOf(room, 60) >= 200);
  assert.ok(reachOf(room, 60) < 210);
  assert.equal(reachOf(new Scene(), 60), 60);
});
