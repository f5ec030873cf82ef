// Numbers of the trials: columns that the page has as lists, and others in single precision.

// A value of a measure or variable, null where there is none; an unknown name is an error.
function valueAt(study, name, row) { return finite(columnOf(study, name)[row]); }

function finite(value) { return Number.isFinite(value) ? value : null; }

const unpacked = new Map();

// All values of a measure or variable of a study, one per trial; NaN where there is none.
function columnOf(study, name) { return once(unpacked, `${study} ${name}`, () => madeColumn(page.studies[study], name)); }

function madeColumn({ trials: { columns, packed, trial }, robust }, name) {
  if (columns[name]) return ArrayBuffer.isView(columns[name]) ? columns[name] : Float32Array.from(columns[name], (value) => value ?? NaN);
  if (packed?.[name]) return unpack(packed[name]);
  // What is under uncertainty is there of some trials only.
  const values = new Float32Array(trial.length).fill(NaN);
  if (robust?.packed[name]) unpack(robust.packed[name]).forEach((value, k) => { values[robust.rows[k]] = value; });
  else void quantity[name.split(".")[0]];
  return values;
}

function unpack({ at, count }) { return new Float32Array(content, at, count); }

for (const { trials: { columns } } of page.studies) for (const [name, given] of Object.entries(columns)) if (!Array.isArray(given)) columns[name] = unpack(given);

// The measures and variables that some study has of every trial, in the order of the page's quantities.
const KNOWN = (() => {
  const there = new Set(page.studies.flatMap(({ trials, robust }) => [...Object.keys(trials.columns), ...Object.keys(trials.packed ?? {}), ...Object.keys(robust?.packed ?? {})]));
  return page.quantities.map((q) => q.name).filter((name) => there.has(name));
})();

function knownNames() { return KNOWN; }

// Those that trials differ in.
function axisNames() { return KNOWN.filter((name) => page.axes.includes(name)); }
