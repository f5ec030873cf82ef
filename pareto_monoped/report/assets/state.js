// The state of the page: one store that every part reads, and changes only by the functions below.
//
// What it holds
//   state.study, .row, .caseName  the selection: a study's index with a row of its trials, or with the name of a case
//   state.visible                 Set of the indices of the studies shown
//   state.withoutMotors           Set of the kits of motors whose designs are not wanted
//   state.best                    the way to choose: "", "knee", "compromise", "least NAME" or "most NAME" (choose.js)
//   state.ranges                  { measure or variable: [least, most] } in stored units (SI); null: that side is open
//   state.shortlist               [{ study, row, note }], at most SHORTLIST_MOST
//   state.axes                    { x, y, colour, size: a measure or variable, logX, logY, space: booleans };
//                                 colour "auto": a third objective, else the study or the motor; size "": all alike
//   state.view                    { x: [low, high], y: [low, high] } as shown where the front chart is zoomed, else null
//   state.layers                  what the front chart shows: { front, cloud, infeasible, ... : boolean }
//   state.parallel                names of the axes of the parallel coordinates from left to right, or null: the usual ones
//   state.table                   { rows: "front" or "all", columns: names or null, sort: name, down: boolean, find }
//
// It is read and changed by the functions under the headings below.
//
// To hear of changes: on(event, listener)
//   "selection" { byUser, other: another study }, "conditions" { final }, "axes", "layers", "shortlist", "table",
//   "parallel", "time" (of the player), and "view": what charts show has changed (conditions at their end, axes or layers).
// Every change is kept in the fragment of the page's address and can be undone (link.js). A new field needs its default
// in freshState() and its words in WRITERS and READERS there; parts then only listen to its event.

const SHORTLIST_MOST = 6;
const NOTE_MOST = 200; // letters of a note: six of them still fit into any browser's address

function freshState() {
  const [study, row] = firstSelection();
  return {
    study, row, caseName: null,
    visible: new Set(page.studies.map((_, i) => i)), withoutMotors: new Set(), ranges: {}, best: "", shortlist: [], view: null,
    axes: { x: SECOND, y: FIRST, colour: "auto", size: "", logX: false, logY: false, space: false },
    layers: { front: true, cloud: true, infeasible: false, published: true, simulated: true, picks: true, floor: true, spread: true, robust: true, best: true },
    parallel: null,
    table: { rows: "front", columns: null, sort: FIRST, down: false, find: "" },
  };
}

// The knee of the first front; without a front the first trial.
function firstSelection() {
  const study = page.studies.findIndex((s) => s.front.length);
  if (study >= 0) {
    const { picks, front } = page.studies[study];
    return [study, (picks[0] ?? { row: front[0] }).row];
  }
  const any = page.studies.findIndex((s) => s.trials.trial.length);
  return any >= 0 ? [any, 0] : [0, null];
}

const state = freshState();
const listeners = { selection: [], conditions: [], axes: [], layers: [], shortlist: [], table: [], parallel: [], time: [], view: [] };

function on(event, listener) { listeners[event].push(listener); }

function tell(event, detail = {}) { for (const listener of listeners[event]) listener(detail); }

// Selection.

function current() { return page.studies[state.study]; }

function place() { return state.row === null ? -1 : current().front.indexOf(state.row); }

function select(study, row, byUser = true) { moveSelection({ study, row, caseName: null }, byUser); }

function selectCase(study, name) { moveSelection({ study, row: null, caseName: name }, true); }

function moveSelection(selected, byUser) {
  const other = selected.study !== state.study;
  Object.assign(state, selected);
  tell("selection", { byUser, other });
  remember("selection");
}

// Steps along the designs of the selected study's front that obey the conditions.
function moveAlongFront(steps) {
  if (!state.visible.has(state.study)) { moveToStudy(1); return; }
  const { trials } = current();
  const front = keptFront(state.study);
  if (!front.length) return;
  let at = front.indexOf(state.row);
  if (at < 0 && Number.isFinite(steps)) {
    // From a design elsewhere to the next one here in the direction of the step.
    const value = subject()?.measures[FIRST] ?? 0;
    const firsts = front.map((row) => trials.columns[FIRST][row]);
    at = steps > 0 ? firsts.findIndex((first) => first >= value) : firsts.findLastIndex((first) => first <= value);
    if (at < 0) at = steps > 0 ? front.length - 1 : 0;
    steps = 0;
  }
  select(state.study, front[Math.min(Math.max(at + steps, 0), front.length - 1)]);
}

// To the design of the next or previous study shown whose first objective is closest to the selection's.
function moveToStudy(step) {
  const count = page.studies.length;
  const wanted = subject()?.measures[FIRST] ?? 0;
  for (let k = 1; k <= count; k += 1) {
    const study = (state.study + step * k + count * k) % count;
    const rows = state.visible.has(study) ? keptFront(study) : [];
    if (!rows.length) continue;
    const away = (row) => Math.abs(page.studies[study].trials.columns[FIRST][row] - wanted);
    if (study !== state.study) select(study, rows.reduce((best, row) => (away(row) < away(best) ? row : best)));
    return;
  }
}

// Conditions.

// Whether ranges or motors keep some designs out.
function filtered() { return Object.keys(state.ranges).length > 0 || state.withoutMotors.size > 0; }

// Whether a trial obeys the ranges and is of a motor wanted.
function inRanges(study, row) { return masked(study)[row] === 1; }

// While a range is dragged it is not final: only what is quick to draw follows.
function setRange(name, range, final = true) {
  if (range && (range[0] !== null || range[1] !== null)) state.ranges[name] = range;
  else delete state.ranges[name];
  changed("conditions", { final }, `range ${name}`);
}

function clearConditions() {
  state.ranges = {};
  state.withoutMotors = new Set();
  changed("conditions", { final: true });
}

function setBest(way) { state.best = way; changed("conditions", { final: true }); }

function showStudy(study, shown) { put(state.visible, study, shown); changed("conditions", { final: true }); }

function showMotor(kit, shown) { put(state.withoutMotors, kit, !shown); changed("conditions", { final: true }); }

function put(set, entry, there) {
  if (there) set.add(entry);
  else set.delete(entry);
}

// Axes, layers, table.

function setAxes(axes) { Object.assign(state.axes, axes); state.view = null; changed("axes"); }

function setView(view) { state.view = view; remember("view"); }

function showLayer(key, shown) { state.layers[key] = shown; changed("layers"); }

function setParallel(names) { state.parallel = names; changed("parallel", {}, "parallel"); }

function setTable(table) { Object.assign(state.table, table); changed("table", {}, `table ${Object.keys(table)}`); }

// Shortlist.

function shortlisted(study, row) { return state.shortlist.findIndex((one) => one.study === study && one.row === row); }

// Returns whether there was room.
function keep(study, row) {
  if (shortlisted(study, row) >= 0) return true;
  if (state.shortlist.length >= SHORTLIST_MOST) return false;
  state.shortlist.push({ study, row, note: "" });
  changed("shortlist");
  return true;
}

function drop(study, row) {
  state.shortlist = state.shortlist.filter((one) => one.study !== study || one.row !== row);
  changed("shortlist");
}

function setNote(study, row, text) {
  const at = shortlisted(study, row);
  if (at < 0) return;
  state.shortlist[at].note = text.slice(0, NOTE_MOST);
  changed("shortlist", {}, `note ${study} ${row}`);
}

// Tells of a change and remembers it; changes of one kind within a moment are one step to undo.
function changed(event, detail = {}, kind = "") {
  tell(event, detail);
  if (detail.final === false) return;
  if (event === "conditions" || event === "axes" || event === "layers") tell("view");
  remember(kind);
}

// Kits of motors.

function kitOf(study, row) { return study.trials.columns.motor?.[row] ?? study.kit; }

function motorOf(study, row) { return page.kits[kitOf(study, row)].motor; }

// The leg that fits a kit of motors.
function legOf(kit) { return page.kits[kit].leg ?? page.maps[page.kits[kit].hip].leg; }

// The kits of motors that the designs of some study choose from; none where each study has one.
const KITS = [...new Set(page.studies.flatMap((study) => (study.trials.columns.motor ? Object.keys(study.motor_names).map(Number) : [])))];
// Where there are more than colours, only those on a front.
const MOTORS = KITS.length <= 6 ? KITS : KITS.filter((kit) => page.studies.some((study) => study.front.some((row) => study.trials.columns.motor?.[row] === kit)));

// The measure that colours show; null: the study or the motor.
function tinted() {
  if (state.axes.colour !== "auto") return state.axes.colour || null;
  return page.objectives.length > 2 ? page.objectives.slice(1).find((name) => name !== state.axes.x) : null;
}
