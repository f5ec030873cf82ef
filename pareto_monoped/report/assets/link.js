// The state as the fragment of the page's address, so that a link or a reload brings the same view back; and undo.
//
// A fragment is "view=1" and then what differs from a new page, such as
//   #view=1&at=0:123&range=height_m:0.9:&range=mass_kg::4&hide=1&keep=0:123:light&x=electrical_energy_j&log=x
// Trials are named by the index of their study and their number, values are in stored units.

const VIEW = "view=1";
const MOMENT_MS = 1000; // changes of one kind within it are one step to undo
const WRITE_MS = 250; // browsers refuse an address that changes hundreds of times in half a minute

function placeOf(study, row) { return `${study}:${page.studies[study].trials.trial[row]}`; }

function numberText(value) { return value === null ? "" : String(Number(value.toPrecision(8))); }

// Key of the fragment -> the texts that it has for a state.
const WRITERS = {
  at: (s) => (s.caseName !== null ? [`${s.study}:case:${encodeURIComponent(s.caseName)}`] : s.row === null ? [] : [placeOf(s.study, s.row)]),
  range: (s) => Object.entries(s.ranges).map(([name, [least, most]]) => `${name}:${numberText(least)}:${numberText(most)}`),
  best: (s) => [s.best.replace(" ", ":")],
  hide: (s) => page.studies.map((_, i) => i).filter((i) => !s.visible.has(i)).map(String),
  without: (s) => [...s.withoutMotors].sort((a, b) => a - b).map(String),
  keep: (s) => s.shortlist.map(({ study, row, note }) => `${placeOf(study, row)}:${encodeURIComponent(note)}`),
  x: (s) => [s.axes.x],
  y: (s) => [s.axes.y],
  colour: (s) => [s.axes.colour],
  size: (s) => [s.axes.size],
  log: (s) => [`${s.axes.logX ? "x" : ""}${s.axes.logY ? "y" : ""}`],
  space: (s) => [s.axes.space ? "1" : ""],
  zoom: (s) => (s.view ? [[...s.view.x, ...s.view.y].map(numberText).join(":")] : []),
  layers: (s) => [Object.keys(s.layers).filter((key) => s.layers[key]).join(",")],
  parallel: (s) => (s.parallel === null ? [] : [s.parallel.join(",")]),
  rows: (s) => [s.table.rows],
  columns: (s) => (s.table.columns === null ? [] : [s.table.columns.join(",")]),
  sort: (s) => [`${s.table.down ? "-" : ""}${s.table.sort}`],
  find: (s) => [encodeURIComponent(s.table.find)],
};

// Key of the fragment -> puts the texts into a state; throws the words that say what is wrong with one.
const READERS = {
  at: (s, [text]) => { Object.assign(s, { row: null, caseName: null }, placeIn(text)); },
  range: (s, texts) => {
    for (const text of texts) {
      const [name, ...ends] = text.split(":");
      if (ends.length !== 2) throw new Error(`range ${text}`);
      const [least, most] = ends.map((end) => (end === "" ? null : Number(end)));
      if ([least, most].some(Number.isNaN) || (least !== null && most !== null && least > most)) throw new Error(`range ${text}`);
      s.ranges[known(name)] = [least, most];
    }
  },
  best: (s, [text]) => {
    const [word, name] = text.split(":");
    s.best = name === undefined ? oneOf(word, ["", "knee", "compromise"]) : `${oneOf(word, ["least", "most"])} ${known(name)}`;
  },
  hide: (s, texts) => { for (const text of texts) s.visible.delete(studyOf(text)); },
  without: (s, texts) => { for (const text of texts) s.withoutMotors.add(oneOf(Number(text), KITS)); },
  keep: (s, texts) => {
    for (const text of texts) {
      const [study, trial, note = ""] = text.split(":");
      s.shortlist.push({ ...trialIn(study, trial), note: decodeURIComponent(note).slice(0, NOTE_MOST) });
    }
    if (texts.length > SHORTLIST_MOST) throw new Error(`${texts.length} designs on the shortlist`);
  },
  x: (s, [text]) => { s.axes.x = axisNamed(text); },
  y: (s, [text]) => { s.axes.y = axisNamed(text); },
  colour: (s, [text]) => { s.axes.colour = text === "" || text === "auto" ? text : axisNamed(text); },
  size: (s, [text]) => { s.axes.size = text && axisNamed(text); },
  log: (s, [text]) => { Object.assign(s.axes, { logX: text.includes("x"), logY: text.includes("y") }); },
  space: (s, [text]) => { s.axes.space = text === "1"; },
  zoom: (s, [text]) => {
    const ends = text.split(":").map(Number);
    if (ends.length !== 4 || !ends.every(Number.isFinite) || ends[0] >= ends[1] || ends[2] >= ends[3]) throw new Error(`zoom ${text}`);
    s.view = { x: ends.slice(0, 2), y: ends.slice(2) };
  },
  layers: (s, [text]) => {
    const wanted = text.split(",").filter(Boolean).map((key) => oneOf(key, Object.keys(s.layers)));
    for (const key of Object.keys(s.layers)) s.layers[key] = wanted.includes(key);
  },
  parallel: (s, [text]) => { s.parallel = [...new Set(text.split(",").filter(Boolean).map(known))]; },
  rows: (s, [text]) => { s.table.rows = oneOf(text, ["front", "all"]); },
  columns: (s, [text]) => { s.table.columns = text.split(",").filter(Boolean).map(known); },
  sort: (s, [text]) => { Object.assign(s.table, { down: text.startsWith("-"), sort: known(text.replace(/^-/, "")) }); },
  find: (s, [text]) => { s.table.find = decodeURIComponent(text); },
};

function oneOf(value, allowed) {
  if (!allowed.includes(value)) throw new Error(String(value));
  return value;
}

function known(name) { return oneOf(name, knownNames()); }

// A measure that trials differ in.
function axisNamed(name) { return oneOf(name, page.axes); }

function studyOf(text) { return oneOf(/^\d+$/.test(text) ? Number(text) : NaN, page.studies.map((_, i) => i)); }

function trialIn(study, trial) {
  const index = studyOf(study);
  const row = page.studies[index].trials.trial.indexOf(/^\d+$/.test(trial) ? Number(trial) : NaN);
  if (row < 0) throw new Error(`trial ${trial}`);
  return { study: index, row };
}

function placeIn(text) {
  const [study, trial, name] = text.split(":");
  if (trial !== "case") return trialIn(study, trial);
  return { study: studyOf(study), caseName: oneOf(decodeURIComponent(name ?? ""), page.studies[studyOf(study)].cases.map((c) => c.name)) };
}

// The fragment of a state: of each key only what a new page would not have.
function fragmentOf(s) {
  const fresh = freshState();
  const parts = Object.entries(WRITERS).flatMap(([key, texts]) => {
    const own = texts(s);
    return own.join("&") === texts(fresh).join("&") ? [] : own.map((text) => `${key}=${text}`);
  });
  return [VIEW, ...parts].join("&");
}

// The state of a fragment; an Error with the damaged part in words.
function stateOf(fragment) {
  const result = freshState();
  const given = {};
  for (const part of fragment.split("&").slice(1)) {
    const [, key, text] = /^([^=]*)=(.*)$/s.exec(part) ?? [null, part, ""];
    if (!Object.hasOwn(READERS, key)) throw new Error(key);
    (given[key] ??= []).push(text);
  }
  for (const [key, texts] of Object.entries(given)) READERS[key](result, texts);
  return result;
}

// Undo: the fragments of the states so far, and the place among them; and the address as it was last read or written.
const past = { steps: [], at: -1, kind: "", time: 0, writing: 0, address: "" };

function remember(kind = "") {
  const fragment = fragmentOf(state);
  if (past.at >= 0 && fragment === past.steps[past.at]) return;
  const now = performance.now();
  const same = kind !== "" && kind === past.kind && now - past.time < MOMENT_MS && past.at > 0;
  past.steps.length = past.at + 1;
  if (same) past.steps[past.at] = fragment;
  else past.at = past.steps.push(fragment) - 1;
  Object.assign(past, { kind, time: now });
  writeSoon();
}

function undo() { goTo(past.at - 1); }

function redo() { goTo(past.at + 1); }

function resetState() { restore(freshState()); remember(); }

function goTo(at) {
  if (at < 0 || at >= past.steps.length) return;
  Object.assign(past, { at, kind: "" });
  restore(stateOf(past.steps[at]));
  writeSoon();
}

// Every part hears of everything, as if the page began with this state.
function restore(next) {
  const other = next.study !== state.study;
  Object.assign(state, next);
  for (const event of ["conditions", "axes", "layers", "table", "parallel", "shortlist"]) tell(event, { final: true });
  tell("selection", { byUser: false, other });
  tell("view");
}

function writeSoon() {
  showSteps();
  clearTimeout(past.writing);
  past.writing = setTimeout(writeNow, WRITE_MS);
}

function writeNow() {
  clearTimeout(past.writing);
  past.writing = 0;
  const fragment = past.steps[past.at];
  // Another address is that of a link that was just followed: it is still to be read.
  if (location.hash !== past.address) return;
  if (location.hash.slice(1) !== fragment && (past.at > 0 || isView())) history.replaceState(null, "", `#${fragment}`);
  past.address = location.hash;
}

function showSteps() {
  byId("undo").disabled = past.at <= 0;
  byId("redo").disabled = past.at >= past.steps.length - 1;
}

function isView() { return location.hash.slice(1, 1 + VIEW.length) === VIEW; }

// The state in the address, if it is one; a damaged one is left alone with one line.
function readAddress() {
  past.address = location.hash;
  if (!isView()) return null;
  try {
    const found = stateOf(location.hash.slice(1));
    byId("page-note").textContent = "";
    return found;
  } catch (error) {
    byId("page-note").textContent = `The view in this page's address is damaged or of another report (${error.message.slice(0, 60)}): it is left out.`;
    return null;
  }
}

function startLink() {
  const found = readAddress();
  if (found) Object.assign(state, found);
  remember();
  byId("undo").addEventListener("click", undo);
  byId("redo").addEventListener("click", redo);
  byId("reset").addEventListener("click", resetState);
  byId("copy-link").addEventListener("click", async () => {
    writeNow();
    byId("page-note").textContent = await copied(`${location.href.split("#")[0]}#${past.steps[past.at]}`) ? "The link to this view is copied." : "Copy the address of this page: it holds the view.";
  });
  window.addEventListener("hashchange", () => {
    const next = readAddress();
    if (next) { restore(next); remember(); }
  });
  for (const [target, event] of [[window, "pagehide"], [document, "visibilitychange"]]) target.addEventListener(event, () => { if (past.writing) writeNow(); });
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target.closest("textarea, input:not([type=checkbox]):not([type=range])")) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) redo();
    else undo();
  });
  // Links within the page move the view and keep the state in the address.
  document.addEventListener("click", (event) => {
    const link = event.target.closest("a[href^='#']");
    const target = link && document.getElementById(link.getAttribute("href").slice(1));
    if (!target) return;
    event.preventDefault();
    target.scrollIntoView();
    if (!target.hasAttribute("tabindex")) target.setAttribute("tabindex", "-1");
    target.focus({ preventScroll: true });
  });
}
