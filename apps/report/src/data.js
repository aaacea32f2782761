// What stands in the page: blocks of base64, most of them deflated, read back into JSON and numbers.

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** zlib's format, as `headpin report` writes it. */
export async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export function hasBlock(name) {
  return document.querySelector(`script[data-block="${name}"]`) !== null;
}

export function rawBlock(name) {
  const element = document.querySelector(`script[data-block="${name}"]`);
  return element && bytesOf(element.textContent);
}

export async function block(name) {
  return inflated(rawBlock(name));
}

export async function jsonBlock(name) {
  return JSON.parse(new TextDecoder().decode(await block(name)));
}

/**
 * Numbers in whole quanta, each as what it is more than the one above it (zigzag LEB128), column
 * after column, back into rows.
 */
export function numbersOf(bytes, sections) {
  const last = sections[sections.length - 1];
  const numbers = new Float32Array(last ? last.offset + last.rows * last.columns.length : 0);
  let at = 0;
  for (const { offset, rows, columns, quanta } of sections) {
    const width = columns.length;
    for (let column = 0; column < width; ++column) {
      const quantum = quanta[column];
      let now = 0;
      for (let i = offset + column, row = 0; row < rows; ++row, i += width) {
        let byte = bytes[at++];
        let coded = byte & 0x7f;
        for (let scale = 128; byte & 0x80; scale *= 128) {  // 53 bits, where << has 32
          byte = bytes[at++];
          coded += (byte & 0x7f) * scale;
        }
        now += coded % 2 ? -(coded + 1) / 2 : coded / 2;
        numbers[i] = now * quantum;
      }
    }
  }
  return numbers;
}
