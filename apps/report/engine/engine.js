// What the page sees of engine.cpp. Each gives {json, floats}, or {error: what is wrong}:
//
//   open(bytes)      a log (Uint8Array) as it was recorded, and what it looks like; it stays open
//   load(bytes)      only opens it
//   simulate(moved)  the open one again: {elasticity, friction, shape, response}, each as it was
//                    when not given
//
// What is given out is a copy, which may be transferred.
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

  const simulate = (moved, meshes) =>
    ask(new TextEncoder().encode(JSON.stringify(moved)), () => _headpin_simulate(meshes));

  Module['load'] = (bytes) => ask(bytes, () => _headpin_load());
  Module['simulate'] = (moved = {}) => simulate(moved, false);
  Module['open'] = (bytes) => {
    const loaded = Module['load'](bytes);
    return loaded['error'] === undefined ? simulate({}, true) : loaded;
  };
}
