// Triangles that fill polygons: corners and triangles of fans round the middle of each, so that shaders know the way to
// its rim.

function doubled(array) {
  const grown = new array.constructor(2 * array.length);
  grown.set(array);
  return grown;
}

/**
 * Corners of the fans of all polygons, in arrays that grow as they are needed. `of` holds one for each attribute of
 * `sizes`, as many numbers for each corner, and `part` (2 each): the number of the polygon, and 1 in the middle, 0 on
 * the rim.
 */
export class Fans {
  constructor(guess, sizes) {
    this.sizes = { ...sizes, part: 2 };
    this.corners = 0;
    this.used = 0;
    this.room = guess;
    this.of = Object.fromEntries(Object.entries(this.sizes).map(([name, size]) => [name, new Float32Array(size * guess)]));
    this.index = new Uint32Array(3 * guess);
  }

  /** Make a corner of the polygon `number`, whose attributes are still to be set; return its own number. */
  corner(number, within) {
    const at = this.corners++;
    if (at === this.room) {
      for (const name of Object.keys(this.of)) this.of[name] = doubled(this.of[name]);
      this.room *= 2;
    }
    this.of.part[2 * at] = number;
    this.of.part[2 * at + 1] = within;
    return at;
  }

  triangle(a, b, c) {
    if (this.used === this.index.length) this.index = doubled(this.index);
    this.index[this.used++] = a;
    this.index[this.used++] = b;
    this.index[this.used++] = c;
  }

  /** Triangles between corner `hub` and the `count` ones made after it. */
  round(hub, count) {
    for (let k = 1; k <= count; k++) this.triangle(hub, hub + k, hub + 1 + (k % count));
  }

  /** Arrays of the attributes, and `index`, three corners for each triangle. */
  get filled() {
    const used = Object.entries(this.of).map(([name, array]) => [name, array.subarray(0, this.sizes[name] * this.corners)]);
    return { ...Object.fromEntries(used), index: this.index.subarray(0, this.used) };
  }
}
