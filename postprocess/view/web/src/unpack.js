// Numbers from the text that postprocess/view/packing.py made of them.

/** Bytes of a base64 text. */
export function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Whole numbers (rows x width) of `bits` each. The bytes are those of changes from the row before and, of these, from
 * the number before, signs in the lowest bit; all lowest bytes come first.
 */
export async function unpacked(text, rows, width, bits) {
  const planes = await inflated(bytesOf(text));
  const size = rows * width;
  const numbers = new { 8: Uint8Array, 16: Uint16Array, 24: Uint32Array }[bits](size);
  const mask = 2 ** bits - 1;
  for (let row = 0, k = 0; row < rows; row++) {
    let change = 0;
    for (let i = 0; i < width; i++, k++) {
      let unsigned = planes[k];
      if (bits > 8) unsigned |= planes[size + k] << 8;
      if (bits > 16) unsigned |= planes[2 * size + k] << 16;
      change += (unsigned >>> 1) ^ -(unsigned & 1);
      numbers[k] = ((row > 0 ? numbers[k - width] : 0) + change) & mask;
    }
  }
  return numbers;
}
