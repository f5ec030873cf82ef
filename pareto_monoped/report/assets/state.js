// What is selected, and which studies, axes and ranges are shown; everything else listens to it.

const state = { across: SECOND, study: 0, row: null, caseName: null, visible: new Set(page.studies.map((_, i) => i)), ranges: {}, withoutMotors: new Set() };
const listeners = { selection: [], view: [], time: [] };

function on(event, listener) { listeners[event].push(listener); }

function tell(event, detail) { for (const listener of listeners[event]) listener(detail); }

function current() { return page.studies[state.study]; }

function select(study, row, byUser = true) {
  const other = study !== state.study;
  Object.assign(state, { study, row, caseName: null });
  tell("selection", { byUser, other });
}

function selectCase(study, name) {
  const other = study !== state.study;
  Object.assign(state, { study, row: null, caseName: name });
  tell("selection", { byUser: true, other });
}

// Place of the selection on its study's front, -1 if it is not there.
function place() { return state.row === null ? -1 : current().front.indexOf(state.row); }

function moveAlongFront(steps) {
  const { front, trials } = current();
  if (!front.length) return;
  let at = place();
  if (at < 0 && Number.isFinite(steps)) {
    // From a design off the front to the first one on it that has at least as much of the first objective.
    const first = state.row === null ? 0 : trials.columns[FIRST][state.row] ?? 0;
    at = front.findIndex((row) => trials.columns[FIRST][row] >= first);
    if (at < 0) at = front.length - 1;
    steps = 0;
  }
  select(state.study, front[Math.min(Math.max(at + steps, 0), front.length - 1)]);
}

// Number of a trial's kit of motors.
function kitOf(study, row) { return study.trials.columns.motor?.[row] ?? study.kit; }

function motorOf(study, row) { return page.kits[kitOf(study, row)].motor; }

// The leg that fits a kit of motors.
function legOf(kit) { return page.kits[kit].leg ?? page.maps[page.kits[kit].hip].leg; }

// The kits of motors that the designs of some study choose from; none where each study has one.
const KITS = [...new Set(page.studies.flatMap((study) => (study.trials.columns.motor ? Object.keys(study.motor_names).map(Number) : [])))];
// Where there are more than colours, only those on a front.
const MOTORS = KITS.length <= 6 ? KITS : KITS.filter((kit) => page.studies.some((study) => study.front.some((row) => study.trials.columns.motor?.[row] === kit)));

// Whether something keeps designs out: a range of an axis, or a motor that is not wanted.
function filtered() { return Object.keys(state.ranges).length > 0 || state.withoutMotors.size > 0; }

function inRanges(study, row) {
  const columns = page.studies[study].trials.columns;
  if (columns.motor && state.withoutMotors.has(columns.motor[row])) return false;
  for (const [name, [low, high]] of Object.entries(state.ranges)) {
    const value = columns[name][row];
    if (value === null || value < low || value > high) return false;
  }
  return true;
}

// The third objective of the page, which is then the colour, whichever of the others is to the right; null without one.
function tinted() { return page.objectives.length > 2 ? page.objectives.slice(1).find((name) => name !== state.across) : null; }

// The selection as one object, a trial or one of the paper's cases.
function subject() {
  const study = current();
  if (state.caseName !== null) {
    const at = study.cases.findIndex((c) => c.name === state.caseName);
    const made = study.cases[at];
    const published = page.published.find((c) => c.name === state.caseName);
    const values = published.design;
    return {
      kind: "case", study, name: made.name, values, measures: { ...made.measures, ...made }, more: {}, jump: made.jump, status: made.status,
      kit: study.kit, hip: page.gearboxes[study.case_gearboxes.hip[at]] ?? null, knee: page.gearboxes[study.case_gearboxes.knee[at]] ?? null, published,
      why: `published: ${published.height_m.toFixed(3)} m on ${published.energy_j.toFixed(2)} J`,
    };
  }
  if (state.row === null) return null;
  const { columns } = study.trials;
  const row = state.row;
  const number = study.trials.trial[row];
  const values = Object.fromEntries(page.variables.map((v) => [v.name, columns[v.name][row]]));
  const at = place();
  const measures = Object.fromEntries(Object.entries(columns).map(([name, list]) => [name, list[row]]));
  const more = at < 0 ? {} : Object.fromEntries(Object.entries(study.more).map(([name, list]) => [name, list[at]]));
  const picked = study.picks.find((p) => p.row === row);
  const letter = study.trials.state[row];
  const ill = study.ill_conditioned.includes(row);
  let why = `on the front, ${at + 1} of ${study.front.length}`;
  if (picked) why = picked.why.replace(/^trial \d+ \(.*?\): /, "");
  else if (ill) why = "taken off the front by its audit";
  else if (at < 0) why = { f: "feasible, but dominated", i: "infeasible: breaks a constraint", x: "failed: no jump" }[letter];
  return {
    kind: "trial", study, number, row, values, measures, more, at, why, letter, kit: kitOf(study, row),
    jump: study.jumps[number] ?? null, audit: study.audits[number] ?? null, model: study.models[number] ?? null,
    hip: page.gearboxes[columns.hip_gearbox[row]] ?? null, knee: page.gearboxes[columns.knee_gearbox[row]] ?? null,
  };
}
