// Values of the fields: unpacked when a field is chosen, as numbers in steps between a lowest and a highest value.

import { unpacked } from "./unpack.js";

export class Field {
  /** `about` is what postprocess/view/html_page.py tells of a field with `count` values in a row. */
  constructor(about, count) {
    Object.assign(this, about);
    this.count = count;
    this.missing = 2 ** about.bits - 1;
    this.numbers = null;
  }

  async load() {
    this.numbers ??= Promise.all(this.panes.map((pane) => unpacked(pane.values, this.rows, this.count, this.bits)));
    this.loaded = await this.numbers;
  }

  /** Numbers of a pane in the snapshot `row`. */
  row(pane, row) {
    const first = (this.rows > 1 ? row : 0) * this.count;
    return this.loaded[pane].subarray(first, first + this.count);
  }

  step(pane) {
    const { low, high } = this.panes[pane];
    return (high - low) / (this.missing - 1);
  }

  /** The value of a cell, triangle or edge; null where there is none. */
  value(pane, row, number) {
    const whole = this.row(pane, row)[number];
    return whole === this.missing ? null : this.panes[pane].low + whole * this.step(pane);
  }

  /** Lowest and highest value of some panes together, on all days or, with a `row`, on one. */
  limits(panes, row = null) {
    if (row === null) return [Math.min(...panes.map((i) => this.panes[i].low)), Math.max(...panes.map((i) => this.panes[i].high))];
    let [low, high] = [Infinity, -Infinity];
    for (const pane of panes)
      for (const whole of this.row(pane, row))
        if (whole !== this.missing) {
          const value = this.panes[pane].low + whole * this.step(pane);
          low = Math.min(low, value);
          high = Math.max(high, value);
        }
    return low <= high ? [low, high] : [0, 0];
  }

  /** Whether values of both signs ask for a palette with a pale middle. */
  get bothSigns() {
    return this.panes[0].low < 0 && this.panes[0].high > 0;
  }
}

/** A range that has zero in its middle where it has both signs, and is never empty. */
export function rounded([low, high]) {
  if (low < 0 && high > 0) {
    const half = Math.max(-low, high);
    return [-half, half];
  }
  return high > low ? [low, high] : [low - 0.5 * Math.abs(low) - 1e-30, low + 0.5 * Math.abs(low) + 1e-30];
}
