// Colour bars: one for each range of colours.

import { inBrackets, inDigits, powerFor } from "./numbers.js";

const TICKS = 5;

/** Fill `holder` with bars; each has `colours` (three bytes each), `range`, `meaning` and `units`. */
export function showBars(holder, bars) {
  holder.replaceChildren(...bars.map(bar));
}

function bar({ colours, range: [low, high], meaning, units }) {
  const power = powerFor(Math.max(Math.abs(low), Math.abs(high)));
  const name = Object.assign(document.createElement("div"), { className: "name", textContent: meaning + inBrackets(power, units) });
  const ticks = Object.assign(document.createElement("div"), { className: "ticks" });
  for (let i = 0; i < TICKS; i++) {
    const share = i / (TICKS - 1);
    const text = inDigits(low + share * (high - low), (high - low) / 200, power);
    ticks.append(Object.assign(document.createElement("span"), { textContent: text, style: `left:${100 * share}%` }));
  }
  const holder = Object.assign(document.createElement("div"), { className: "bar" });
  holder.append(strip(colours), ticks, name);
  return holder;
}

function strip(colours) {
  const count = colours.length / 3;
  const canvas = Object.assign(document.createElement("canvas"), { width: count, height: 1 });
  const pixels = new ImageData(count, 1);
  for (let i = 0; i < count; i++) pixels.data.set([...colours.subarray(3 * i, 3 * i + 3), 255], 4 * i);
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  canvas.setAttribute("aria-hidden", "true");
  return canvas;
}
