// `headpin export --gltf`, read by Khronos' validator and by three's loader.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { validateBytes } from 'gltf-validator';
import { AnimationMixer, Matrix4, Quaternion, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { demo, folder, headpin, random, table } from './program.mjs';

headpin('replay', demo, '-o', 'game.lcmlog');
headpin('export', 'game.lcmlog', '-o', 'tables');
headpin('export', 'game.lcmlog', '--gltf', 'all.glb');
headpin('export', 'game.lcmlog', '--gltf', 'thin.glb', '--tolerance', '0.1mm');
headpin('frames', 'game.lcmlog', '--cameras', 'cameras.json');

const bytesOf = (file) => readFileSync(join(folder, file));

// Poses of each body, by tick.
const bodies = new Map();
for (const row of table('tables/states.csv')) {
  if (!bodies.has(row.body)) bodies.set(row.body, []);
  const pose = { t: row.time_s, p: new Vector3(row.x_m, row.y_m, row.z_m), q: new Quaternion(row.qx, row.qy, row.qz, row.qw) };
  bodies.get(row.body).push(pose);
}

async function scene(file) {
  const bytes = bytesOf(file);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await new GLTFLoader().parseAsync(buffer, '');
  const mixer = new AnimationMixer(gltf.scene);
  mixer.clipAction(gltf.animations[0]).play();
  // A node by the name that the file gives it: three changes spaces.
  const node = (name) => gltf.scene.getObjectByName(name.replaceAll(' ', '_'));
  return { gltf, node, go: (t) => mixer.setTime(t) };
}

// The pose of the table at a time, on a line and an arc between its ticks.
function expected(poses, t) {
  const last = poses.findIndex((pose) => pose.t >= t);
  if (last <= 0) return poses[Math.max(last, 0)];
  const [a, b] = [poses[last - 1], poses[last]];
  const share = (t - a.t) / (b.t - a.t);
  return { p: a.p.clone().lerp(b.p, share), q: a.q.clone().slerp(b.q, share) };
}

// How far a file is from the tables at a thousand times: places [m], and turns [rad] by body.
async function farthest(file) {
  const { node, go } = await scene(file);
  const drawn = [...bodies].filter(([name]) => name === 'ball' || name.startsWith('skittle'));
  assert.equal(drawn.length, 11);
  const next = random(7);
  const end = drawn[0][1].at(-1).t;
  let place = 0;
  const turn = { ball: 0, skittle: 0 };
  for (let i = 0; i < 1000; ++i) {
    const t = next() * end;
    go(t);
    for (const [name, poses] of drawn) {
      const { p, q } = expected(poses, t);
      place = Math.max(place, node(name).position.distanceTo(p));
      const kind = name === 'ball' ? 'ball' : 'skittle';
      turn[kind] = Math.max(turn[kind], node(name).quaternion.clone().normalize().angleTo(q));
    }
  }
  return { place, turn };
}

for (const file of ['all.glb', 'thin.glb']) {
  test(`${file} is without an error for Khronos' validator`, async () => {
    const report = await validateBytes(new Uint8Array(bytesOf(file)));
    assert.deepEqual(report.issues.messages.filter((issue) => issue.severity <= 1), []);
  });
}

// float32 rounds times by 0.5 us, in which the ball moves 4 um and a skittle turns by 20 urad.
test('every body is where the table of states has it', async () => {
  const { place, turn } = await farthest('all.glb');
  assert.ok(place < 1e-5, `${place} m`);
  assert.ok(turn.ball < 1e-4 && turn.skittle < 1e-4, JSON.stringify(turn));
});

// The tolerance is that of a point of the surface: a ball's radius, a skittle's height from its centre.
test('thinned keys stay within the tolerance', async () => {
  const { place, turn } = await farthest('thin.glb');
  assert.ok(place > 1e-5 && place < 1.1e-4, `${place} m`);
  assert.ok(turn.ball * 0.108 < 1.1e-4 && turn.skittle * 0.38 < 1.1e-4, JSON.stringify(turn));
});

test('both cameras are where the eyes of each frame are', async () => {
  const { gltf, go } = await scene('all.glb');
  const { frames, cameras } = JSON.parse(bytesOf('cameras.json'));
  assert.equal(gltf.cameras.length, 2);
  assert.ok(frames.length > 400);
  const flip = new Matrix4().makeScale(1, -1, -1); // OpenCV's axes to those of glTF
  for (const camera of gltf.cameras) {
    const eye = camera.parent.name.startsWith('left') || camera.name.startsWith('left') ? 'left' : 'right';
    const { gl_projection: projection } = cameras[eye];
    camera.updateProjectionMatrix();
    assert.ok(Math.abs(camera.projectionMatrix.elements[0] - projection[0][0]) < 1e-6);
    assert.ok(Math.abs(camera.projectionMatrix.elements[5] - projection[1][1]) < 1e-6);
    for (const frame of frames) {
      go(frame.t_us * 1e-6);
      gltf.scene.updateMatrixWorld(true);
      const world = gltf.scene.getObjectByName('world').matrixWorld.clone().invert().multiply(camera.matrixWorld);
      const wanted = new Matrix4().set(...frame[eye].T_cam_world.flat()).premultiply(flip).invert();
      const off = Math.max(...world.elements.map((x, k) => Math.abs(x - wanted.elements[k])));
      assert.ok(off < 2e-5, `${eye} eye, frame ${frame.frame}: ${off}`);
    }
  }
});

test('one hand is seen at a time: open, then closed around the ball, then open again', async () => {
  const { gltf, go } = await scene('all.glb');
  const hands = [];
  gltf.scene.traverse((node) => { if (/^hand_\d/.test(node.name)) hands.push(node); });
  const seen = (t) => {
    go(t);
    const whole = hands.filter((hand) => hand.scale.x === 1);
    assert.equal(whole.length, 1);
    assert.ok(hands.every((hand) => hand === whole[0] || hand.scale.length() === 0));
    return whole[0].name;
  };
  const at = Object.fromEntries(table('tables/events.csv').map((event) => [event.kind, event.time_s]));
  assert.equal(seen(at.grab - 0.1), 'hand_1_of_7');
  assert.equal(seen(at.release - 0.01), 'hand_7_of_7');
  assert.equal(seen(at.release + 0.2), 'hand_1_of_7');
  assert.ok(new Set(Array.from({ length: 40 }, (_, i) => seen(at.release + 0.003 * i))).size > 4);
});
