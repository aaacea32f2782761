// What a browser draws in 3D with.

/** What a browser says, which may be a list of several lines, as part of a sentence. */
function inBrief(text) {
  return text.replace(/\s+/g, ' ').replace(/(\.| |\(\))+$/, '');
}

/** Whether the browser draws with a processor alone, and why it does not draw at all. */
export function lookAtWebGl() {
  const canvas = document.createElement('canvas');
  let why = '';
  canvas.addEventListener('webglcontextcreationerror', (event) => { why = event.statusMessage; });
  const gl = canvas.getContext('webgl2');
  if (!gl) return { why: inBrief(why) || 'it is switched off, or there is no driver for it' };
  const who = gl.getExtension('WEBGL_debug_renderer_info');
  const name = who ? gl.getParameter(who.UNMASKED_RENDERER_WEBGL) : '';
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return { software: /swiftshader|llvmpipe|software/i.test(name) };
}
