// Parallel coordinates of variables and objectives, drawn on a canvas; conditions and selection are the page's own.

const AXES = [...page.variables.map((v) => v.name), ...(page.goals.includes("mass_kg") ? [] : ["mass_kg"]), ...page.goals];
// As many lines as can be told apart; more become a block of one colour.
const MOST_OF_FRONT = 260, MOST_OTHERS = 260;
const LINE_PX = 8; // a click this near to a line means it
const SOFT_SHARE = 1e-3; // of the top of an axis with zeros: below it the axis is linear
const par = { node: byId("parallel-chart"), top: 46, bottom: 24, left: 46, right: 50, scales: {}, front: [], others: [] };

function axisX(i) { return par.left + i / (AXES.length - 1) * (par.width - par.left - par.right); }

function axisY(name, value) { return par.height - par.bottom - Math.min(Math.max(par.scales[name].share(value), 0), 1) * (par.height - par.top - par.bottom); }

function valueAtY(name, y) {
  const share = (par.height - par.bottom - y) / (par.height - par.top - par.bottom);
  return par.scales[name].value(Math.min(Math.max(share, 0), 1));
}

// Each axis from bound to bound, or over all feasible trials; logarithmic where most of it would be empty.
function prepareScales() {
  for (const name of AXES) {
    const values = page.studies.flatMap((s) => feasibleRows(s).map((row) => s.trials.columns[name][row]));
    const ends = page.studies.flatMap((s) => s.bounds[name] ?? []);
    const [low, high] = extent(ends.length ? ends : values);
    const kind = low === high ? "linear" : kindFor([...values, low, high]);
    par.scales[name] = scaleOf(low === high ? padded([low, high]) : [low, high], kind, high * SOFT_SHARE);
  }
}

function thinnedTo(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, i) => list[Math.round(i * (list.length - 1) / (most - 1))]);
}

// Which designs have a line: of those that obey the conditions, evenly along the fronts and among the others.
function linesToDraw() {
  const others = [], onFronts = [];
  for (const i of state.visible) {
    const study = page.studies[i];
    const front = keptFront(i), onFront = new Set(front);
    if (state.layers.cloud) for (const row of feasibleRows(study)) if (!onFront.has(row) && inRanges(i, row)) others.push([i, row]);
    for (const row of front) onFronts.push([i, row]);
  }
  par.all = onFronts.length + others.length;
  par.front = thinnedTo(onFronts, MOST_OF_FRONT);
  par.others = thinnedTo(others, MOST_OTHERS);
}

function drawParallel() {
  par.width = Math.max(par.node.clientWidth, 300);
  par.height = par.node.clientHeight;
  const scale = paperScale() ?? (window.devicePixelRatio || 1);
  par.canvas.width = par.width * scale;
  par.canvas.height = par.height * scale;
  par.xs = AXES.map((_, i) => axisX(i));
  linesToDraw();
  drawParallelAxes();
  drawLines();
  drawSelected();
  describeRanges();
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
  Object.assign(context, { lineWidth: width, globalAlpha: alpha });
  for (const line of list) {
    context.strokeStyle = tint(line);
    context.beginPath();
    polyline(context, line);
    context.stroke();
  }
}

// As on the front chart: by a measure, by motor or by study; one study alone by its first objective.
function lineTint() {
  const motors = page.studies.some((study) => study.trials.columns.motor);
  const measure = tinted() ?? (motors || page.studies.length > 1 ? null : FIRST);
  if (measure) {
    const [low, high] = rangeOver(measure), { scale } = quantity[measure];
    return ([study, row]) => RAMP_TEXT[shadeOf(valueAt(study, measure, row) * scale, low, high)];
  }
  return ([study, row]) => (page.studies[study].trials.columns.motor ? colour(`c${motorTint(kitOf(page.studies[study], row))}`) : studyColour(study));
}

function drawLines() {
  const context = par.canvas.getContext("2d");
  const scale = par.canvas.width / par.width;
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, par.width, par.height);
  const cloud = colour("cloud");
  stroke(context, par.others, () => cloud, 0.8, 0.16);
  stroke(context, par.front, lineTint(), 1.1, par.front.length > 120 ? 0.45 : 0.7);
  context.globalAlpha = 1;
}

// The selected design's line has a layer of its own, so that the many below are not drawn again.
function drawSelected() {
  if (!par.xs) return;
  const { columns } = current().trials;
  const d = state.row === null ? "" : `M${AXES.map((name, i) => `${par.xs[i].toFixed(1)} ${axisY(name, columns[name][state.row] ?? par.scales[name].range[0]).toFixed(1)}`).join("L")}`;
  for (const path of par.selected.children) path.setAttribute("d", d);
}

function drawParallelAxes() {
  par.svg.replaceChildren(...AXES.map((name, i) => {
    const q = quantity[name], x = par.xs[i], scale = par.scales[name], [low, high] = scale.range;
    const group = draw("g", { class: "axis", "data-axis": name, "data-kind": scale.kind, "data-soft": high * SOFT_SHARE });
    group.append(draw("rect", { x: x - 20, y: par.top - 8, width: 40, height: par.height - par.top - par.bottom + 16, fill: "transparent" }));
    group.append(draw("line", { x1: x, x2: x, y1: par.top, y2: par.height - par.bottom, stroke: "var(--soft)" }));
    const words = q.label.split(" ");
    const half = words.length > 1 ? [words[0], words.slice(1).join(" ")] : ["", words[0]];
    group.append(text(x, 11, half[0], "middle", "strong"), text(x, 23, half[1], "middle", "strong"), text(x, 35, scale.kind === "linear" ? q.unit : `${q.unit}, log`, "middle"));
    // Ticks are round numbers in the unit shown.
    const inUnits = scaleOf([low * q.scale, high * q.scale], scale.kind, high * q.scale * SOFT_SHARE);
    for (const value of inUnits.ticks(5)) {
      const y = axisY(name, value / q.scale);
      group.append(draw("line", { x1: x - 3, x2: x + 3, y1: y, y2: y, stroke: "var(--soft)" }), text(x + 5, y + 4, tickText(value), "start", "halo"));
    }
    const range = state.ranges[name];
    if (range) {
      const y = axisY(name, range[1] ?? high), end = axisY(name, range[0] ?? low);
      group.append(draw("rect", { x: x - 8, y, width: 16, height: Math.max(end - y, 2), class: "kept" }));
    }
    return group;
  }));
}

function describeRanges() {
  const note = byId("brush-note");
  const drawn = par.front.length + par.others.length;
  const words = drawn < par.all ? `Drawn are ${drawn} of ${par.all} designs, evenly along the front and among the others.` : "";
  if (!filtered()) { note.textContent = words; return; }
  let onFront = 0, all = 0, total = 0;
  for (const i of state.visible) {
    const study = page.studies[i];
    onFront += keptFront(i).length;
    total += feasibleRows(study).length;
    all += feasibleRows(study).filter((row) => inRanges(i, row)).length;
  }
  note.textContent = `Within the conditions: ${onFront} designs on the front, ${all} of ${total} feasible trials on this page. ${words} `;
  const clear = make("button", { type: "button", id: "clear-ranges" }, "Drop all conditions");
  clear.addEventListener("click", clearConditions);
  note.append(clear);
}

function fillFields() {
  for (const name of AXES) {
    par.fields[name].forEach((field, side) => {
      const end = state.ranges[name]?.[side] ?? null;
      if (document.activeElement !== field) field.value = end === null ? "" : Number((end * quantity[name].scale).toPrecision(9));
    });
  }
}

function buildFields() {
  par.fields = {};
  for (const name of AXES) {
    const q = quantity[name];
    par.fields[name] = ["from", "to"].map((word) => {
      const input = make("input", { type: "number", step: "any", "aria-label": `${q.label} ${word}, ${q.unit}`, placeholder: word, "data-range": `${name}-${word}` });
      input.addEventListener("change", () => {
        const typed = par.fields[name].map((field) => (Number.isFinite(field.valueAsNumber) ? field.valueAsNumber / q.scale : null));
        setRange(name, typed.includes(null) || typed[0] <= typed[1] ? typed : typed.reverse());
      });
      return input;
    });
    byId("brush-fields").append(make("div", {}, `${q.label}, ${q.unit}`, make("span", {}, par.fields[name][0], " ", par.fields[name][1])));
  }
}

function nearestLine(x, y) {
  let best = null, least = LINE_PX;
  const left = par.xs.findLastIndex((at) => at <= x);
  if (left < 0 || left >= AXES.length - 1) return null;
  const share = (x - par.xs[left]) / (par.xs[left + 1] - par.xs[left]);
  for (const line of [...par.front, ...par.others]) {
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
    draw("path", { stroke: "var(--card)", "stroke-width": 6 }), draw("path", { stroke: "var(--select)", "stroke-width": 3, id: "parallel-selected" }));
  par.node.append(par.canvas, par.selected, par.svg);
  prepareScales();
  buildFields();
  fillFields();
  listenToAxes();
  on("selection", drawSelected);
  on("conditions", ({ final }) => {
    if (final) fillFields();
    if (!final && par.xs) drawParallelAxes();
  });
  const redraw = lazily("parallel-chart", drawParallel);
  on("view", () => { linesToDraw(); describeRanges(); redraw(); });
  linesToDraw();
  describeRanges();
  new ResizeObserver(() => { if (par.xs && par.width !== Math.max(par.node.clientWidth, 300)) redraw(); }).observe(par.node);
}

// A mouse draws a range on an axis; a finger scrolls, and types its ranges.
function listenToAxes() {
  let drag = null;
  const at = (event) => {
    const box = par.node.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  par.node.addEventListener("pointerdown", (event) => {
    const [x, y] = at(event);
    const i = par.xs.findIndex((value) => Math.abs(value - x) < 20);
    drag = { name: i >= 0 ? AXES[i] : null, x, y, moved: false };
    if (drag.name && event.pointerType !== "touch") par.node.setPointerCapture(event.pointerId);
  });
  par.node.addEventListener("pointermove", (event) => {
    if (!drag?.name || event.pointerType === "touch") return;
    const [, y] = at(event);
    if (Math.abs(y - drag.y) > 4) drag.moved = true;
    if (drag.moved) setRange(drag.name, [drag.y, y].map((one) => Number(valueAtY(drag.name, one).toPrecision(5))).sort((a, b) => a - b), false);
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
}
