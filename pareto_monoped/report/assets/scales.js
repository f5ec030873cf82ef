// Scales of axes, their ticks, and colours of numbers.

// A scale from values in [low, high] to a share in [0, 1]; "soft" is linear about zero and logarithmic far from it.
function scaleOf([low, high], kind = "linear", unit = 1) {
  const bend = { linear: (v) => v, log: (v) => (v > 0 ? Math.log10(v) : NaN), soft: (v) => Math.asinh(v / unit) }[kind];
  const back = { linear: (v) => v, log: (v) => 10 ** v, soft: (v) => unit * Math.sinh(v) }[kind];
  const from = bend(low), span = bend(high) - from || 1;
  return {
    kind, range: [low, high], share: (value) => (value === null ? NaN : (bend(value) - from) / span), value: (share) => back(from + share * span),
    ticks: (count) => (kind === "linear" ? ticks(low, high, count) : kind === "log" ? logTicks(low, high, count) : softTicks(low, high, unit)),
  };
}

// 1, 2 and 5 in each decade, fewer over many decades; over less than a decade as on a linear axis.
function logTicks(low, high, count) {
  const decades = Math.log10(high / low);
  if (decades < 1) return ticks(low, high, count).filter((value) => value > 0);
  const steps = decades > 3 ? [1] : decades > 1.7 ? [1, 3] : [1, 2, 5];
  const result = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const step of steps) if (step * 10 ** power >= low * 0.999 && step * 10 ** power <= high * 1.001) result.push(step * 10 ** power);
  }
  return result;
}

function softTicks(low, high, unit) {
  const result = low <= 0 ? [0] : [];
  for (let power = Math.ceil(Math.log10(unit)); 10 ** power <= high; power += 1) if (10 ** power >= low) result.push(10 ** power);
  return result;
}

function quantile(sorted, share) { return sorted[Math.min(Math.max(Math.round(share * (sorted.length - 1)), 0), sorted.length - 1)]; }

const MANY_TIMES = 20; // from here on most of a linear axis would be empty: our own choice

// The kind of axis that values ask for: logarithmic where they spread over more than a decade, soft if some are zero.
function kindFor(values) {
  const sorted = Float64Array.from(values.filter((v) => v !== null && !Number.isNaN(v))).sort();
  if (!sorted.length || sorted[0] < 0) return "linear";
  const high = quantile(sorted, 0.95), top = sorted.at(-1), low = quantile(sorted, 0.05), middle = sorted[sorted.length >> 1];
  if (sorted[0] > 0) return high > MANY_TIMES * low || top > MANY_TIMES * middle ? "log" : "linear";
  return top > MANY_TIMES * Math.max(middle, 1e-9 * top) && top > 0 ? "soft" : "linear";
}

function paddedBy(kind, [low, high], share = 0.05) {
  if (kind !== "log") return padded([low, high], share);
  const factor = (high / low) ** share || 1;
  return factor > 1 ? [low / factor, high * factor] : [low / 1.1, high * 1.1];
}

// Viridis of Matplotlib (CC0): evenly bright steps that the colour-blind can order.
const RAMP = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]];
const SHADES = 48;

function shadeOf(value, low, high) { return Math.round(Math.min(Math.max((value - low) / (high - low || 1), 0), 1) * (SHADES - 1)); }

function rampColour(shade) {
  const at = shade / (SHADES - 1) * (RAMP.length - 1), i = Math.min(Math.floor(at), RAMP.length - 2);
  return RAMP[i].map((from, k) => Math.round(from + (at - i) * (RAMP[i + 1][k] - from)));
}

const RAMP_TEXT = Array.from({ length: SHADES }, (_, shade) => `rgb(${rampColour(shade).join(" ")})`);
