// Just enough PNG: 8-bit RGB and 16-bit grey, not interlaced, as headpin writes them.
import { readFileSync } from 'node:fs';
import { inflateSync } from 'node:zlib';

/** @return  {width, height, channels, values}: rows from the top */
export function readPng(path) {
  const bytes = readFileSync(path);
  const parts = [];
  let head;
  for (let at = 8; at < bytes.length;) {
    const size = bytes.readUInt32BE(at);
    const kind = bytes.toString('latin1', at + 4, at + 8);
    const body = bytes.subarray(at + 8, at + 8 + size);
    if (kind === 'IHDR') head = body;
    if (kind === 'IDAT') parts.push(body);
    at += size + 12;
  }
  const [width, height, depth, colour] = [head.readUInt32BE(0), head.readUInt32BE(4), head[8], head[9]];
  const channels = colour === 2 ? 3 : 1;
  const pixel = (channels * depth) / 8;
  const data = inflateSync(Buffer.concat(parts));
  const row = width * pixel;
  const out = Buffer.alloc(height * row);
  const near = (a, b, c) => {
    const [p, q, r] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
    return p <= q && p <= r ? a : q <= r ? b : c;
  };
  for (let y = 0; y < height; ++y) {
    const filter = data[y * (row + 1)];
    for (let i = 0; i < row; ++i) {
      const a = i >= pixel ? out[y * row + i - pixel] : 0;
      const b = y > 0 ? out[(y - 1) * row + i] : 0;
      const c = i >= pixel && y > 0 ? out[(y - 1) * row + i - pixel] : 0;
      const guess = [0, a, b, (a + b) >> 1, near(a, b, c)][filter];
      out[y * row + i] = (data[y * (row + 1) + 1 + i] + guess) & 255;
    }
  }
  const values = depth === 16
    ? Uint16Array.from({ length: width * height }, (_, i) => out.readUInt16BE(2 * i)) : Uint8Array.from(out);
  return { width, height, channels, values };
}
