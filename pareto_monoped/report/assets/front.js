// The front: the first objective upward, another to the right, a third as colour; click a point to select it.

const CELL_PX = 3; // cells of this size show at most one trial of the cloud
const MOST_DRAWN = 4000;
const gd = byId("front-chart");
const ring = make("div", { class: "ring", "aria-hidden": "true" });
let points = []; // for each trace, what its points stand for: [study, row] or [study, case name]

// What a column or a case has on an axis, in the unit shown; null where it has nothing.
function inShown(name, value) { return value === null || value === undefined ? null : value * quantity[name].scale; }

function ofCase(made, name) { return inShown(name, made[name] ?? made.measures[name]); }

// Work against gravity is a floor of these energies.
function hasFloor() { return FIRST === "height_m" && ["energy_j", "electrical_energy_j"].includes(state.axes.x); }

function papersAxes() { return FIRST === "height_m" && state.axes.x === "energy_j"; }

function startRange() {
  const x = [], y = [];
  const see = (across, up) => {
    if (across === null || up === null) return;
    x.push(across);
    y.push(up);
  };
  for (const study of page.studies) {
    const { [state.axes.x]: e, [FIRST]: h } = study.trials.columns;
    const rows = study.front.length ? study.front : study.trials.trial.map((_, row) => row);
    for (const row of rows) see(inShown(state.axes.x, e[row]), inShown(FIRST, h[row]));
    for (const made of study.cases) see(ofCase(made, state.axes.x), ofCase(made, FIRST));
  }
  if (papersAxes()) for (const made of page.published) see(made.energy_j, made.height_m);
  if (FIRST === "height_m") y.push(START_HEIGHT + 0.05, START_HEIGHT + 0.1);
  const [low, high] = extent(y);
  const room = 0.06 * (high - low) || 1e-3;
  // With a floor, which begins at no energy, so does the chart.
  return { x: hasFloor() ? [0, extent(x)[1] * 1.06] : padded(extent(x)), y: [low - room, high + room] };
}

let home = null;

function viewRange() {
  const full = gd._fullLayout;
  return full ? { x: full.xaxis.range, y: full.yaxis.range } : home;
}

// What is drawn over the cloud, and how many cells it covers to each side of its own.
function marks() {
  return [...state.visible].flatMap((study) => {
    const { cases, front, trials: { columns: { [state.axes.x]: e, [FIRST]: h } } } = page.studies[study];
    const designs = state.layers.front ? front.map((row) => ({ x: inShown(state.axes.x, e[row]), y: inShown(FIRST, h[row]), cells: 1 })) : [];
    const paper = state.layers.simulated ? cases.map((made) => ({ x: ofCase(made, state.axes.x), y: ofCase(made, FIRST), cells: 2 })) : [];
    return [...designs, ...paper];
  });
}

// One row per small cell of the view: as many as can be told apart.
function thinned(study, letter, skip) {
  const { state: letters, columns: { [state.axes.x]: e, [FIRST]: h } } = page.studies[study].trials;
  const { x, y } = viewRange();
  const toX = quantity[state.axes.x].scale, toY = quantity[FIRST].scale;
  const columns = Math.max(Math.floor((gd.clientWidth - 72) / CELL_PX), 50);
  const rows = Math.max(Math.floor((gd.clientHeight - 60) / CELL_PX), 50);
  const seen = new Set();
  const cellAt = (u, v) => Math.floor(u * columns) * rows + Math.floor(v * rows);
  // Nothing is drawn under a mark: a small point there would take the mark's clicks.
  for (const mark of marks()) {
    const u = (mark.x - x[0]) / (x[1] - x[0]), v = (mark.y - y[0]) / (y[1] - y[0]);
    for (let i = -mark.cells; i <= mark.cells; i += 1) for (let j = -mark.cells; j <= mark.cells; j += 1) seen.add(cellAt(u + i / columns, v + j / rows));
  }
  const kept = [];
  let within = 0;
  for (let row = 0; row < letters.length; row += 1) {
    if (letters[row] !== letter || skip.has(row) || e[row] === null || h[row] === null) continue;
    const u = (e[row] * toX - x[0]) / (x[1] - x[0]), v = (h[row] * toY - y[0]) / (y[1] - y[0]);
    if (u < 0 || u > 1 || v < 0 || v > 1) continue;
    within += 1;
    const cell = cellAt(u, v);
    if (seen.has(cell)) continue;
    seen.add(cell);
    kept.push(row);
  }
  const every = Math.max(Math.ceil(kept.length / MOST_DRAWN), 1);
  return { rows: every === 1 ? kept : kept.filter((_, i) => i % every === 0), within };
}

function hoverText(study, row) {
  const card = page.studies[study];
  const { columns, trial } = card.trials;
  const lines = [`<b>trial ${trial[row]}</b>${page.studies.length > 1 ? `, ${plain(card.label)}` : ""}`];
  if (PAPERS_OWN) lines.push(told(page.objectives, (name) => columns[name][row]));
  const named = PAPERS_OWN ? page.goals.filter((name) => !page.objectives.includes(name)) : page.goals;
  for (const name of named) lines.push(`${plain(quantity[name].label)} ${shown(name, columns[name][row])}`);
  for (const variable of page.variables) lines.push(`${quantity[variable.name].label} ${shown(variable.name, columns[variable.name][row])}`);
  if (columns.motor) lines.push(`motor ${plain(motorOf(card, row))}`);
  return lines.join("<br>");
}

function trace(name, entries, marker, more = {}) {
  // entries: { x, y, text, stands }
  points.push(entries.map((entry) => entry.stands));
  return {
    type: "scatter", mode: "markers", name, x: entries.map((p) => p.x), y: entries.map((p) => p.y),
    text: entries.map((p) => p.text), hovertemplate: "%{text}<extra></extra>", marker, ...more,
  };
}

function rowsOf(study, rows) {
  const { [state.axes.x]: e, [FIRST]: h } = page.studies[study].trials.columns;
  return rows.map((row) => ({ x: inShown(state.axes.x, e[row]), y: inShown(FIRST, h[row]), text: hoverText(study, row), stands: [study, row] }));
}

function traces() {
  points = [];
  const list = [];
  const ranged = filtered();
  const several = page.studies.length > 1;
  let drawn = 0, within = 0;
  const each = [...state.visible];
  for (const study of each) {
    const card = page.studies[study];
    const onFront = new Set(card.front);
    const tint = several ? studyColour(study) : colour("cloud");
    for (const [letter, wanted] of [["f", state.layers.cloud], ["i", state.layers.infeasible]]) {
      if (!wanted) continue;
      const cloud = thinned(study, letter, onFront);
      drawn += cloud.rows.length;
      within += cloud.within;
      const opacity = cloud.rows.map((row) => (!ranged || inRanges(study, row) ? (ranged ? 0.75 : 0.38) : 0.06));
      const marker = letter === "f"
        ? { size: 4.5, color: tint, opacity }
        : { size: 6, symbol: "x-thin", line: { width: 1.2, color: colour("bad") }, opacity };
      list.push(trace(letter === "f" ? "dominated" : "infeasible", rowsOf(study, cloud.rows), marker));
    }
  }
  if (state.layers.floor && hasFloor()) {
    const masses = each.map((i) => page.studies[i].floor_mass_kg).filter((m) => m !== null);
    if (masses.length) {
      const mass = Math.min(...masses), end = viewRange().x[1] * 4;
      const line = [0, end].map((e) => ({ x: e, y: START_HEIGHT + e / (mass * GRAVITY), text: "", stands: null }));
      list.push(trace("floor", line, {}, { mode: "lines", hoverinfo: "skip", hovertemplate: undefined, line: { color: colour("faint"), width: 1.5, dash: "dot" } }));
    }
  }
  for (const study of each) {
    const card = page.studies[study];
    if (!state.layers.front) continue;
    const tint = studyColour(study);
    const opacity = card.front.map((row) => (inRanges(study, row) ? 1 : 0.15));
    const marker = { size: 7.5, symbol: MARKS[study % 6], color: tint, opacity, line: { width: 0.8, color: colour("card") } };
    if (card.trials.columns.motor) {
      // Motors differ in colour and in mark: a third objective takes the colour.
      const motors = card.front.map((row) => motorTint(kitOf(card, row)));
      Object.assign(marker, { symbol: motors.map((k) => MARKS[k]), color: motors.map((k) => colour(`c${k}`)) });
    }
    const third = tinted();
    if (third) Object.assign(marker, colourOf(study, third, list));
    // A line of steps joins designs that hold until the next one is reached; on other axes than its own a front is none.
    const own = card.objectives.length === 2 && card.objectives.includes(FIRST) && card.objectives.includes(state.axes.x);
    const steps = page.directions[FIRST] === "maximise" ? "hv" : "vh";
    list.push(trace("front", rowsOf(study, card.front), marker,
      own ? { mode: "lines+markers", line: { shape: steps, width: 1.2, color: tint } } : { mode: "markers" }));
    if (card.weighted.length) {
      const rows = rowsOf(study, card.weighted.map(([, row]) => row));
      rows.forEach((entry, i) => { entry.text = `weighted search, ${FIRST === "height_m" ? "height" : plain(quantity[FIRST].label)} weight ${card.weighted[i][0]}<br>${entry.text}`; });
      list.push(trace("weighted", rows, { size: 12, symbol: "square-open", color: tint, line: { width: 2, color: tint } }));
    }
  }
  if (state.layers.picks) {
    for (const study of each.toReversed()) {
      const picks = page.studies[study].picks.filter((p) => p.name === "knee");
      const entries = rowsOf(study, picks.map((p) => p.row));
      entries.forEach((entry, i) => { entry.text = `<b>knee</b><br>${entry.text}`; entry.label = picks[i].name; });
      list.push(trace("picks", entries, { size: 15, symbol: "star", color: colour("c4"), line: { width: 1, color: colour("ink") } }));
    }
  }
  const paper = (entries, name, symbol) => list.push(trace(name, entries,
    { size: 11, symbol, color: entries.map((p) => p.tint ?? colour("paper")), line: { width: 1.8, color: colour("paper") } },
    { mode: "markers", customdata: entries.map((p) => p.label) }));
  if (state.layers.published && papersAxes()) {
    paper(page.published.map((c) => ({
      x: c.energy_j, y: c.height_m, label: c.name, stands: null,
      text: `<b>paper, ${c.name}</b>, as published<br>${round(c.height_m)} m on ${round(c.energy_j, 2)} J`,
    })), "published", "diamond-open");
  }
  if (state.layers.simulated) {
    const seen = new Set();
    const entries = [];
    for (const study of each) {
      const card = page.studies[study];
      const key = `${card.case_motor} ${card.calibration}`;
      if (seen.has(key)) continue;
      seen.add(key);
      for (const c of card.cases) {
        const across = ofCase(c, state.axes.x), up = ofCase(c, FIRST);
        if (up === null || across === null) continue;
        // Only the first motor's have names; the others are in the same order and have their study's colour.
        entries.push({
          x: across, y: up, label: seen.size === 1 ? c.name : "", stands: [study, c.name],
          tint: seen.size === 1 ? colour("paper") : studyColour(study),
          text: `<b>paper, ${c.name}</b>, simulated here<br>${plain(told([FIRST, state.axes.x], (name) => c[name] ?? c.measures[name]))}<br>motor ${plain(card.case_motor)}, calibration ${plain(card.calibration)}`,
        });
      }
    }
    paper(entries, "simulated", "diamond");
  }
  const left = page.studies.reduce((sum, s) => sum + s.trials.total - s.trials.trial.length, 0);
  let note = within > drawn ? `${drawn} of the ${within} dominated or infeasible designs in view are drawn, at most one per ${CELL_PX} px; zoom in to see more.` : "";
  if (left) note += ` ${left} dominated trials are left out of this page to keep it small; every count includes them.`;
  byId("front-note").textContent = note;
  return list;
}

// Names beside the paper's diamonds and the knee, where they cover neither each other nor another of these marks.
function labels(list) {
  const { x, y } = viewRange();
  const width = Math.max(gd.clientWidth - 72, 100), height = Math.max(gd.clientHeight - 72, 100);
  const lastPicks = list.findLast((t) => t.name === "picks");
  const marks = list.flatMap((one) => {
    if (one.name !== "picks" && !one.customdata) return [];
    // The knees of several studies lie close together: only the one drawn last has its name beside it.
    const name = (i) => (one.name !== "picks" ? one.customdata[i] : one === lastPicks ? "knee" : "");
    return one.x.map((value, i) => ({
      x: value, y: one.y[i], text: name(i),
      px: (value - x[0]) / (x[1] - x[0]) * width, py: (one.y[i] - y[0]) / (y[1] - y[0]) * height,
    }));
  });
  const taken = marks.map(({ px, py }) => [px - 9, px + 9, py]);
  const spots = [[14, 0, "left"], [-14, 0, "right"], [0, -18, "center"], [0, 18, "center"], [12, -16, "left"], [-12, -16, "right"], [12, 16, "left"], [-12, 16, "right"]];
  return marks.filter((mark) => mark.text).map(({ x: energy, y: jump, text, px, py }) => {
    const size = 7.5 * text.length + 4;
    const start = ([dx, , anchor]) => px + dx - (anchor === "right" ? size : anchor === "center" ? size / 2 : 0);
    const free = (spot) => {
      const from = start(spot), at = py + spot[1];
      return from >= 0 && from + size <= width && !taken.some((t) => from < t[1] && from + size > t[0] && Math.abs(at - t[2]) < 15);
    };
    const spot = spots.find(free) ?? spots[0];
    taken.push([start(spot), start(spot) + size, py + spot[1]]);
    return { x: energy, y: jump, text, showarrow: false, xshift: spot[0], yshift: spot[1], xanchor: spot[2], font: { size: 12, color: colour("ink") } };
  });
}

function drawFront() {
  for (const [key, fits] of [["published", papersAxes()], ["floor", hasFloor()]]) document.querySelector(`[data-show=${key}]`).closest("label").hidden = !fits;
  const list = traces();
  const x = axis(state.axes.x === "energy_j" ? "energy from start to apex, J" : titled(state.axes.x), { range: [...home.x], constraintoward: "left" });
  const y = axis(FIRST === "height_m" ? "jump height of the base, m" : titled(FIRST), { range: [...home.y] });
  const config = { ...CONFIG, modeBarButtonsToRemove: [...CONFIG.modeBarButtonsToRemove] };
  const shape = layout(x, y, {
    annotations: labels(list), dragmode: "zoom",
    // The chart's buttons have a strip of their own above it: points under them could not be clicked.
    margin: { l: 58, r: tinted() && !narrow() ? 84 : 14, t: tinted() && narrow() ? 92 : 26, b: 46 }, uirevision: state.axes.x,
  });
  const done = Plotly.react(gd, list, shape, config);
  if (!gd.contains(ring)) gd.append(ring);
  placeRing();
  return done;
}

// The ring lies over the chart, so that a selection does not redraw thousands of points.
function placeRing() {
  const chosen = subject();
  const full = gd._fullLayout;
  const value = (name) => (chosen ? inShown(name, chosen.measures[name] ?? chosen.more[name]) : null);
  const e = value(state.axes.x), h = value(FIRST);
  if (!full || !chosen || e === null || h === null) { ring.hidden = true; return; }
  const { xaxis, yaxis } = full;
  const left = xaxis._offset + xaxis.d2p(e), top = yaxis._offset + yaxis.d2p(h);
  ring.hidden = left < xaxis._offset || left > xaxis._offset + xaxis._length || top < yaxis._offset || top > yaxis._offset + yaxis._length;
  ring.style.left = `${left}px`;
  ring.style.top = `${top}px`;
}

function describeFront() {
  const { front, trials } = current();
  const at = place();
  gd.setAttribute("aria-valuemin", front.length ? 1 : 0);
  gd.setAttribute("aria-valuemax", front.length);
  gd.setAttribute("aria-valuenow", at + 1);
  const chosen = subject();
  gd.setAttribute("aria-valuetext", chosen
    ? `${chosen.kind === "case" ? `paper's ${chosen.name}` : `trial ${trials.trial[state.row]}`}, ${told(page.objectives, (name) => chosen.measures[name])}`
    : "no design");
}

function startFront() {
  home = startRange();
  let waiting = 0;
  drawFront().then(() => {
    gd.on("plotly_click", (event) => {
      const stands = points[event.points[0].curveNumber][event.points[0].pointIndex];
      if (!stands) return;
      if (typeof stands[1] === "number") select(...stands);
      else selectCase(...stands);
    });
    gd.on("plotly_relayout", () => {
      placeRing();
      clearTimeout(waiting);
      // A new view shows other trials of the cloud.
      waiting = setTimeout(() => { if (gd._fullLayout) redrawView(); }, 60);
    });
    placeRing();
  });
  gd.addEventListener("keydown", (event) => {
    const study = event.shiftKey && { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (study) {
      event.preventDefault();
      event.stopPropagation();
      moveToStudy(study);
      return;
    }
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10, Home: -Infinity, End: Infinity }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    moveAlongFront(step);
  });
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("input, select, textarea, button, canvas, summary, a") || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.key === "ArrowRight") moveAlongFront(1);
    if (event.key === "ArrowLeft") moveAlongFront(-1);
  });
  startAxes();
  startMotorSwitches();
  on("selection", () => { placeRing(); describeFront(); });
  on("view", drawFront);
  charts.push(drawFront);
}

// On a narrow page the bar of colours lies above the chart.
function narrow() { return gd.clientWidth < 520; }

const ABOVE = { orientation: "h", x: 0, xanchor: "left", y: 1.02, yanchor: "bottom", len: 1, thickness: 10 };

// The colours of a front by a third measure: one scale for all studies, with one bar beside the chart.
function colourOf(study, name, list) {
  const values = (i) => page.studies[i].front.map((row) => inShown(name, page.studies[i].trials.columns[name][row]));
  const [low, high] = extent([...state.visible].flatMap(values));
  const first = !list.some((one) => one.name === "front");
  return {
    color: values(study), cmin: low, cmax: high, colorscale: "Viridis", showscale: first, size: 8.5,
    colorbar: { title: { text: plain(titled(name)), side: narrow() ? "top" : "right" }, thickness: 12, outlinewidth: 0, tickcolor: colour("soft"), ...(narrow() ? ABOVE : {}) },
  };
}

// A choice of what is to the right, where the page has more than one such measure.
function startAxes() {
  const names = page.goals.filter((name) => name !== FIRST);
  if (names.length < 2) return;
  const choice = make("select", { id: "across" }, ...names.map((name) => make("option", { value: name }, titled(name))));
  choice.value = state.axes.x;
  choice.addEventListener("change", () => setAxes({ x: choice.value }));
  on("axes", () => { choice.value = state.axes.x; home = startRange(); });
  byId("axes").append(make("label", {}, "To the right ", choice));
  byId("axes").hidden = false;
}

let lastView = "";
function redrawView() {
  const { x, y } = viewRange();
  const key = JSON.stringify([x, y, gd.clientWidth]);
  if (key === lastView) return;
  lastView = key;
  drawFront();
}

// One of six colours and marks for a kit of motors, by its number.
const MARKS = ["circle", "square", "diamond", "triangle-up", "triangle-down", "pentagon"];
function motorTint(kit) { return MOTORS.indexOf(kit) % MARKS.length; }

const MARK_SHAPES = [
  '<circle cx="7" cy="7" r="4"/>', '<path d="M3 3H11V11H3Z"/>', '<path d="M7 2L12 7L7 12L2 7Z"/>',
  '<path d="M7 3L12 11H2Z"/>', '<path d="M7 11L2 3H12Z"/>', '<path d="M7 2L12 6L10 12H4L2 6Z"/>',
];

// A switch for each kit of motors that designs choose from: without it, its designs are out of range everywhere.
function startMotorSwitches() {
  const box = byId("motors");
  box.hidden = MOTORS.length === 0;
  for (const kit of MOTORS) {
    const input = make("input", { type: "checkbox", "data-motor": kit });
    input.checked = !state.withoutMotors.has(kit);
    input.addEventListener("change", () => showMotor(kit, input.checked));
    on("conditions", () => { input.checked = !state.withoutMotors.has(kit); });
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true", fill: `var(--c${motorTint(kit)})` });
    symbol.innerHTML = MARK_SHAPES[motorTint(kit)]; // constant text from above
    box.append(make("label", {}, input, symbol, page.kits[kit].motor));
  }
}

const SYMBOLS = {
  cloud: '<circle cx="7" cy="7" r="2.5" fill="var(--cloud)"/>',
  infeasible: '<path d="M4 4L10 10M10 4L4 10" stroke="var(--bad)" stroke-width="1.5"/>',
  front: '<path d="M0 7H14" stroke="var(--c0)"/><circle cx="7" cy="7" r="3.8" fill="var(--c0)"/>',
  published: '<path d="M7 2L12 7L7 12L2 7Z" fill="none" stroke="var(--paper)" stroke-width="1.6"/>',
  simulated: '<path d="M7 2L12 7L7 12L2 7Z" fill="var(--paper)"/>',
  floor: '<path d="M0 11L14 3" stroke="var(--faint)" stroke-width="1.6" stroke-dasharray="2 2.5"/>',
  picks: '<path d="M7 1L8.8 5.2L13.3 5.5L9.8 8.4L11 12.9L7 10.4L3 12.9L4.2 8.4L.7 5.5L5.2 5.2Z" fill="var(--c4)" stroke="var(--ink)" stroke-width=".7"/>',
};

function startSwitches() {
  const names = {
    front: "front", cloud: "dominated", infeasible: "infeasible", published: "paper, as published",
    simulated: "paper, simulated here", picks: "knee", floor: `floor m g (H − ${START_HEIGHT} m)`,
  };
  const box = byId("switches");
  const mass = page.studies.map((s) => s.floor_mass_kg).filter((m) => m !== null);
  for (const [key, text] of Object.entries(names)) {
    const input = make("input", { type: "checkbox", "data-show": key });
    input.checked = state.layers[key];
    input.addEventListener("change", () => showLayer(key, input.checked));
    on("layers", () => { input.checked = state.layers[key]; });
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true" });
    symbol.innerHTML = SYMBOLS[key]; // constant text from above
    const label = make("label", {}, input, symbol, text);
    if (key === "floor" && mass.length) {
      label.append(` of the lightest robot, ${round(Math.min(...mass), 2)} kg`);
      label.title = "The work of lifting that robot's weight. A leg that stretches in flight rises a little less than the base.";
    }
    box.append(label);
  }
  if (page.studies.length < 2) return;
  page.studies.forEach((study, i) => {
    const input = make("input", { type: "checkbox", "data-study": i });
    input.checked = state.visible.has(i);
    input.addEventListener("change", () => showStudy(i, input.checked));
    on("conditions", () => { input.checked = state.visible.has(i); });
    const symbol = make("span", { class: "swatch", style: `background: var(--c${i % 6})` });
    box.append(make("label", {}, input, symbol, study.label));
  });
}
