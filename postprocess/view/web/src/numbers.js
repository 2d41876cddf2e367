// Numbers as people read them.

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** The power of ten that is better told apart for values up to `largest`; 0 for none. */
export function powerFor(largest) {
  if (!(largest > 0)) return 0;
  const power = Math.floor(Math.log10(largest));
  return power < -2 || power > 5 ? power : 0;
}

export const tenTo = (power) => (power === 0 ? "" : `10${[...String(power)].map((each) => RAISED[each]).join("")}`);

/** A value in units of 10 to the `power`, with the digits that a `step` between values leaves meaningful. */
export function inDigits(value, step, power) {
  const scaled = value / 10 ** power;
  const digits = step > 0 ? Math.min(8, Math.max(0, Math.ceil(power - Math.log10(step)))) : 3;
  const text = scaled.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

/** Units after the power of ten, in brackets; empty where there is neither. */
export function inBrackets(power, units) {
  const inside = [tenTo(power), units].filter(Boolean).join(" ");
  return inside ? ` (${inside})` : "";
}

/** The size of an angle, radians, in degrees. */
export const inDegrees = (angle) => Math.abs((angle * 180) / Math.PI).toFixed(2);
