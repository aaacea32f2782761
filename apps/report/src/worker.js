// Runs beside the page: the engine's factory stands before this in the same script.
/* global headpinEngine */
let engine = null;

async function answer({ kind, wasm, bytes, moved }) {
  if (kind === 'start') {
    engine = await headpinEngine({ wasmBinary: wasm });
    return {};
  }
  if (kind === 'load') return engine.load(bytes);
  if (kind === 'open') return engine.open(bytes);
  const before = performance.now();
  const result = engine.simulate(moved);
  return { ...result, milliseconds: performance.now() - before };
}

self.onmessage = async ({ data }) => {
  let result;
  try {
    result = await answer(data);
  } catch (error) {
    result = { error: String(error?.message ?? error) };
  }
  self.postMessage({ id: data.id, ...result }, result.floats ? [result.floats.buffer] : []);
};
