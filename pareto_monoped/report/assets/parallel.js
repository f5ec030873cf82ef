// Parallel coordinates of variables and objectives, drawn on a canvas; ranges and selection are shared with the front.

const AXES = [...page.variables.map((v) => v.name), ...(page.goals.includes("mass_kg") ? [] : ["mass_kg"]), ...page.goals];
const MOST_LINES = 3000;
const NEAR_PX = 8;
const par = { node: byId("parallel-chart"), top: 46, bottom: 24, left: 46, right: 46, limits: {}, lines: [] };

function axisX(i) { return par.left + i / (AXES.length - 1) * (par.width - par.left - par.right); }

function axisY(name, value) {
  const [low, high] = par.limits[name];
  return par.height - par.bottom - (value - low) / (high - low || 1) * (par.height - par.top - par.bottom);
}

function valueAtY(name, y) {
  const [low, high] = par.limits[name];
  const share = (par.height - par.bottom - y) / (par.height - par.top - par.bottom);
  return low + Math.min(Math.max(share, 0), 1) * (high - low);
}

// Limits of each axis and which trials are drawn: the fronts, and every n-th of the other feasible ones.
function prepareParallel() {
  for (const name of AXES) {
    const values = page.studies.flatMap((s) => s.bounds[name] ?? []);
    if (!values.length) for (const s of page.studies) values.push(...extent(feasibleRows(s).map((row) => s.trials.columns[name][row])));
    const [low, high] = extent(values);
    par.limits[name] = low === high ? padded([low, high]) : [low, high];
  }
}

function feasibleRows(study) {
  if (!study.feasible) study.feasible = [...study.trials.state].flatMap((letter, row) => (letter === "f" ? [row] : []));
  return study.feasible;
}

function linesToDraw() {
  const clouds = [], fronts = [];
  for (const i of state.visible) {
    const study = page.studies[i];
    const onFront = new Set(study.front);
    for (const row of feasibleRows(study)) if (!onFront.has(row)) clouds.push([i, row]);
    for (const row of study.front) fronts.push([i, row]);
  }
  const every = Math.max(Math.ceil(clouds.length / MOST_LINES), 1);
  return { clouds: clouds.filter((_, k) => k % every === 0), fronts, every };
}

function drawParallel() {
  par.width = Math.max(par.node.clientWidth, 300);
  par.height = par.node.clientHeight;
  const scale = window.devicePixelRatio || 1;
  par.canvas.width = par.width * scale;
  par.canvas.height = par.height * scale;
  par.xs = AXES.map((_, i) => axisX(i));
  par.lines = linesToDraw();
  drawAxes();
  drawLines();
  drawSelected();
}

function polyline(context, [study, row]) {
  const { columns } = page.studies[study].trials;
  AXES.forEach((name, i) => {
    const y = axisY(name, columns[name][row]);
    if (i) context.lineTo(par.xs[i], y);
    else context.moveTo(par.xs[i], y);
  });
}

function stroke(context, list, tint, width, alpha) {
  context.strokeStyle = tint;
  context.lineWidth = width;
  context.globalAlpha = alpha;
  for (const line of list) {
    context.beginPath();
    polyline(context, line);
    context.stroke();
  }
}

function drawLines() {
  const context = par.canvas.getContext("2d");
  const scale = window.devicePixelRatio || 1;
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, par.width, par.height);
  const kept = (list) => list.filter(([study, row]) => inRanges(study, row));
  const ranged = filtered();
  if (state.layers.cloud) stroke(context, kept(par.lines.clouds), colour("cloud"), 1, ranged ? 0.3 : 0.09);
  const several = page.studies.length > 1;
  for (const i of state.visible) {
    const own = par.lines.fronts.filter(([study]) => study === i);
    if (page.studies[i].trials.columns.motor) {
      for (const kit of MOTORS) stroke(context, kept(own).filter(([, row]) => kitOf(page.studies[i], row) === kit), colour(`c${motorTint(kit)}`), 1.2, 0.55);
    } else stroke(context, kept(own), several ? studyColour(i) : colour("c0"), 1.2, 0.55);
  }
  context.globalAlpha = 1;
}

// The selected design's line has a layer of its own, so that the many below are not drawn again.
function drawSelected() {
  const { columns } = current().trials;
  const d = state.row === null ? "" : `M${AXES.map((name, i) => `${par.xs[i].toFixed(1)} ${axisY(name, columns[name][state.row] ?? par.limits[name][0]).toFixed(1)}`).join("L")}`;
  for (const path of par.selected.children) path.setAttribute("d", d);
}

function drawAxes() {
  par.svg.replaceChildren();
  AXES.forEach((name, i) => {
    const q = quantity[name], x = par.xs[i], [low, high] = par.limits[name];
    const group = draw("g", { class: "axis", "data-axis": name });
    group.append(draw("rect", { x: x - 20, y: par.top - 8, width: 40, height: par.height - par.top - par.bottom + 16, fill: "transparent" }));
    group.append(draw("line", { x1: x, x2: x, y1: par.top, y2: par.height - par.bottom, stroke: "var(--soft)" }));
    const words = q.label.split(" ");
    const half = words.length > 1 ? [words[0], words.slice(1).join(" ")] : ["", words[0]];
    group.append(text(x, 11, half[0], "middle", "strong"), text(x, 23, half[1], "middle", "strong"), text(x, 35, q.unit, "middle"));
    for (const value of ticks(low * q.scale, high * q.scale, 5)) {
      const label = text(x + 5, axisY(name, value / q.scale) + 4, tickText(value));
      label.setAttribute("style", "paint-order: stroke; stroke: var(--card); stroke-width: 3px");
      group.append(draw("line", { x1: x - 3, x2: x + 3, y1: axisY(name, value / q.scale), y2: axisY(name, value / q.scale), stroke: "var(--soft)" }), label);
    }
    const range = state.ranges[name];
    if (range) {
      const y = axisY(name, Math.min(range[1] ?? high, high)), end = axisY(name, Math.max(range[0] ?? low, low));
      group.append(draw("rect", { x: x - 8, y, width: 16, height: Math.max(end - y, 2), fill: "var(--c4)", "fill-opacity": 0.45, stroke: "var(--c4)" }));
    }
    par.svg.append(group);
  });
}


function describeRanges() {
  const note = byId("brush-note");
  if (!filtered()) {
    const { every } = par.lines;
    note.textContent = every > 1 ? `Drawn are the whole front and one in ${every} of the other feasible trials.` : "";
    return;
  }
  let front = 0, fronts = 0, all = 0, total = 0;
  for (const i of state.visible) {
    const study = page.studies[i];
    fronts += study.front.length;
    front += study.front.filter((row) => inRanges(i, row)).length;
    total += feasibleRows(study).length;
    all += feasibleRows(study).filter((row) => inRanges(i, row)).length;
  }
  note.textContent = `Within the ranges: ${front} of ${fronts} designs on the front, ${all} of ${total} feasible trials on this page. `;
  const clear = make("button", { type: "button", id: "clear-ranges" }, "Drop all ranges");
  clear.addEventListener("click", clearConditions);
  note.append(clear);
}

function fillFields() {
  for (const name of AXES) {
    const range = state.ranges[name];
    const [from, to] = par.fields[name];
    [from, to].forEach((field, side) => {
      const end = range?.[side] ?? null;
      if (document.activeElement !== field) field.value = end === null ? "" : Number((end * quantity[name].scale).toPrecision(5));
    });
  }
}

function buildFields() {
  par.fields = {};
  for (const name of AXES) {
    const q = quantity[name];
    const pair = ["from", "to"].map((word, side) => {
      const input = make("input", { type: "number", step: "any", "aria-label": `${q.label} ${word}, ${q.unit}`, placeholder: word, "data-range": `${name}-${word}` });
      input.addEventListener("change", () => {
        const typed = par.fields[name].map((field) => (Number.isFinite(field.valueAsNumber) ? field.valueAsNumber / q.scale : null));
        setRange(name, typed.includes(null) || typed[0] <= typed[1] ? typed : typed.reverse());
      });
      return input;
    });
    par.fields[name] = pair;
    byId("brush-fields").append(make("label", {}, `${q.label}, ${q.unit}`, make("span", {}, pair[0], " ", pair[1])));
  }
}

function nearestLine(x, y) {
  let best = null, least = NEAR_PX;
  const left = par.xs.findLastIndex((at) => at <= x);
  if (left < 0 || left >= AXES.length - 1) return null;
  const share = (x - par.xs[left]) / (par.xs[left + 1] - par.xs[left]);
  for (const line of [...par.lines.fronts, ...(state.layers.cloud ? par.lines.clouds : [])]) {
    if (!inRanges(...line)) continue;
    const { columns } = page.studies[line[0]].trials;
    const a = axisY(AXES[left], columns[AXES[left]][line[1]]), b = axisY(AXES[left + 1], columns[AXES[left + 1]][line[1]]);
    const off = Math.abs(a + share * (b - a) - y);
    if (off < least) { least = off; best = line; }
  }
  return best;
}

function startParallel() {
  par.canvas = make("canvas", { role: "img", "aria-label": "Parallel coordinates: one line per design across its variables and measures" });
  par.svg = draw("svg", { "aria-hidden": "true" });
  par.selected = draw("svg", { "aria-hidden": "true", fill: "none", "pointer-events": "none" },
    draw("path", { stroke: "var(--card)", "stroke-width": 6 }), draw("path", { stroke: "var(--c1)", "stroke-width": 3, id: "parallel-selected" }));
  par.node.append(par.canvas, par.selected, par.svg);
  prepareParallel();
  buildFields();
  drawParallel();
  describeRanges();
  let drag = null;
  const at = (event) => {
    const box = par.node.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  par.node.addEventListener("pointerdown", (event) => {
    const [x, y] = at(event);
    const i = par.xs.findIndex((value) => Math.abs(value - x) < 20);
    drag = { name: i >= 0 ? AXES[i] : null, x, y, moved: false };
    if (drag.name) par.node.setPointerCapture(event.pointerId);
  });
  par.node.addEventListener("pointermove", (event) => {
    if (!drag || !drag.name) return;
    const [, y] = at(event);
    if (Math.abs(y - drag.y) > 4) drag.moved = true;
    if (!drag.moved) return;
    const range = [valueAtY(drag.name, drag.y), valueAtY(drag.name, y)].sort((a, b) => a - b);
    setRange(drag.name, range, false);
  });
  par.node.addEventListener("pointerup", (event) => {
    if (!drag) return;
    const [x, y] = at(event);
    if (drag.moved) setRange(drag.name, state.ranges[drag.name]);
    else if (drag.name && state.ranges[drag.name]) setRange(drag.name, null);
    else {
      const line = nearestLine(x, y);
      if (line) select(...line);
    }
    drag = null;
  });
  par.node.addEventListener("pointercancel", () => { drag = null; });
  on("selection", drawSelected);
  on("conditions", ({ final }) => {
    drawAxes();
    drawLines();
    if (final) fillFields();
  });
  on("view", () => { par.lines = linesToDraw(); drawLines(); describeRanges(); });
  fillFields();
  charts.push(drawParallel);
  window.addEventListener("resize", drawParallel);
}
