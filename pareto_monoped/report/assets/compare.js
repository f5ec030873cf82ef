// Kept designs side by side: one table of what differs, their jumps over each other, and their robots playing together.

function comparedRows(designs) {
  const value = (name) => (chosen) => chosen.values[name] ?? valueAt(chosen.index, name, chosen.row);
  const measured = [...new Set([...page.goals, ...page.compared])].filter((name) => designs.some((one) => value(name)(one) !== null));
  const line = (name) => ({ label: quantity[name].label, cells: designs.map((one) => shown(name, value(name)(one), false)), unit: quantity[name].unit, numbers: designs.map((one) => value(name)(one)), better: page.directions[name] });
  const gears = (side, label, of) => ({ label: `${side} ${label}`, unit: "", cells: designs.map((one) => (one[side] ? of(one[side]) : "–")) });
  const bodies = [...new Set(designs.flatMap((one) => Object.keys(one.more)))]
    .map((name) => ({ label: `mass of the ${name.replace("_kg", "")}`, unit: "kg", cells: designs.map((one) => (one.more[name] === undefined ? "–" : round(one.more[name]))) }));
  return [
    ["Variables", page.variables.map((variable) => line(variable.name))],
    ["Gearboxes", ["hip", "knee"].flatMap((side) => [
      gears(side, "gearbox", (g) => `${g.family} ${g.sun_teeth}/${g.planet_teeth}/${g.ring_teeth} m ${g.module_mm}`),
      gears(side, "ratio", (g) => `${round(g.ratio, 2)} : 1`),
      ...(KITS.length ? [gears(side, "motor", (g) => g.motor)] : []),
    ])],
    ["Masses", [...bodies, ...["hip", "knee"].map((side) => gears(side, "actuator, kg", (g) => round(g.mass_kg)))]],
    ["Energies and loads", measured.map(line)],
  ];
}

function comparisonTable(designs) {
  const groups = comparedRows(designs);
  const names = designs.map((one, i) => make("th", { scope: "col", class: "n" }, make("span", { class: "swatch", style: `background: var(--c${i % 6})` }), nameOf(one.index, one.row)));
  const table = make("table", { class: "compare" }, make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "quantity"), ...names, make("th", { scope: "col" }, "unit"))));
  for (const [title, rows] of groups) {
    const body = make("tbody", {}, make("tr", { class: "group" }, make("th", { scope: "rowgroup", colspan: designs.length + 2 }, title)));
    for (const row of rows) {
      const differs = new Set(row.cells).size > 1;
      const found = (row.numbers ?? []).filter((number) => number !== null);
      const best = differs && row.better && found.length ? Math[row.better === "maximise" ? "max" : "min"](...found) : null;
      const cells = row.cells.map((cell, i) => make("td", { class: "n" }, best !== null && row.numbers[i] === best ? make("b", { title: "best of these" }, cell) : cell));
      body.append(make("tr", { class: differs ? null : "same" }, make("th", { scope: "row" }, row.label), ...cells, make("td", {}, row.unit)));
    }
    table.append(body);
  }
  return make("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Kept designs compared" }, table);
}

// Heights of the bases over time, and the moments of lift-off.
function jumpsChart(box, entries) {
  const tints = entries.map(({ tint }) => colour(tint.slice(6, -1)));
  const series = entries.map(({ jump }, i) => ({ x: jump.time_s, y: jump.base_z_m, colour: tints[i], thick: 2 }));
  const x = [0, Math.max(...entries.map(({ jump }) => jump.time_s.at(-1)))];
  const title = "height of the base, m; circles: lift-off";
  const y = padded(extent(series.flatMap((one) => one.y)));
  const lifts = { x: entries.map(({ jump }) => jump.lift_off_s), y: entries.map(({ jump }) => mixed(jump, "base_z_m", frameAt(jump, jump.lift_off_s))), mark: entries.map(() => "circle-open"), size: 9, colours: tints };
  [race.chart] = subplots(box, [{ title, x, y, xTitle: "time, s", series: [...series, lifts] }], { height: 240 });
  describe(box, `Jumps of ${entries.length} kept designs over each other`);
  race.cursor = make("div", { class: "cursor", "aria-hidden": "true" });
  Object.assign(race.cursor.style, { top: `${race.chart.top}px`, height: `${race.chart.h}px` });
  box.append(race.cursor);
}

const LANE_M = 0.52; // from one robot to the next

function raceStage(designs) {
  const wide = LANE_M * (designs.length - 1) + 1.1;
  const svg = drawStage(`The robots of ${designs.length} kept designs at one scale`, wide);
  race.entries = designs.map((chosen, i) => {
    const jump = jumpOf(chosen), tint = `var(--c${i % 6})`;
    const lane = draw("g", { transform: `translate(${(i - (designs.length - 1) / 2) * LANE_M - 0.15} 0)` });
    if (jump) lane.append(coursePath(jump, { stroke: tint }));
    const robotHere = drawRobot(chosen, { marks: false });
    lane.append(robotHere.node, draw("rect", { x: -0.12, y: 0.016, width: 0.24, height: 0.026, fill: tint }));
    svg.append(lane);
    return { jump, tint, pose: robotHere.pose };
  });
  return svg;
}

// All kept designs jump at once.
const race = new Player(["race-play", "race-scrub", "race-speed"], "Play all", () => Math.max(0, ...race.entries.map(({ jump }) => jump?.time_s.at(-1) ?? 0)), () => {
  for (const { jump, pose } of race.entries) pose(jump, jump ? Math.min(race.time, jump.time_s.at(-1)) : 0);
  if (race.cursor) race.cursor.style.left = `${race.chart.toX(race.time)}px`;
});
race.entries = [];

let compared = "";

function showComparison() {
  const key = state.shortlist.map(({ study, row }) => `${study}:${row}`).join(" ");
  if (key === compared) return;
  compared = key;
  const enough = state.shortlist.length > 1;
  byId("comparison").hidden = !enough;
  race.entries = [];
  race.cursor = null;
  if (!enough) return;
  const designs = state.shortlist.map(({ study, row }) => trialSubject(study, row));
  byId("compare-table").replaceChildren(comparisonTable(designs));
  byId("race-stage").replaceChildren(raceStage(designs));
  const jumping = race.entries.filter(({ jump }) => jump);
  const chart = make("div", { class: "cells" });
  byId("race-chart").replaceChildren(jumping.length ? chart : small("This page has no jumps of these designs."));
  if (jumping.length) jumpsChart(chart, jumping);
  const missing = race.entries.length - jumping.length;
  if (missing && jumping.length) byId("race-chart").append(small(`${missing} of them ${missing > 1 ? "are" : "is"} not on a front, so this page has no jump of ${missing > 1 ? "them" : "it"}.`));
  byId("export-all").replaceChildren(commandLine(exportCommand()));
  race.reset(jumping.length > 0);
  race.set(jumping.length ? Math.min(...jumping.map(({ jump }) => jump.lift_off_s)) : 0);
}

function startComparison() {
  on("shortlist", showComparison);
  showComparison();
}
