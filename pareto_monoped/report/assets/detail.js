// Everything in words and numbers about the selected design.

function showSubject(chosen) {
  const box = byId("subject");
  byId("headline").replaceChildren();
  box.replaceChildren(...(chosen ? [] : ["Nothing is selected."]));
  if (!chosen) return;
  const several = page.studies.length > 1 ? `, ${chosen.study.label}` : "";
  box.append(chosen.kind === "case" ? `The paper's ${chosen.name === "nominal" ? "nominal design" : `Case ${chosen.name}`}, simulated here${several}` : `Trial ${chosen.number}${several}`);
  const motor = chosen.study.trials.columns.motor ? `${page.kits[chosen.kit].motor}; ` : "";
  box.append(make("span", {}, `${motor}${chosen.why}`));
  const dear = chosen.kind === "trial" ? dearWords(chosen.index, chosen.row) : "";
  if (dear) box.append(make("span", { class: "dear" }, `⚠ ${dear} `, dearer(chosen)));
  const heads = new Set([...page.goals, ...page.leading]);
  for (const name of heads) {
    if (chosen.measures[name] === undefined) continue;
    byId("headline").append(make("div", {}, make("b", {}, shown(name, chosen.measures[name])), quantity[name].label));
  }
  // The same work against gravity as a share of either energy.
  const { height_m: h, mass_kg: m } = chosen.measures;
  for (const [name, label] of Object.entries(page.energies)) {
    const e = chosen.measures[name];
    if (!(h && e && m)) continue;
    const share = m * GRAVITY * (h - START_HEIGHT) / e;
    byId("headline").append(make("div", { title: `m g (height - ${START_HEIGHT} m) / ${quantity[name].label}` }, make("b", {}, shown("efficiency", share)), label));
  }
}

// A way from a dear design to the one that takes the least from the battery at its height, which a study with more
// variables free would outdo.
function dearer({ study, measures: { height_m: height } }) {
  return buttonOf("Show that", () => { for (const i of study.wider) state.visible.delete(i); state.best = `least ${BATTERY}`; setRange("height_m", [height, null]); showAnswer(true); });
}

function variablesOf(chosen) {
  const box = make("div", { class: "bounds" });
  for (const { name, symbol, meaning } of page.variables) {
    const { label, scale } = quantity[name], [low, high] = chosen.study.bounds[name], value = chosen.values[name];
    const share = Math.min(Math.max((value - low) / (high - low), 0), 1);
    const ends = high > low ? [make("u", { style: `left: ${100 * share}%` }), ...[low, high].map((end) => make("em", {}, tickText(end * scale)))] : [make("em", {}, "fixed")];
    box.append(make("span", { title: `${symbol}: ${meaning}` }, label), make("div", { class: "track", "aria-hidden": "true" }, ...ends), make("b", {}, shown(name, value)));
  }
  return [box];
}

function gearDrawing(gearbox, widest) {
  const reach = widest / 2 + 4;
  const svg = draw("svg", { viewBox: `${-reach} ${-reach} ${2 * reach} ${2 * reach}`, role: "img", "aria-label": `${gearbox.family}: sun ${gearbox.sun_teeth}, ${gearbox.planets} planets of ${gearbox.planet_teeth}, ring ${gearbox.ring_teeth} teeth, to scale inside the motor's diameter` });
  const circle = (x, y, r, fill, more = {}) => svg.append(draw("circle", { cx: x, cy: y, r, fill, stroke: "var(--card)", "stroke-width": 0.6, ...more }));
  const m = gearbox.module_mm / 2;
  circle(0, 0, gearbox.motor_diameter_mm / 2, "none", { stroke: "var(--soft)", "stroke-dasharray": "2 2", "stroke-width": 0.8 });
  circle(0, 0, m * gearbox.ring_teeth + 3, "var(--metal)");
  circle(0, 0, m * gearbox.ring_teeth, "var(--card)");
  const distance = m * (gearbox.sun_teeth + gearbox.planet_teeth);
  for (let k = 0; k < gearbox.planets; k += 1) {
    const angle = 2 * Math.PI * k / gearbox.planets - Math.PI / 2;
    const x = distance * Math.cos(angle), y = distance * Math.sin(angle);
    circle(x, y, m * gearbox.planet_teeth, "var(--c0)");
    circle(x, y, 2, "var(--card)");
  }
  circle(0, 0, m * gearbox.sun_teeth, "var(--c4)");
  circle(0, 0, 2.5, "var(--card)");
  return svg;
}

function table(head, rows) {
  const node = make("table");
  if (head) node.append(make("thead", {}, make("tr", {}, ...head.map((cell, i) => make(cell ? "th" : "td", cell ? { class: i ? "n" : null, scope: "col" } : {}, cell)))));
  node.append(make("tbody", {}, ...rows.map((row) => make("tr", {}, ...row.map((cell, i) => (i ? make("td", { class: "n" }, cell) : make("th", { scope: "row" }, cell)))))));
  return node;
}

function gearsOf({ hip, knee }) {
  if (!hip || !knee) return [small("No gearbox exists for this design's ratios.")];
  const widest = Math.max(...[hip, knee].flatMap((g) => [g.motor_diameter_mm, g.module_mm * g.ring_teeth + 6]));
  const rows = [
    ["motor", (g) => g.motor],
    ["family", (g) => g.family],
    ["teeth sun/planet/ring", (g) => `${g.sun_teeth}/${g.planet_teeth}/${g.ring_teeth}`],
    ["module", (g) => `${g.module_mm} mm`],
    ["planets", (g) => `${g.planets}`],
    ["face width", (g) => `${round(g.face_width_mm, 1)} mm`],
    ["real ratio", (g) => `${round(g.ratio, 3)} : 1`],
    ["mass with motor", (g) => `${round(g.mass_kg)} kg`],
    ["peak torque", (g) => `${round(g.peak_torque_n_m, 1)} N m`],
    ["no-load speed", (g) => `${round(g.no_load_speed_rad_per_s, 1)} rad/s`],
    ["mesh efficiency", (g) => `${round(100 * g.efficiency, 1)} %`],
  ];
  return [make("div", { class: "gearpair" }, gearDrawing(hip, widest), gearDrawing(knee, widest)), table(["", "hip", "knee"], rows.map(([name, of]) => [name, of(hip), of(knee)]))];
}

function massOf({ hip, knee, more, study, measures }) {
  const total = measures.mass_kg;
  if (!total) return [small("No robot was built from this design.")];
  const rows = [];
  if (hip) rows.push(["hip actuator", hip.mass_kg]);
  if (knee) rows.push(["knee actuator", knee.mass_kg]);
  if (more.base_kg !== undefined && hip && knee) {
    rows.push(["base frame", more.base_kg - hip.mass_kg], ["thigh with chain and journal", more.thigh_kg - knee.mass_kg]);
    rows.push(["shank", more.shank_kg - study.foot_mass_kg], ["foot", study.foot_mass_kg]);
  } else {
    rows.push(["base frame, thigh, shank and foot", total - rows.reduce((sum, row) => sum + row[1], 0)]);
  }
  const shades = ["--c1", "--c0", "--c4", "--c2", "--c3", "--dark"];
  const pieces = rows.map(([, mass], i) => make("i", { style: `width: ${100 * Math.max(mass, 0) / total}%; background: var(${shades[i]})` }));
  const named = (name, i) => make("span", {}, make("span", { class: "swatch", style: `background: var(${shades[i]})` }), name);
  const body = rows.map(([name, mass], i) => [named(name, i), `${round(mass)} kg`, `${round(100 * mass / total, 0)} %`]);
  return [make("div", { class: "stack", "aria-hidden": "true" }, ...pieces), table(null, [...body, [make("b", {}, "robot"), make("b", {}, `${round(total)} kg`), "100 %"]])];
}

function measuresOf(chosen) {
  const all = { ...chosen.measures, ...chosen.more };
  const skip = new Set([...page.variables.map((v) => v.name), "reason", "status"]);
  const rows = page.quantities.filter((q) => !skip.has(q.name) && all[q.name] !== undefined && all[q.name] !== null && typeof all[q.name] === "number")
    .map((q) => [q.label, shown(q.name, all[q.name])]);
  return [rows.length ? table(null, rows) : small("No jump, no measures.")];
}

function auditOf(chosen) {
  const built = chosen.kind === "trial" ? [asBuilt(chosen), gapOf(chosen.index, chosen.row)].filter(Boolean).map(small) : [];
  if (!chosen.audit) return [...built, small(chosen.at >= 0 ? "Not audited yet: the front is audited when the study ends." : "Only designs on the front are audited.")];
  const { good, reason, ...found } = chosen.audit;
  const verdict = good ? "Well-conditioned: neither rounding nor the time step decides its height and energy." : `Ill-conditioned: ${reason}.`;
  const rows = Object.entries(found).map(([name, value]) => [quantity[name].label, shown(name, value)]);
  return [...built, make("p", { class: `verdict${good ? "" : " no"}` }, verdict), table(["what changes", "by"], rows)];
}

// The physical test beside the numerical one: what jumps under uncertainty say of a design.
function asBuilt(chosen) {
  const { index, row, number } = chosen, { robust } = page.studies[index];
  const of = (name) => valueAt(index, name, row);
  if (!robust?.rows.includes(row)) return `Not tested as built: pareto-monoped robust DB --trial ${number} does that.`;
  const range = (name) => (of(`${name}.p05`) === null ? "" : `${quantity[name].label} ${shown(name, of(`${name}.p05`))} to ${shown(name, of(`${name}.p95`))}, `);
  const share = (name) => `${(100 * of(name)).toFixed(1)} %`;
  return `Tested as built in ${robust.samples} jumps, nine of ten robots: ${page.objectives.map((name) => range(name.split(".")[0])).join("")}${share("failed_share")} of the jumps fail, ${share("overloaded_share")} overload a part.`;
}

// A word, quoted for a POSIX shell where necessary.
function quoted(word) { return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`; }

function commandsOf(chosen) {
  const settings = Object.entries(chosen.values).map(([name, value]) => `--set ${name}=${value}`).join(" ");
  const [hip, knee] = chosen.study.motor_names[chosen.kit].map(quoted);
  const motors = hip === knee ? `--motor ${hip}` : `--hip-motor ${hip} --knee-motor ${knee}`;
  const simulate = `pareto-monoped simulate ${settings} ${motors} --calibration ${quoted(chosen.study.calibration_name)}`;
  if (chosen.kind === "case") return [`pareto-monoped simulate --case ${chosen.name} ${motors} --calibration ${quoted(chosen.study.calibration_name)}`];
  if (chosen.at < 0) return [simulate];
  const db = quoted(chosen.study.database);
  return [`pareto-monoped pick ${db} --trial ${chosen.number}`, `pareto-monoped export ${db} --trial ${chosen.number} -o cad/trial_${chosen.number}`, simulate];
}

// A command with a button that copies it.
function commandLine(line) {
  const button = buttonOf("Copy", async () => {
    button.textContent = await copied(line) ? "Copied" : "Select it";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  }, { "aria-label": `Copy: ${line}` });
  return make("div", { class: "command" }, make("code", {}, line), button);
}

// Whether the clipboard took it.
async function copied(line) { return (navigator.clipboard?.writeText(line).then(() => true, () => false)) ?? false; }

function showAll() {
  const chosen = subject();
  showSubject(chosen);
  const parts = { variables: variablesOf, gears: gearsOf, mass: massOf, measures: measuresOf, audit: auditOf, commands: (one) => commandsOf(one).map(commandLine) };
  for (const [id, nodesOf] of Object.entries(parts)) byId(id).replaceChildren(...(chosen ? nodesOf(chosen) : [small("Nothing is selected.")]));
}
