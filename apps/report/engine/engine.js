// What the page sees of engine.cpp. Each gives {json, floats}, or {error: what is wrong}:
//
//   open(bytes)      a log (Uint8Array) as it was recorded, and what it looks like; it stays open, and after
//                    an error the one before does
//   load(bytes)      only opens it
//   simulate(moved)  the open one again: {elasticity, friction, shape, response}, each as it was
//                    when not given
//
// What is given out is a copy, which may be transferred.
//
// Of a game, with times in microseconds of the session's clock and poses [w, x, y, z, px, py, pz]:
//
//   begin({scenario, device, left_hand, participant, condition, seed, epoch_us})
//   tracker(station, deviceTime, hostTime, pose)
//   buttons(deviceTime, hostTime, leftThumb, rightThumb, trigger)
//   note(kind, detail, value)          an event that belongs to no tick
//   frame(time, number, [left, right]) a frame was drawn, with the eyes there
//   advance(until)                     {ticks, view, news}: view is valid until the next call
//   takeSound()                        what was heard since the last call: Int16Array, left and right in turn
//   takeLog()                          the log's bytes since the last call
//   finish(frames, lateFrames)         {json}: how many were drawn, and how many of them late
{
  const text = () => {
    const from = _headpin_text();
    return new TextDecoder().decode(HEAPU8.subarray(from, from + _headpin_text_size()));
  };

  SYSCALLS.doReadlink = () => -44;  // ENOENT: a mesh file is looked for, and there are no files

  const ask = (bytes, work) => {
    try {
      const room = _headpin_room(bytes.length);
      if (!room && bytes.length > 0) return { error: text() };
      HEAPU8.set(bytes, room);
      if (!work()) return { error: text() };
      const from = _headpin_floats();
      return { json: text(), floats: HEAPF32.slice(from >> 2, (from >> 2) + _headpin_floats_size()) };
    } catch (error) {  // a trap, not an exception of ours
      return { error: `the engine stopped: ${error.message}` };
    }
  };

  const failed = (done) => (done ? {} : { error: text() });
  const stopped = (work) => {
    try {
      return work();
    } catch (error) {
      return { error: `the engine stopped: ${error.message}` };
    }
  };
  const put = (poses) => {
    const at = _headpin_poses() >> 3;
    poses.forEach((pose, i) => HEAPF64.set(pose, at + 7 * i));
  };
  const json = (object) => new TextEncoder().encode(JSON.stringify(object));

  Module['begin'] = (options) => ask(json(options), () => _headpin_begin());
  Module['note'] = (kind, detail, value) => ask(json({ 'kind': kind, 'detail': detail, 'value': value }), () => _headpin_note());
  Module['tracker'] = (station, deviceTime, hostTime, pose, estimated) => stopped(() => {
    put([pose]);
    return failed(_headpin_tracker(station, deviceTime, hostTime, estimated));
  });
  Module['buttons'] = (...state) => stopped(() => failed(_headpin_buttons(...state)));
  Module['frame'] = (time, number, eyes) => stopped(() => {
    put(eyes);
    return failed(_headpin_frame(time, number));
  });
  Module['advance'] = (until) => stopped(() => {
    const ticks = _headpin_advance(until);
    if (ticks < 0) return { error: text() };
    const said = text();
    const from = _headpin_floats() >> 2;
    return { ticks, view: HEAPF32.subarray(from, from + _headpin_floats_size()), news: said ? JSON.parse(said) : null };
  });
  const taken = () => {
    const from = _headpin_bytes();
    return HEAPU8.slice(from, from + _headpin_bytes_size());
  };
  Module['takeSound'] = () => stopped(() => (_headpin_take_sound() ? new Int16Array(taken().buffer) : { error: text() }));
  Module['takeLog'] = () => {
    _headpin_take_log();
    return taken();
  };
  Module['finish'] = (frames, lateFrames) => ask(new Uint8Array(0), () => _headpin_finish(frames, lateFrames));

  Module['load'] = (bytes) => ask(bytes, () => _headpin_load());
  Module['simulate'] = (moved = {}) => ask(json(moved), () => _headpin_simulate());
  Module['open'] = (bytes) => ask(bytes, () => _headpin_open());
}
