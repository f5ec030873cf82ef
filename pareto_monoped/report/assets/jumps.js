// The jumps of the designs, read when one is asked for; report/packing.py says how they are packed.

// A jump in SI units: lists of time and of every column, and the time of lift-off; null where none is kept.
function unpackedJump({ keys, data, counts, frames, lift_off_s }, key) {
  const at = keys.indexOf(key), names = Object.keys(counts), result = { lift_off_s: lift_off_s[at] }, changes = new Int16Array(content, data.at, data.count);
  if (at < 0) return null;
  const own = (k) => changes.subarray((at * names.length + k) * frames, (at * names.length + k + 1) * frames);
  // A jump of fewer moments ends where time stands still.
  const length = own(0).filter((step) => step).length + 1;
  names.forEach((name, k) => {
    let count = 0;
    result[name] = Array.from(own(k).subarray(0, length), (change) => { count += change; return count * counts[name]; });
  });
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
