// The jumps of the designs, unpacked when one is asked for; report/jump_packing.py says how they are packed.

const LONG_ONES = 20, LONG_BITS = 28, HEAD_BITS = 16, FAR = 4;

const jumpPlaces = new Map(); // packed jumps of a study -> key -> [first byte, bytes]

function placesOf(jumps) {
  if (!jumpPlaces.has(jumps)) {
    const places = new Map();
    let at = 0;
    jumps.keys.forEach((key, i) => { places.set(key, [at, jumps.lengths[i]]); at += jumps.lengths[i]; });
    jumpPlaces.set(jumps, places);
  }
  return jumpPlaces.get(jumps);
}

// The text of one jump alone is decoded: a page has megabytes of them. Three bytes are four letters.
function bytesOfJump(jumps, [first, count]) {
  const from = Math.floor(first / 3);
  const text = atob(jumps.data.slice(4 * from, 4 * Math.ceil((first + count) / 3)));
  return Uint8Array.from({ length: count }, (_, i) => text.charCodeAt(first - 3 * from + i));
}

// Reads a row of bits: whole numbers, and numbers in the Rice code.
function bitReader(bytes) {
  let at = 0;
  const bit = () => { const value = (bytes[at >> 3] >> (7 - (at & 7))) & 1; at += 1; return value; };
  const number = (count) => { let value = 0; for (let i = 0; i < count; i += 1) value = 2 * value + bit(); return value; };
  const code = (rice) => {
    let ones = 0;
    while (ones < LONG_ONES && bit()) ones += 1;
    const value = ones === LONG_ONES ? number(LONG_BITS) : ones * 2 ** rice + number(rice);
    return value % 2 ? -(value + 1) / 2 : value / 2;
  };
  return { number, code };
}

function frameSteps(liftOff, last, frames) {
  const stance = Math.floor(2 * frames / 3);
  const before = Math.max(Math.ceil(liftOff / (stance - 1)), 1), after = Math.max(Math.ceil((last - liftOff) / (frames - stance)), 1);
  const steps = new Set([0, last]);
  for (let step = liftOff; step > 0; step -= before) steps.add(step);
  for (let step = liftOff; step < last; step += after) steps.add(step);
  return [...steps].sort((a, b) => a - b);
}

function guess(column, sizes, counts, own, steps, i, stepTime) {
  if (i === 0) return 0;
  const last = own[i - 1], since = steps[i] - steps[i - 1];
  if (column.predictor === "last" || (column.predictor === "line" && i === 1)) return last;
  if (column.predictor === "line") {
    const before = steps[i - 1] - steps[i - 2];
    if (since > FAR * before) return last;
    return last + Math.floor((2 * (last - own[i - 2]) * since + before) / (2 * before));
  }
  const rate = counts[column.predictor];
  const both = (rate[i - 1] + rate[i]) / 2 * (sizes[column.predictor] / column.count);
  return last + Math.floor((2 * both * (since * stepTime) + 1) / 2); // halves upward, as in Python
}

// A jump in SI units: lists of time and of every column, and the time of lift-off; null where none is kept.
function unpackedJump(jumps, key) {
  const place = placesOf(jumps).get(key);
  if (!place) return null;
  const reader = bitReader(bytesOfJump(jumps, place));
  const liftOff = reader.number(HEAD_BITS), last = reader.number(HEAD_BITS);
  const steps = frameSteps(liftOff, last, jumps.frames);
  const sizes = Object.fromEntries(jumps.columns.map((column) => [column.name, column.count]));
  const counts = {};
  for (const column of jumps.columns) {
    const own = [];
    for (let i = 0; i < steps.length; i += 1) {
      const off = reader.code(column.rice);
      own.push(off + guess(column, sizes, counts, own, steps, i, jumps.step_s));
    }
    counts[column.name] = own;
  }
  const result = { time_s: steps.map((step) => step * jumps.step_s), lift_off_s: liftOff * jumps.step_s };
  for (const [name, own] of Object.entries(counts)) result[name] = own.map((count) => count * sizes[name]);
  return result;
}

// The jump of a design or case, as from subject(), with the height of its foot; null where the page has none.
function jumpOf(chosen) {
  if (!chosen) return null;
  const { study } = chosen;
  const jump = chosen.kind === "case"
    ? unpackedJump(study.case_jumps, study.cases.findIndex((made) => made.name === chosen.name))
    : unpackedJump(study.jumps, chosen.number);
  if (!jump) return null;
  const { thigh_length_m: thigh, shank_length_m: shank } = chosen.values;
  jump.foot_z_m = jump.base_z_m.map((z, i) => z - thigh * Math.cos(jump.hip_rad[i]) - shank * Math.cos(jump.hip_rad[i] + jump.knee_rad[i]));
  return jump;
}
