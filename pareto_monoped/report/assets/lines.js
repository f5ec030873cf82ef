// Jumps over time, and how the variables change along the front.

function padded([low, high], share = 0.06) {
  const room = share * (high - low) || Math.max(Math.abs(high) * 0.05, 1e-3);
  return [low - room, high + room];
}

// Torque, speed and height of the selected jump, with a line at the moment the picture shows.
const times = { places: [], cursor: make("div", { class: "cursor", "aria-hidden": "true" }) };

function drawTimes() {
  const box = byId("time-charts"), chosen = subject(), j = player.jump;
  times.places = [];
  byId("time-legend").hidden = !j;
  times.cursor.hidden = !j;
  if (!j) {
    if (box.data) Plotly.purge(box);
    box.removeAttribute("role");
    box.replaceChildren(small(noJump(chosen)));
    return;
  }
  if (!box.data) box.replaceChildren(times.cursor);
  const sides = ["hip", "knee"], level = (y, side) => ({ y, colour: colour(side), dash: "3px,3px" });
  byId("time-legend").replaceChildren(...sides.flatMap((side) => [make("span", { class: "swatch", style: `background: var(--${side})` }), side]), `; dashed: limits of the gearboxes and end stops; vertical: lift-off at ${round(j.lift_off_s)} s`);
  const limits = sides.flatMap((side) => (chosen[side] ? [1, -1].map((sign) => level(sign * chosen[side].peak_torque_n_m, side)) : []));
  const angles = sides.map((side) => ({ x: j.time_s, y: j[`${side}_rad`].map((angle) => angle * DEGREES), colour: colour(side) }));
  // Of the stops, those that the jump comes near; the others would flatten the lines.
  const stops = sides.flatMap((side, k) => {
    const [low, high] = extent(angles[k].y), near = 0.25 * (high - low);
    const ends = (chosen.study.stops_rad[chosen.kit]?.[k] ?? []).filter((end) => end !== null).map((end) => end * DEGREES);
    return ends.filter((end) => end > low - near && end < high + near).map((end) => level(end, side));
  });
  const pair = (suffix) => sides.map((side) => ({ x: j.time_s, y: j[side + suffix], colour: colour(side) }));
  const ink = colour("ink");
  const cells = [
    { title: "motor torque at the joint, N m", series: pair("_motor_torque_n_m"), lines: limits },
    { title: "joint speed, rad/s", series: pair("_rad_per_s") },
    { title: "joint angle, degrees", series: angles, lines: stops },
    { title: "force of the floor on the foot, N", series: [{ x: j.time_s, y: j.contact_z_n, colour: colour("c1") }] },
    { title: "height of base and (thin) foot, m", xTitle: "time, s", series: [{ x: j.time_s, y: j.base_z_m, colour: ink }, { x: j.time_s, y: j.foot_z_m, colour: ink, thick: 0.9 }] },
  ].map((cell) => {
    const y = padded(extent([...cell.series.flatMap((s) => s.y), ...(cell.lines ?? []).map((line) => line.y)]));
    const lift = { x: [j.lift_off_s, j.lift_off_s], y, colour: colour("faint"), thick: 1 };
    return { ...cell, x: [0, player.end()], y, series: [...cell.series, lift] };
  });
  times.places = subplots(box, cells, { height: 132 });
  describe(box, `${cells.map(({ title }) => title).join("; ")}; over ${round(player.end(), 2)} s`);
  moveCursors();
}

function moveCursors() {
  const [first] = times.places;
  if (first) Object.assign(times.cursor.style, { left: `${first.toX(player.time)}px`, top: `${first.top}px`, height: `${times.places.at(-1).top + times.places.at(-1).h - first.top}px` });
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
  const shownStudies = [...state.visible].filter((i) => page.studies[i].front.length);
  for (const { dot } of dots.splice(0)) dot.remove();
  box.hidden = !shownStudies.length;
  if (!shownStudies.length) {
    byId("along-note").textContent = "There is no front to show.";
    return;
  }
  const firsts = extent(shownStudies.flatMap((i) => page.studies[i].front.map((row) => page.studies[i].trials.columns[FIRST][row])));
  const x = padded(firsts.map((value) => value * quantity[FIRST].scale), 0.03);
  const faint = colour("faint"), firstsOf = new Map();
  const cells = page.variables.map((variable) => {
    const q = quantity[variable.name];
    const joint = variable.name.endsWith("_ratio") ? variable.name.replace("_ratio", "_gearbox") : null;
    const limits = extent(page.studies.flatMap((s) => s.bounds[variable.name])).map((v) => v * q.scale);
    const y = padded(limits, 0.08);
    const one = (i, rows, opacity) => {
      const { trials } = page.studies[i], value = (name, row) => trials.columns[name][row];
      const family = (row) => page.gearboxes[value(joint, row)]?.family;
      return {
        x: once(firstsOf, rows, () => rows.map((row) => value(FIRST, row) * quantity[FIRST].scale)), y: rows.map((row) => value(variable.name, row) * q.scale), opacity,
        mark: joint ? rows.map((row) => (family(row) === "ESSPG" ? "diamond" : "circle")) : "circle", colour: studyColour(i),
        colours: trials.columns.motor ? rows.map((row) => colour(`c${motorTint(kitOf(page.studies[i], row))}`)) : null,
      };
    };
    const series = shownStudies.flatMap((i) => (filtered() ? [one(i, page.studies[i].front, 0.06), one(i, keptFront(i), 0.8)] : [one(i, page.studies[i].front, 0.8)]));
    const change = joint ? switchRatio() : null;
    const line = change !== null && change > y[0] && change < y[1] ? [{ y: change, colour: colour("soft"), width: 1.4, words: "ESSPG" }, { y: change, colour: "rgba(0,0,0,0)", words: "ISSPG", below: true }] : [];
    return { title: `${q.label}${q.unit === ": 1" ? "" : `, ${q.unit}`}`, x, y, xTitle: titled(FIRST), series, lines: [...limits.map((bound) => ({ y: bound, colour: faint, dash: "2px,3px" })), ...line] };
  });
  const columns = Math.max(Math.floor(box.clientWidth / (window.innerWidth <= PHONE_PX ? 170 : 290)), 1);
  const places = subplots(box, cells, { columns, height: 190, key: `${box.clientWidth} ${x} ${faint} ${paperScale()} ${switchRatio()}` });
  describe(box, `${page.variables.map((v) => quantity[v.name].label).join(", ")}, each against ${quantity[FIRST].label} along the front`);
  dots = page.variables.map((variable, k) => {
    const dot = make("div", { class: "ring small-ring", "aria-hidden": "true" });
    box.append(dot);
    return { dot, chart: places[k], variable, q: quantity[variable.name] };
  });
  moveDots();
  byId("along-note").textContent = `Each point is one design of the front. Dashed: bounds. Diamonds: ratios with a gearbox outside the motor (ESSPG), circles: inside its stator (ISSPG)${switchRatio() === null ? "" : `; the switch lies at ${switchRatio()} : 1`}.${page.switches[state.study]}`;
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

function moveDots() {
  const chosen = subject();
  for (const { dot, chart, variable, q } of dots) {
    const first = chosen?.measures[FIRST] ?? null;
    const x = first === null ? -1 : chart.toX(first * quantity[FIRST].scale);
    dot.hidden = !(x >= chart.left && x <= chart.left + chart.w);
    if (!dot.hidden) Object.assign(dot.style, { left: `${x}px`, top: `${chart.toY(chosen.values[variable.name] * q.scale)}px` });
  }
}

function startLines() {
  const again = lazily("time-charts", drawTimes), alongAgain = lazily("along-charts", drawAlong);
  on("selection", (how) => { again(); if (how.other) alongAgain(); else moveDots(); });
  on("time", moveCursors);
  on("view", alongAgain);
}
