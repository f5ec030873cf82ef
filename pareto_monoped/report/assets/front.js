// The front chart: by default the first objective upward and another to the right; click a point to select it.

const gd = byId("front-chart");
const ring = make("div", { class: "ring", "aria-hidden": "true" });
let front = null; // the chart

// What a column or a case has on an axis, in the unit shown; null where it has nothing.
function inShown(name, value) { return value === null || value === undefined ? null : value * quantity[name].scale; }

function ofCase(made, name) { return inShown(name, made[name] ?? made.measures[name]); }

function kindOf(side) { return state.axes[`log${side.toUpperCase()}`] ? "log" : "linear"; }

// Work against gravity is a floor of these energies.
function hasFloor() { return state.axes.y === "height_m" && Object.hasOwn(page.energies, state.axes.x); }

function papersAxes() { return state.axes.y === "height_m" && state.axes.x === "energy_j"; }

function shownColumn(study, name, rows) {
  const column = columnOf(study, name), { scale } = quantity[name];
  return rows.map((row) => (column[row] === null || Number.isNaN(column[row]) ? null : column[row] * scale));
}

// The middle part of the trials, without the few that would stretch an axis.
function mostOf(study, name) {
  const sorted = Float64Array.from(shownColumn(study, name, feasibleRows(page.studies[study])).filter((v) => v !== null)).sort();
  return sorted.length ? [quantile(sorted, 0.01), quantile(sorted, 0.99)] : [];
}

const homes = new Map();

// The range of an axis that shows the whole; no condition changes it.
function homeRange(side) {
  const { x, y, logX, logY } = state.axes;
  return once(homes, `${side} ${x} ${y} ${logX} ${logY}`, () => foundRange(side));
}

function foundRange(side) {
  const name = state.axes[side], kind = kindOf(side);
  const values = page.studies.flatMap((study, i) => {
    const rows = study.front.length ? study.front : study.trials.trial.map((_, row) => row);
    const more = page.objectives.includes(name) ? [] : mostOf(i, name);
    const best = bestJumps(i).map((jump) => inShown(name, jump[side === "x" ? 2 : 1]));
    return [...shownColumn(i, name, rows), ...more, ...best, ...study.cases.map((made) => ofCase(made, name))];
  });
  if (papersAxes()) values.push(...page.published.map((made) => inShown(name, made[name])));
  if (name === "height_m" && kind === "linear") values.push(START_HEIGHT + 0.05, START_HEIGHT + 0.1);
  const range = extent(kind === "log" ? values.filter((v) => v > 0) : values);
  // With a floor, which begins at no energy, so does the chart.
  if (side === "x" && hasFloor() && kind === "linear") return [0, range[1] * 1.06];
  return paddedBy(kind, range);
}

function hoverText(study, row) {
  const card = page.studies[study];
  const { columns, trial } = card.trials;
  const lines = [`<b>trial ${trial[row]}</b>${page.studies.length > 1 ? `, ${plain(card.label)}` : ""}`];
  if (PAPERS_OWN) lines.push(told(page.objectives, (name) => columns[name][row]));
  const { x, y, size } = state.axes;
  const named = new Set([...page.goals, x, y, tinted(), size].filter((name) => name && !(PAPERS_OWN && page.objectives.includes(name))));
  for (const name of named) lines.push(`${plain(quantity[name].label)} ${shown(name, valueAt(study, name, row))}`);
  for (const variable of page.variables) if (!named.has(variable.name)) lines.push(`${quantity[variable.name].label} ${shown(variable.name, columns[variable.name][row])}`);
  if (dearWords(study, row)) lines.push("⚠ dear at the battery");
  if (columns.motor) lines.push(`motor ${plain(motorOf(card, row))}`);
  return lines.join("<br>");
}

// A layer of designs of one study.
function designs(name, study, rows, marker, more = {}) {
  const { x, y, colour: _, size, space } = state.axes;
  const tint = tinted();
  if (tint && marker.ramp) marker.color = shownColumn(study, tint, rows);
  if (size) marker.size = sizesOf(study, size, rows, entry(marker.size, 0) ?? 4);
  return {
    name, mode: "markers", x: shownColumn(study, x, rows), y: shownColumn(study, y, rows), ...(space ? { z: shownColumn(study, depthName(), rows) } : {}),
    stands: rows.map((row) => [study, row]), text: (i) => hoverText(study, rows[i]), marker, ...more,
  };
}

// The measure that a 3D view has in its depth.
function depthName() { return tinted() ?? page.goals.find((name) => name !== state.axes.x && name !== state.axes.y) ?? "mass_kg"; }

function rangeOver(name) { return extent([...state.visible].flatMap((i) => shownColumn(i, name, page.studies[i].front))); }

const LEAST_MARK = 0.7, MOST_MARK = 2.4; // of the usual diameter

function sizesOf(study, name, rows, usual) {
  const [low, high] = rangeOver(name);
  return shownColumn(study, name, rows).map((value) => Math.round(2 * usual * (LEAST_MARK + (MOST_MARK - LEAST_MARK) * Math.min(Math.max(((value ?? low) - low) / (high - low || 1), 0), 1))) / 2);
}

function cloudLayers(study) {
  const card = page.studies[study];
  const onFront = new Set(card.front), ranged = filtered(), mask = masked(study), tint = tinted();
  const list = [];
  for (const [letter, wanted, name] of [["f", state.layers.cloud, "dominated"], ["i", state.layers.infeasible, "infeasible"]]) {
    if (!wanted) continue;
    const rows = rowsIn(card, letter).filter((row) => !onFront.has(row));
    const opacity = ranged ? rows.map((row) => (mask[row] ? 0.8 : 0.06)) : tint ? 0.6 : 0.35;
    const marker = letter === "f"
      ? { size: 4, color: page.studies.length > 1 ? studyColour(study) : colour("cloud"), opacity, ...(tint ? { ramp: rangeOver(tint) } : {}) }
      : { size: 6, symbol: "cross", color: colour("bad"), opacity: ranged ? opacity : 0.6 };
    list.push(designs(name, study, rows, marker, letter === "f" ? { cloud: true } : {}));
  }
  return list;
}

// The least energy of each height over the designs of all studies in sight, from the last height that needs none.
function floorLayer() {
  const floors = [...state.visible].map((i) => page.studies[i].floor_j).filter((floor) => floor.length);
  if (!floors.length || !hasFloor() || !state.layers.floor || state.axes.space) return [];
  const least = page.constants.floor_heights_m.map((_, i) => Math.min(...floors.map((floor) => floor[i])));
  const first = Math.max(least.lastIndexOf(0), 0);
  return [{ name: "floor", mode: "lines", x: least.slice(first), y: page.constants.floor_heights_m.slice(first), line: { color: colour("faint"), width: 1.5, dash: "dot" } }];
}

function frontLayers(study) {
  const card = page.studies[study];
  if (!state.layers.front) return [];
  const tint = studyColour(study);
  const many = [...state.visible].reduce((sum, i) => sum + page.studies[i].front.length, 0);
  const size = many > 1500 ? 4.5 : many > 300 ? 6 : 7.5;
  const mask = masked(study), opacity = card.front.map((row) => (mask[row] ? 1 : 0.15));
  const marker = { size, symbol: MARKS[study % 6], color: tint, opacity };
  if (card.trials.columns.motor) {
    // Motors differ in colour and in mark: a measure may take the colour.
    const motors = card.front.map((row) => motorTint(kitOf(card, row)));
    Object.assign(marker, { symbol: motors.map((k) => MARKS[k]), color: motors.map((k) => colour(`c${k}`)) });
  }
  const measure = tinted();
  if (measure) Object.assign(marker, { ramp: rangeOver(measure) });
  // A line of steps joins designs that hold until the next one is reached; on other axes than its own a front is none.
  const { x, y, space } = state.axes;
  const own = !space && y === FIRST && card.objectives.length === 2 && card.objectives.includes(FIRST) && card.objectives.includes(x);
  const steps = page.directions[FIRST] === "maximise" ? "hv" : "vh";
  const list = [designs("front", study, card.front, marker, own ? { mode: "lines+markers", line: { shape: steps, width: 1.2, color: tint, opacity: filtered() ? 0.25 : 1 } } : {})];
  if (filtered()) list.push(designs("within", study, keptFront(study), { ...marker, symbol: MARKS[study % 6], color: tint, opacity: 1 }, own ? { mode: "lines+markers", line: { shape: steps, width: 1.6, color: tint } } : {}));
  if (card.weighted.length) {
    const rows = card.weighted.map(([, row]) => row);
    list.push(designs("weighted", study, rows, { size: 12, symbol: "square-open", color: tint }, {
      text: (i) => `weighted search, ${plain(quantity[FIRST].label)} weight ${card.weighted[i][0]}<br>${hoverText(study, rows[i])}`,
    }));
  }
  return [...robustLayers(study), ...bestLayers(study), ...list];
}

function pickLayers() {
  if (!state.layers.picks) return [];
  return [...state.visible].toReversed().map((study) => {
    const rows = page.studies[study].picks.filter((p) => p.name === "knee").map((p) => p.row);
    return designs("picks", study, rows, { size: 15, symbol: "star", color: colour("ink") }, { text: (i) => `<b>knee</b><br>${hoverText(study, rows[i])}` });
  });
}

function paperLayers() {
  const { x, y, space } = state.axes;
  if (space) return [];
  const layer = (name, symbol, entries) => ({
    name, mode: "markers", x: entries.map((p) => p.x), y: entries.map((p) => p.y), stands: entries.map((p) => p.stands), text: (i) => entries[i].text,
    labels: entries.map((p) => p.label), marker: { size: 11, symbol, color: entries.map((p) => p.tint ?? colour("paper")) },
  });
  const list = [];
  if (state.layers.published && papersAxes()) {
    list.push(layer("published", "diamond-open", page.published.map((c) => ({
      x: inShown(x, c[x]), y: inShown(y, c[y]), label: c.name, stands: null, text: `<b>paper, ${c.name}</b>, as published<br>${round(c.height_m)} m on ${round(c.energy_j, 2)} J`,
    }))));
  }
  if (!state.layers.simulated) return list;
  const seen = new Set(), entries = [];
  for (const study of state.visible) {
    const card = page.studies[study];
    const key = `${card.case_motor} ${card.calibration}`;
    if (seen.has(key)) continue;
    seen.add(key);
    for (const c of card.cases) {
      const across = ofCase(c, x), up = ofCase(c, y);
      if (up === null || across === null) continue;
      // Only the first motor's have names; the others are in the same order and have their study's colour.
      entries.push({
        x: across, y: up, label: seen.size === 1 ? c.name : "", stands: [study, c.name], tint: seen.size === 1 ? colour("paper") : studyColour(study),
        text: `<b>paper, ${c.name}</b>, simulated here<br>${plain(told([y, x], (name) => c[name] ?? c.measures[name]))}<br>motor ${plain(card.case_motor)}, calibration ${plain(card.calibration)}`,
      });
    }
  }
  return [...list, layer("simulated", "diamond", entries)];
}

// Names of the paper's diamonds and of the knee that is drawn last.
function namesOf(layers) {
  const last = layers.findLast((layer) => layer.name === "picks");
  return layers.flatMap((layer) => {
    if (layer.name !== "picks" && !layer.labels) return [];
    const words = (i) => (layer.labels ? layer.labels[i] : layer === last ? "knee" : "");
    return layer.x.map((x, i) => ({ x, y: layer.y[i], text: words(i) }));
  });
}

function drawFront() {
  for (const [key, fits] of [["published", papersAxes()], ["floor", hasFloor()]]) document.querySelector(`[data-show=${key}]`).closest("label").hidden = !fits || state.axes.space;
  const each = [...state.visible].sort((a, b) => a - b);
  const layers = [...each.flatMap(cloudLayers), ...floorLayer(), ...each.flatMap(frontLayers), ...pickLayers(), ...paperLayers()];
  const { x, y, space } = state.axes;
  const side = (name, key) => ({ title: axisTitle(name), range: homeRange(key), kind: kindOf(key) });
  front.space = space ? { title: axisTitle(depthName()), range: paddedBy("linear", rangeOver(depthName())), kind: "linear" } : null;
  front.set(layers, side(x, "x"), side(y, "y"), { names: space ? [] : namesOf(layers), view: space ? null : state.view });
  showRamp();
}

function axisTitle(name) {
  const { axis, unit } = quantity[name];
  return axis ? `${axis}, ${unit}` : titled(name);
}

// Where the selected design stands on the axes, the depth of a 3D view among them.
function selectedAt() {
  const chosen = subject();
  return [state.axes.x, state.axes.y, depthName()].map((name) => (chosen ? inShown(name, chosen.measures[name] ?? chosen.more[name]) : null));
}

// The ring lies over the chart, so that a selection does not redraw thousands of points.
function placeRing() {
  const [across, up, deep] = selectedAt();
  if (!front?.box || across === null || up === null) { ring.hidden = true; return; }
  const [left, top] = front.at(across, up, deep);
  const { box } = front;
  ring.hidden = !(left >= box.left - 1 && left <= box.left + box.width + 1 && top >= box.top - 1 && top <= box.top + box.height + 1);
  ring.style.left = `${left}px`;
  ring.style.top = `${top}px`;
}

// A selection outside the view takes the view along.
function bringAlong() {
  const [across, up] = selectedAt();
  if (!front?.box || front.space || !state.view || across === null || up === null) return;
  const [sx, sy] = [front.x.share(across), front.y.share(up)];
  if (sx >= 0 && sx <= 1 && sy >= 0 && sy <= 1) return;
  const moved = (scale, share) => [scale.value(share - 1 / 2), scale.value(share + 1 / 2)];
  front.look({ x: moved(front.x, sx), y: moved(front.y, sy) });
}

// A frame becomes conditions on both axes; what a lasso holds of the front goes to the shortlist, evenly if it is much.
function byFrame({ corners, frame }) {
  const { x, y } = state.axes;
  if (frame) {
    const ends = (name, k) => corners.map((corner) => Number((corner[k] / quantity[name].scale).toPrecision(5))).sort((a, b) => a - b);
    setRange(x, ends(x, 0), false);
    setRange(y, ends(y, 1));
    showAnswer(true);
    return;
  }
  const inside = (px, py) => corners.reduce((odd, [x1, y1], i) => {
    const [x2, y2] = corners[(i + 1) % corners.length];
    return (y1 > py) !== (y2 > py) && px < (x2 - x1) * (py - y1) / (y2 - y1) + x1 ? !odd : odd;
  }, false);
  const found = [...state.visible].flatMap((study) => keptFront(study).filter((row) => inside(...[x, y].map((name) => inShown(name, valueAt(study, name, row))))).map((row) => [study, row]));
  const room = Math.min(SHORTLIST_MOST - state.shortlist.length, found.length);
  for (let k = 0; k < room; k += 1) keep(...found[Math.round(room > 1 ? k * (found.length - 1) / (room - 1) : 0)]);
  byId("page-note").textContent = found.length ? `${room} of ${found.length} designs in the lasso are on the shortlist.` : "The lasso holds no design of the front.";
}

function describeFront() {
  const { trials } = current(), rows = keptFront(state.study), at = rows.indexOf(state.row);
  const chosen = subject(), name = chosen?.kind === "case" ? `paper's ${chosen.name}` : `trial ${trials.trial[state.row]}`;
  const words = chosen ? `${name}, ${told(page.objectives, (measure) => chosen.measures[measure])}` : "no design";
  Object.assign(gd, { ariaValueMin: rows.length ? 1 : 0, ariaValueMax: rows.length, ariaValueNow: at + 1, ariaValueText: words });
}

function startFront() {
  front = new SpaceChart(gd, {
    margin: { t: 14 }, shown: placeRing, framed: byFrame, moved: setView,
    chosen: (stands) => (typeof stands[1] === "number" ? select(...stands) : selectCase(...stands)),
  });
  gd.append(ring);
  gd.addEventListener("keydown", frontKey);
  document.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key], busy = event.target.closest("input, select, textarea, button, canvas, summary, a, [tabindex]");
    if (step && !busy && !event.altKey && !event.ctrlKey && !event.metaKey) moveAlongFront(step);
  });
  startAxes();
  startMotorSwitches();
  on("selection", () => { bringAlong(); placeRing(); describeFront(); });
  on("view", () => describeFront());
  on("view", lazily("front-chart", drawFront));
}

function frontKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const study = event.shiftKey && { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10, Home: -Infinity, End: Infinity }[event.key];
  const zoom = { "+": 1 / 1.5, "=": 1 / 1.5, "-": 1.5, 0: 0 }[event.key];
  if (!study && !step && zoom === undefined) return;
  event.preventDefault();
  event.stopPropagation();
  if (study) moveToStudy(study);
  else if (step) moveAlongFront(step);
  else zoomFront(zoom);
}

// Nearer about the selection, farther, or with 0 the whole.
function zoomFront(factor) {
  if (factor === 0) { front.whole(); return; }
  const { left, top, width, height } = front.box;
  const here = ring.hidden ? [left + width / 2, top + height / 2] : [parseFloat(ring.style.left), parseFloat(ring.style.top)];
  if (!front.space) front.zoom(factor, here);
}
