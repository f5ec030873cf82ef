// Numbers of the trials: columns that the page has as lists, and others that it has as text, four letters per value.

// A value of a measure or variable, null where there is none.
function valueAt(study, name, row) {
  const { columns, packed } = page.studies[study].trials;
  if (columns[name]) return columns[name][row] ?? null;
  const text = packed?.[name];
  if (text === undefined) return null;
  const bytes = atob(text.slice(4 * row, 4 * row + 4));
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
  if (!unpacked.has(key)) unpacked.set(key, packed?.[name] === undefined ? new Float32Array(trial.length).fill(NaN) : unpack(packed[name]));
  return unpacked.get(key);
}

function unpack(text) {
  const bytes = atob(text);
  const words = new Uint32Array(bytes.length / 3);
  for (let i = 0, k = 0; i < words.length; i += 1, k += 3) words[i] = (bytes.charCodeAt(k) << 8) | (bytes.charCodeAt(k + 1) << 16) | (bytes.charCodeAt(k + 2) << 24);
  return new Float32Array(words.buffer);
}

// The measures and variables that some study has of every trial, in the order of the page's quantities.
const KNOWN = (() => {
  const there = new Set(page.studies.flatMap(({ trials }) => [...Object.keys(trials.columns), ...Object.keys(trials.packed ?? {})]));
  return page.quantities.map((q) => q.name).filter((name) => there.has(name));
})();

function knownNames() { return KNOWN; }
