// Numbers of the trials: columns that the page has as lists, and others that it has as text, four letters per value.

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
  const bytes = atob(text.slice(4 * at, 4 * at + 4));
  return finite(floatOf(bytes.charCodeAt(0) | (bytes.charCodeAt(1) << 8) | (bytes.charCodeAt(2) << 16)));
}

const bits = new DataView(new ArrayBuffer(4));

// The upper three bytes of a number in single precision: its lowest byte is not kept.
function floatOf(upper) {
  bits.setUint32(0, (upper << 8) >>> 0);
  return bits.getFloat32(0);
}

function finite(value) { return Number.isFinite(value) ? value : null; }

const unpacked = new Map();

// All values of a measure or variable of a study, one per trial; null or NaN where there is none.
function columnOf(study, name) {
  const { columns, packed, trial } = page.studies[study].trials;
  if (columns[name]) return columns[name];
  const key = `${study} ${name}`;
  if (!unpacked.has(key)) unpacked.set(key, robustColumn(study, name) ?? (packed?.[name] === undefined ? new Float32Array(trial.length).fill(NaN) : unpack(packed[name])));
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
  const bytes = atob(text);
  const words = new Uint32Array(bytes.length / 3);
  for (let i = 0, k = 0; i < words.length; i += 1, k += 3) words[i] = (bytes.charCodeAt(k) << 8) | (bytes.charCodeAt(k + 1) << 16) | (bytes.charCodeAt(k + 2) << 24);
  return new Float32Array(words.buffer);
}

// The measures and variables that some study has of every trial, in the order of the page's quantities.
const KNOWN = (() => {
  const there = new Set(page.studies.flatMap(({ trials, robust }) => [...Object.keys(trials.columns), ...Object.keys(trials.packed ?? {}), ...Object.keys(robust?.packed ?? {})]));
  return page.quantities.map((q) => q.name).filter((name) => there.has(name));
})();

function knownNames() { return KNOWN; }
