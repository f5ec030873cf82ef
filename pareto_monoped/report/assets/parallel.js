// Parallel coordinates of any measures and variables, drawn on a canvas; conditions and selection are the page's own.

// The axes of a new page.
const AXES = [...page.variables.map((v) => v.name), ...(page.goals.includes("mass_kg") ? [] : ["mass_kg"]), ...page.goals];
// As many lines as can be told apart; more become a block of one colour.
const MOST_OF_FRONT = 260, MOST_OTHERS = 260;
const LINE_PX = 8; // a pointer this near to a line means it
const AXIS_PX = 76; // the least room of an axis and its name
const SOFT_SHARE = 1e-3; // of the top of an axis with zeros: below it the axis is linear
const par = { node: byId("parallel-chart"), top: 46, bottom: 24, left: 52, right: 62, names: [], xs: [], scales: new Map(), front: [], others: [], moving: null };

// The axes from left to right; while one is dragged, as they would then be.
function axesShown() { return par.moving ?? state.parallel ?? AXES; }

function axisX(i) { return par.left + i / Math.max(par.names.length - 1, 1) * (par.width - par.left - par.right); }

function axisY(name, value) { return par.height - par.bottom - Math.min(Math.max(axisScale(name).share(value), 0), 1) * (par.height - par.top - par.bottom); }

function valueAtY(name, y) {
  const share = (par.height - par.bottom - y) / (par.height - par.top - par.bottom);
  return axisScale(name).value(Math.min(Math.max(share, 0), 1));
}

// An axis from bound to bound, or over all feasible trials; logarithmic where most of it would be empty.
function axisScale(name) {
  return once(par.scales, name, () => {
    const values = page.studies.flatMap((study, i) => { const column = columnOf(i, name); return feasibleRows(study).map((row) => column[row]); });
    const ends = page.studies.flatMap((s) => s.bounds[name] ?? []);
    const [low, high] = extent(ends.length ? ends : values);
    const kind = low === high ? "linear" : kindFor([...values, low, high]);
    return scaleOf(low === high ? padded([low, high]) : [low, high], kind, high * SOFT_SHARE);
  });
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
    const front = keptFront(i), onFront = new Set(front), mask = masked(i);
    if (state.layers.cloud) for (const row of feasibleRows(study)) if (mask[row] && !onFront.has(row)) others.push([i, row]);
    for (const row of front) onFronts.push([i, row]);
  }
  par.all = onFronts.length + others.length;
  par.front = thinnedTo(onFronts, MOST_OF_FRONT);
  par.others = thinnedTo(others, MOST_OTHERS);
}

function drawParallel() {
  par.names = axesShown();
  par.node.style.minWidth = `${AXIS_PX * par.names.length}px`;
  par.width = Math.max(par.node.clientWidth, 300);
  par.height = par.node.clientHeight;
  const scale = paperScale() ?? (window.devicePixelRatio || 1);
  par.canvas.width = par.width * scale;
  par.canvas.height = par.height * scale;
  par.xs = par.names.map((_, i) => axisX(i));
  drawHeads();
  drawParallelAxes();
  drawLines();
  drawSelected();
  point(null);
}

// The points of a design's line; an axis whose measure it lacks is left out.
function pointsOf([study, row]) {
  return par.names.map((name, i) => [par.xs[i], axisY(name, columnOf(study, name)[row])]).filter(([, y]) => !Number.isNaN(y));
}

function pathOf(line) { return line ? `M${pointsOf(line).map((at) => at.map((v) => v.toFixed(1)).join(" ")).join("L")}` : ""; }

function stroke(context, list, tint, width, alpha) {
  Object.assign(context, { lineWidth: width, globalAlpha: alpha });
  for (const line of list) {
    context.strokeStyle = tint(line);
    context.beginPath();
    pointsOf(line).forEach(([x, y]) => context.lineTo(x, y));
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
  const d = state.row === null || !par.names.length ? "" : pathOf([state.study, state.row]);
  for (const path of par.selected.children) if (path !== par.pointed) path.setAttribute("d", d);
}

// The line under the pointer, with words about its design; null: none.
function point(line, at) {
  par.pointed.setAttribute("d", pathOf(line));
  if (line) showTip(par.tip, hoverText(...line), at, par.width);
  else par.tip.hidden = true;
}

// Names over the axes are buttons, so that the keyboard can move them, too; one that is dragged stays the same node.
function drawHeads() {
  if (!par.moving) {
    const focused = document.activeElement.dataset.head;
    par.heads.replaceChildren(...par.names.map(headOf));
    if (focused) par.heads.querySelector(`[data-head="${focused}"]`)?.focus({ preventScroll: true });
  }
  const width = Math.min((par.width - par.left - par.right) / Math.max(par.names.length - 1, 1), 120);
  for (const head of par.heads.children) Object.assign(head.style, { left: `${par.xs[par.names.indexOf(head.dataset.head)]}px`, width: `${width}px` });
}

function headOf(name, i) {
  const { label, unit } = quantity[name], words = axisScale(name).kind === "linear" ? unit : `${unit}, log`;
  const head = make("button", { type: "button", "data-head": name, title: "Drag it, or move it with the arrow keys", "aria-label": `${label} ${words}, axis ${i + 1} of ${par.names.length}: the arrow keys move it` }, make("b", {}, label), ` ${words}`);
  const movedTo = (to) => par.names.filter((one) => one !== name).toSpliced(Math.max(to, 0), 0, name);
  head.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    setParallel(movedTo(par.names.indexOf(name) + step));
  });
  head.addEventListener("pointerdown", (event) => head.setPointerCapture(event.pointerId));
  head.addEventListener("pointermove", (event) => {
    if (!head.hasPointerCapture(event.pointerId)) return;
    const [x] = pointerIn(par.node, event), away = par.xs.map((own) => Math.abs(own - x));
    const to = away.indexOf(Math.min(...away));
    if (to === par.names.indexOf(name)) return;
    par.moving = movedTo(to);
    drawParallel();
  });
  head.addEventListener("lostpointercapture", () => {
    const names = par.moving;
    par.moving = null;
    if (names) setParallel(names);
  });
  return head;
}

function drawParallelAxes() {
  par.svg.replaceChildren(...par.names.map((name, i) => {
    const q = quantity[name], x = par.xs[i], scale = axisScale(name), [low, high] = scale.range;
    const group = draw("g", { class: "axis", "data-axis": name, "data-kind": scale.kind, "data-soft": high * SOFT_SHARE });
    group.append(draw("rect", { x: x - 20, y: par.top - 8, width: 40, height: par.height - par.top - par.bottom + 16, fill: "transparent" }));
    group.append(draw("line", { x1: x, x2: x, y1: par.top, y2: par.height - par.bottom, stroke: "var(--soft)" }));
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
    const rows = feasibleRows(page.studies[i]), mask = masked(i);
    onFront += keptFront(i).length;
    total += rows.length;
    all += rows.filter((row) => mask[row]).length;
  }
  note.textContent = `Within the conditions: ${onFront} designs on the front, ${all} of ${total} feasible trials on this page. ${words} `;
  note.append(buttonOf("Drop all conditions", clearConditions, { id: "clear-ranges" }));
}

function buildFields() {
  byId("brush-fields").replaceChildren(...axesShown().map((name) => {
    const [from, to] = rangeFields(name, (word) => ({ "aria-label": `${quantity[name].label} ${word}, ${quantity[name].unit}`, "data-range": `${name}-${word}` }));
    return make("div", {}, titled(name), make("span", {}, from, " ", to));
  }));
  fillRanges();
}

function nearestLine(x, y) {
  let best = null, least = LINE_PX;
  const left = par.xs.findLastIndex((at) => at <= x);
  if (left < 0 || left >= par.names.length - 1) return null;
  const share = (x - par.xs[left]) / (par.xs[left + 1] - par.xs[left]);
  for (const line of [...par.front, ...par.others]) {
    const [a, b] = [left, left + 1].map((i) => axisY(par.names[i], columnOf(line[0], par.names[i])[line[1]]));
    const off = Math.abs(a + share * (b - a) - y);
    if (off < least) { least = off; best = line; }
  }
  return best;
}

function startParallel() {
  [par.canvas, par.selected, par.svg, par.heads, par.tip] = par.node.children;
  par.pointed = par.selected.lastElementChild;
  buildFields();
  for (const name of new Set([...AXES, ...axisNames()])) byId("parallel-axes").append(switchOf({ "data-parallel": name }, "", titled(name), "parallel", () => axesShown().includes(name), (shown) => setParallel([...axesShown().filter((one) => one !== name), ...(shown ? [name] : [])])));
  listenToAxes();
  on("selection", drawSelected);
  on("conditions", ({ final }) => { if (!final) drawParallelAxes(); });
  const redraw = lazily("parallel-chart", drawParallel);
  const follow = () => { linesToDraw(); describeRanges(); redraw(); };
  on("view", follow);
  on("parallel", () => { buildFields(); redraw(); });
  follow();
}

// A mouse draws a range on an axis; a finger scrolls, and types its ranges.
function listenToAxes() {
  let drag = null;
  par.node.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    const [x, y] = pointerIn(par.node, event);
    const i = par.xs.findIndex((value) => Math.abs(value - x) < 20);
    drag = { name: par.names[i] ?? null, x, y, moved: false };
    point(null);
    if (drag.name && event.pointerType !== "touch") par.node.setPointerCapture(event.pointerId);
  });
  par.node.addEventListener("pointermove", (event) => {
    const [x, y] = pointerIn(par.node, event);
    if (!drag && event.pointerType !== "touch") point(event.target.closest("button") ? null : nearestLine(x, y), [x, y]);
    if (!drag?.name || event.pointerType === "touch") return;
    if (Math.abs(y - drag.y) > 4) drag.moved = true;
    if (drag.moved) setRange(drag.name, [drag.y, y].map((one) => Number(valueAtY(drag.name, one).toPrecision(5))).sort((a, b) => a - b), false);
  });
  par.node.addEventListener("pointerup", (event) => {
    if (!drag) return;
    const [x, y] = pointerIn(par.node, event);
    if (drag.moved) setRange(drag.name, state.ranges[drag.name]);
    else if (drag.name && state.ranges[drag.name]) setRange(drag.name, null);
    else {
      const line = nearestLine(x, y);
      if (line) select(...line);
    }
    drag = null;
  });
  par.node.addEventListener("pointerleave", () => point(null));
  par.node.addEventListener("pointercancel", () => { drag = null; });
}
