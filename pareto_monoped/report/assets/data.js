// Numbers of the trials: columns that the page has as lists, and others that it has as text, in single precision.

// A value of a measure or variable, null where there is none; an unknown name is an error.
function valueAt(study, name, row) {
  const { columns, packed } = page.studies[study].trials;
  if (columns[name]) return columns[name][row] ?? null;
  let [text, at] = [packed?.[name], row];
  // What is under uncertainty is there of some trials only.
  const robust = page.studies[study].robust;
  if (robust?.packed[name] !== undefined) [text, at] = [robust.packed[name], robust.rows.indexOf(row)];
  if (text === undefined) void quantity[name.split(".")[0]];
  if (text === undefined || at < 0) return null;
  // Three values are sixteen letters.
  return finite(unpack(text.slice(16 * Math.floor(at / 3), 16 * Math.floor(at / 3) + 16))[at % 3]);
}

function finite(value) { return Number.isFinite(value) ? value : null; }

const unpacked = new Map();

// All values of a measure or variable of a study, one per trial; NaN where there is none.
function columnOf(study, name) {
  const { columns, packed, trial } = page.studies[study].trials;
  const key = `${study} ${name}`;
  if (!unpacked.has(key)) {
    const none = () => new Float32Array(trial.length).fill(NaN);
    unpacked.set(key, columns[name] ? Float32Array.from(columns[name], (value) => value ?? NaN) : robustColumn(study, name) ?? (packed?.[name] === undefined ? none() : unpack(packed[name])));
  }
  return unpacked.get(key);
}

// The same of a measure under uncertainty, NaN for the trials without it; undefined where the study has none.
function robustColumn(study, name) {
  const { robust, trials } = page.studies[study];
  if (robust?.packed[name] === undefined) return undefined;
  const values = new Float32Array(trials.trial.length).fill(NaN);
  unpack(robust.packed[name]).forEach((value, k) => { values[robust.rows[k]] = value; });
  return values;
}

function unpack(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return new Float32Array(bytes.buffer);
}

for (const { trials: { columns } } of page.studies) {
  for (const [name, text] of Object.entries(columns)) if (typeof text === "string") columns[name] = Array.from(unpack(text), finite);
}

// The measures and variables that some study has of every trial, in the order of the page's quantities.
const KNOWN = (() => {
  const there = new Set(page.studies.flatMap(({ trials, robust }) => [...Object.keys(trials.columns), ...Object.keys(trials.packed ?? {}), ...Object.keys(robust?.packed ?? {})]));
  return page.quantities.map((q) => q.name).filter((name) => there.has(name));
})();

function knownNames() { return KNOWN; }
