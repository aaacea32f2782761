// `headpin export --mcap`, read by @mcap/core and protobufjs.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { McapIndexedReader, McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';
import protobuf from 'protobufjs';
import 'protobufjs/ext/descriptor/index.js';
import { demo, folder, headpin, table } from './program.mjs';

headpin('replay', demo, '-o', 'game.lcmlog');
headpin('export', 'game.lcmlog', '-o', 'tables');
headpin('export', 'game.lcmlog', '--mcap', 'game.mcap', '--eyes');
headpin('frames', 'game.lcmlog', '-o', 'frames', '--cameras', 'cameras.json', '--frames', '100');
headpin('frames', 'game.lcmlog', '--cameras', 'all.json');
const { cameras, frames } = JSON.parse(readFileSync(join(folder, 'all.json')));
const states = table('tables/states.csv');
const micros = (row) => Math.round(row.time_s * 1e6);
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
const bytes = readFileSync(join(folder, 'game.mcap'));

// Every message by topic, decoded by the schema in the file; through the index.
async function read() {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoders = new Map();
  const messages = new Map([...reader.channelsById.values()].map((channel) => [channel.topic, []]));
  for await (const message of reader.readMessages()) {
    const { topic, schemaId, messageEncoding } = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(schemaId);
    let value = message.data;
    if (messageEncoding === 'protobuf') {
      if (!decoders.has(schemaId)) decoders.set(schemaId, protobuf.Root.fromDescriptor(schema.data).lookupType(schema.name));
      const type = decoders.get(schemaId);
      value = type.toObject(type.decode(message.data), { longs: Number, defaults: true });
    }
    messages.get(topic).push({ value, us: Number(message.logTime) / 1000, schema });
  }
  return { reader, messages };
}
const { reader, messages } = await read();
const usOf = ({ seconds, nanos }) => seconds * 1e6 + nanos / 1000;

test('every checksum, and the counts of the statistics', () => {
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(bytes);
  const counts = new Map();
  for (let record; (record = stream.nextRecord());) counts.set(record.type, (counts.get(record.type) ?? 0) + 1);
  assert.ok(stream.done());
  assert.equal(counts.get('Message'), Number(reader.statistics.messageCount));
  for (const [id, count] of reader.statistics.channelMessageCounts) {
    assert.equal(messages.get(reader.channelsById.get(id).topic).length, Number(count));
  }
});

test('every transform of a body is its row of the table of states, to the last bit', () => {
  const rows = new Map(states.map((row) => [`${micros(row)} ${row.body}`, row]));
  let compared = 0;
  for (const { value, us } of messages.get('/tf')) {
    for (const { timestamp, parentFrameId, childFrameId, translation, rotation } of value.transforms) {
      assert.equal(parentFrameId, 'world');
      assert.equal(usOf(timestamp), us);
      const row = rows.get(`${us} ${childFrameId}`);
      if (!row) continue;
      assert.deepEqual(translation, { x: row.x_m, y: row.y_m, z: row.z_m });
      assert.deepEqual(rotation, { x: row.qx, y: row.qy, z: row.qz, w: row.qw });
      ++compared;
    }
  }
  const wanted = states.filter((row) => row.body === 'ball' || row.body.startsWith('skittle')).length;
  assert.equal(compared, wanted);
});

test('both eyes are where the frames have them, and see through the same cameras', () => {
  for (const side of ['left', 'right']) {
    const { K, width, height } = messages.get(`/${side}_eye/calibration`)[0].value;
    assert.deepEqual(K, cameras[side].K.flat());
    assert.deepEqual([width, height], [cameras[side].width, cameras[side].height]);
    const poses = new Map(messages.get(`/${side}_eye`).map(({ value, us }) => [us, value.pose]));
    let compared = 0;
    for (const frame of frames) {
      const pose = poses.get(frame.t_us);
      if (!pose) continue;
      const T = frame[side].T_cam_world;
      const { x, y, z } = pose.position;
      for (const row of T.slice(0, 3)) assert.ok(Math.abs(row[0] * x + row[1] * y + row[2] * z + row[3]) < 1e-9);
      ++compared;
    }
    assert.ok(compared > 400, `${compared}`);
  }
});

test('every event is its row of the table of events', () => {
  // The last two say how the recording ended; they are in lcm/EVENT.
  const rows = table('tables/events.csv').filter((row) => !['ledger', 'game_hash'].includes(row.kind));
  assert.ok(rows.length > 30);
  const events = messages.get('/events').map(({ value, us }) => ({ ...JSON.parse(value.message), name: value.name, us }));
  assert.equal(events.length, rows.length);
  for (const [i, row] of rows.entries()) {
    const event = events[i];
    assert.deepEqual([event.event, event.name, event.tick, event.us], [row.kind, row.kind, row.tick, micros(row)]);
    assert.equal(event.value, row.value);
  }
});

test('shapes are there once, in the frame of their body', () => {
  const entities = messages.get('/scene').flatMap(({ value }) => value.entities);
  const bodies = entities.filter((entity) => entity.id !== 'virtual hand');
  assert.equal(bodies.length, 12); // room, ball, ten skittles
  for (const { id, frameId, frameLocked, triangles } of entities) {
    assert.equal(frameId, id === 'room' ? 'world' : id);
    assert.ok(frameLocked);
    for (const { points, indices, colors } of triangles) {
      assert.ok(indices.length > 0 && indices.length % 3 === 0);
      assert.ok(indices.every((index) => index < points.length));
      assert.ok(colors.length === 0 || colors.length === points.length);
    }
  }
});

test('the pictures are those of `headpin frames`', () => {
  for (const side of ['left', 'right']) {
    const pictures = messages.get(`/${side}_eye/image`);
    assert.equal(pictures.length, frames.length);
    const { value } = pictures[100];
    assert.equal(value.format, 'png');
    // The pixels; the file of `frames` has the shape of a pixel besides.
    const pixels = (png) => {
      const parts = [];
      for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
        if (png.toString('latin1', at + 4, at + 8) === 'IDAT') parts.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
      }
      return Buffer.concat(parts);
    };
    assert.ok(pixels(Buffer.from(value.data)).equals(pixels(readFileSync(join(folder, `frames/${side}_000100.png`)))));
  }
});

test("the messages of the trial's log are there byte for byte, with their types", () => {
  const log = readFileSync(join(folder, 'game.lcmlog'));
  const next = new Map();
  let events = 0;
  for (let at = 0; at < log.length; ++events) {
    assert.equal(log.readUInt32BE(at), 0xeda1da01);
    const [name, size] = [log.readInt32BE(at + 20), log.readInt32BE(at + 24)];
    const channel = log.toString('utf8', at + 28, at + 28 + name);
    const data = log.subarray(at + 28 + name, at + 28 + name + size);
    const number = next.get(channel) ?? 0;
    next.set(channel, number + 1);
    const message = messages.get(`lcm/${channel}`)[number];
    assert.ok(data.equals(message.value));
    assert.match(message.schema.name, /^headpin\..*_t$/);
    assert.ok(new TextDecoder().decode(message.schema.data).includes(`struct ${message.schema.name.slice(8)}`));
    at += 28 + name + size;
  }
  const all = [...messages].filter(([topic]) => topic.startsWith('lcm/')).reduce((sum, [, list]) => sum + list.length, 0);
  assert.equal(all, events);
});
