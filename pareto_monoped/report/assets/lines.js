// Small line charts in plain SVG, which are quick to redraw at every selection.

// A chart of series {x, y, colour, dash, mark}; returns its node with functions from values to pixels.
function smallChart({ width = 320, height = 150, left = 46, right = 8, top = 18, bottom = 30, x, y, xTitle, title, series = [], label }) {
  const w = width - left - right, h = height - top - bottom;
  const toX = (value) => left + (value - x[0]) / (x[1] - x[0] || 1) * w;
  const toY = (value) => top + h - (value - y[0]) / (y[1] - y[0] || 1) * h;
  const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label ?? title });
  for (const value of ticks(y[0], y[1], 3)) {
    svg.append(draw("line", { x1: left, x2: left + w, y1: toY(value), y2: toY(value), class: "gridline" }));
    svg.append(text(left - 5, toY(value) + 4, tickText(value), "end"));
  }
  for (const value of ticks(x[0], x[1], 4)) svg.append(text(toX(value), top + h + 14, tickText(value), "middle"));
  svg.append(draw("rect", { x: left, y: top, width: w, height: h, class: "frame" }));
  svg.append(text(4, 11, title, "start", "strong"));
  if (xTitle) svg.append(text(left + w, height - 3, xTitle, "end"));
  for (const one of series) {
    if (one.mark) {
      one.x.forEach((value, i) => {
        if (one.y[i] !== null) svg.append(marker(one.mark[i], toX(value), toY(one.y[i]), one.colours?.[i] ?? one.colour, one.opacity ? one.opacity[i] : 1));
      });
    } else {
      const d = one.x.map((value, i) => `${toX(value).toFixed(1)} ${toY(one.y[i]).toFixed(1)}`).join("L");
      svg.append(draw("path", { d: `M${d}`, fill: "none", stroke: one.colour, "stroke-width": one.thick ?? 1.6, "stroke-dasharray": one.dash ?? "none" }));
    }
  }
  return { svg, toX, toY, left, top, w, h };
}

function marker(kind, x, y, fill, opacity = 1) {
  if (kind === "diamond") return draw("path", { d: `M${x} ${y - 4}l4 4l-4 4l-4 -4z`, fill, "fill-opacity": opacity });
  return draw("circle", { cx: x, cy: y, r: 3, fill, "fill-opacity": opacity });
}

function padded([low, high], share = 0.06) {
  const room = share * (high - low) || Math.max(Math.abs(high) * 0.05, 1e-3);
  return [low - room, high + room];
}

// Torque, speed and height of the selected jump, with a line at the moment the picture shows.
let cursors = [];

function drawTimes() {
  const box = byId("time-charts");
  box.replaceChildren();
  cursors = [];
  const chosen = subject();
  const j = player.jump;
  if (!j) {
    box.append(make("p", { class: "small" }, noJump(chosen)));
    return;
  }
  const x = [0, endTime()];
  const legend = make("p", { class: "small" });
  for (const [name, tint] of [["hip", "--hip"], ["knee", "--knee"]]) {
    legend.append(make("span", { class: "swatch", style: `background: var(${tint})` }), name);
  }
  legend.append(`; dashed: limits of the gearboxes and end stops; vertical: lift-off at ${round(j.lift_off_s)} s`);
  const level = (value, side) => ({ x, y: [value, value], colour: `var(--${side})`, dash: "3 3", thick: 1 });
  const sides = ["hip", "knee"];
  const limits = sides.flatMap((side) => (chosen[side] ? [1, -1].map((sign) => level(sign * chosen[side].peak_torque_n_m, side)) : []));
  const angles = sides.map((side) => ({ x: j.time_s, y: j[`${side}_rad`].map((angle) => angle * DEGREES), colour: `var(--${side})` }));
  // Of the stops, those that the jump comes near; the others would flatten the lines.
  const stops = sides.flatMap((side, k) => {
    const [low, high] = extent(angles[k].y), near = 0.25 * (high - low);
    const ends = (chosen.study.stops_rad[chosen.kit]?.[k] ?? []).filter((end) => end !== null).map((end) => end * DEGREES);
    return ends.filter((end) => end > low - near && end < high + near).map((end) => level(end, side));
  });
  const pair = (suffix) => sides.map((side) => ({ x: j.time_s, y: j[side + suffix], colour: `var(--${side})` }));
  const rows = [
    { title: "motor torque at the joint, N m", series: [...pair("_motor_torque_n_m"), ...limits] },
    { title: "joint speed, rad/s", series: pair("_rad_per_s") },
    { title: "joint angle, degrees", series: [...angles, ...stops] },
    { title: "force of the floor on the foot, N", series: [{ x: j.time_s, y: j.contact_z_n, colour: "var(--c1)" }] },
    { title: "height of base and (thin) foot, m", series: [{ x: j.time_s, y: j.base_z_m, colour: "var(--ink)" }, { x: j.time_s, y: j.foot_z_m, colour: "var(--ink)", thick: 0.9 }] },
  ];
  rows.forEach((row, i) => {
    const y = padded(extent(row.series.flatMap((s) => s.y)));
    const last = i === rows.length - 1;
    const chart = smallChart({ x, y, title: row.title, series: row.series, xTitle: last ? "time, s" : "", bottom: last ? 32 : 20, height: last ? 132 : 116, label: `${row.title}, over ${round(x[1], 2)} s` });
    const at = chart.toX(j.lift_off_s);
    chart.svg.append(draw("line", { x1: at, x2: at, y1: chart.top, y2: chart.top + chart.h, stroke: "var(--faint)" }));
    const cursor = draw("line", { y1: chart.top, y2: chart.top + chart.h, stroke: "var(--c4)", "stroke-width": 1.5 });
    chart.svg.append(cursor);
    cursors.push({ cursor, toX: chart.toX });
    box.append(chart.svg);
  });
  box.prepend(legend);
  moveCursors();
}

function moveCursors() {
  for (const { cursor, toX } of cursors) {
    cursor.setAttribute("x1", toX(player.time));
    cursor.setAttribute("x2", toX(player.time));
  }
}

function noJump(chosen) {
  if (!chosen) return "Nothing is selected.";
  if (chosen.kind === "case") return `This design does not jump here: ${chosen.measures.reason || chosen.measures.status}.`;
  if (chosen.at < 0) return "Jumps are kept for designs on the front; the commands below simulate this one.";
  if (!chosen.study.jumps.keys.length) return "This page was made without jumps; the commands below simulate this design.";
  return "Simulated again for this page, this design did not come to an apex; the commands below simulate it.";
}

// Each variable against the first objective along the front.
let dots = [];

function drawAlong() {
  const box = byId("along-charts");
  box.replaceChildren();
  dots = [];
  const shownStudies = [...state.visible].filter((i) => page.studies[i].front.length);
  if (!shownStudies.length) {
    byId("along-note").textContent = "There is no front to show.";
    return;
  }
  const firsts = extent(shownStudies.flatMap((i) => page.studies[i].front.map((row) => page.studies[i].trials.columns[FIRST][row])));
  const x = padded(firsts.map((value) => value * quantity[FIRST].scale), 0.03);
  const several = page.studies.length > 1;
  const width = window.innerWidth <= 700 ? 180 : 300; // keeps the words readable on a phone
  for (const variable of page.variables) {
    const q = quantity[variable.name];
    const joint = variable.name.endsWith("_ratio") ? variable.name.replace("_ratio", "_gearbox") : null;
    const limits = extent(page.studies.flatMap((s) => s.bounds[variable.name]));
    const y = padded(limits.map((v) => v * q.scale), 0.08);
    const series = shownStudies.map((i) => {
      const { front, trials } = page.studies[i];
      const family = (row) => (joint ? page.gearboxes[trials.columns[joint][row]]?.family : "ISSPG");
      return {
        x: front.map((row) => trials.columns[FIRST][row] * quantity[FIRST].scale), y: front.map((row) => trials.columns[variable.name][row] * q.scale),
        mark: front.map((row) => (family(row) === "ESSPG" ? "diamond" : "circle")), opacity: front.map((row) => (inRanges(i, row) ? 0.8 : 0.12)),
        colours: trials.columns.motor ? front.map((row) => `var(--c${motorTint(kitOf(page.studies[i], row))})`) : null,
        colour: several ? `var(--c${i % 6})` : "var(--c0)",
      };
    });
    const title = `${q.label}${q.unit === ": 1" ? "" : `, ${q.unit}`}`;
    const chart = smallChart({ width, height: 190, left: 40, x, y, title, xTitle: titled(FIRST), series, label: `${title}, against ${quantity[FIRST].label} along the front` });
    for (const bound of limits) chart.svg.append(draw("line", { x1: chart.left, x2: chart.left + chart.w, y1: chart.toY(bound * q.scale), y2: chart.toY(bound * q.scale), stroke: "var(--faint)", "stroke-dasharray": "2 3" }));
    const change = joint ? switchRatio() : null;
    if (change !== null && change > y[0] && change < y[1]) {
      chart.svg.append(draw("line", { x1: chart.left, x2: chart.left + chart.w, y1: chart.toY(change), y2: chart.toY(change), stroke: "var(--soft)", "stroke-width": 1.4 }));
      chart.svg.append(text(chart.left + chart.w - 3, chart.toY(change) - 4, "ESSPG", "end"), text(chart.left + chart.w - 3, chart.toY(change) + 12, "ISSPG", "end"));
    }
    const dot = draw("circle", { r: 6, fill: "none", stroke: "var(--select)", "stroke-width": 2.5 });
    chart.svg.append(dot);
    dots.push({ dot, chart, variable, q });
    box.append(chart.svg);
  }
  moveDots();
  byId("along-note").textContent = `Each point is one design of the front. Dashed: bounds. Diamonds: ratios with a gearbox outside the motor (ESSPG), circles: inside its stator (ISSPG)${switchRatio() === null ? "" : `; the switch lies at ${switchRatio()} : 1`}.${switchesText()}`;
  const whose = (study) => (page.studies.length > 1 ? `${study.label}: ` : "");
  byId("at-bounds").replaceChildren(...page.studies.flatMap((study) => study.at_bounds.map((line) => make("li", {}, whose(study) + line))));
}

// The ratio from which on all gearboxes are external; null if all are of one family.
function switchRatio() {
  if (current().trials.columns.motor) return null; // each motor has its own
  const { hip, knee } = page.kits[current().kit];
  if (hip !== knee) return null;
  const points = page.maps[hip].points.filter((p) => p.gearbox !== null);
  const at = points.findLastIndex((p) => page.gearboxes[p.gearbox].family === "ISSPG");
  return at >= 0 && at < points.length - 1 ? points[at + 1].ratio_low : null;
}

function switchesText() {
  const { front, trials } = current();
  const at = (value) => `${round(value * quantity[FIRST].scale, 2)} ${quantity[FIRST].unit}`;
  const parts = ["hip", "knee"].map((side) => {
    const families = front.map((row) => page.gearboxes[trials.columns[`${side}_gearbox`][row]]?.family);
    const external = families.filter((f) => f === "ESSPG").length;
    if (!external) return `the ${side} stays with ISSPG`;
    if (external === families.length) return `the ${side} stays with ESSPG`;
    const changes = families.flatMap((f, i) => (i && f !== families[i - 1] ? [trials.columns[FIRST][front[i]]] : []));
    if (changes.length <= 3) return `the ${side} changes at ${changes.map(at).join(", ")}`;
    return `the ${side} has ESSPG in ${external} of ${families.length} designs, changing ${changes.length} times between ${at(changes[0])} and ${at(changes.at(-1))}`;
  });
  return front.length > 1 ? ` Along this front ${parts.join("; ")}.` : "";
}

function moveDots() {
  const chosen = subject();
  for (const { dot, chart, variable, q } of dots) {
    const first = chosen?.measures[FIRST];
    const cx = first === null || first === undefined ? -1 : chart.toX(first * quantity[FIRST].scale);
    const inside = cx >= chart.left && cx <= chart.left + chart.w;
    dot.setAttribute("display", inside ? "inline" : "none");
    if (!inside) continue;
    dot.setAttribute("cx", cx);
    dot.setAttribute("cy", chart.toY(chosen.values[variable.name] * q.scale));
  }
}

function startLines() {
  on("selection", (how) => { drawTimes(); if (how.other) drawAlong(); else moveDots(); });
  on("time", moveCursors);
  on("view", lazily("along-charts", drawAlong));
}
