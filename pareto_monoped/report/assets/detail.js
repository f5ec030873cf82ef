// Everything in words and numbers about the selected design.

function showSubject(chosen) {
  const box = byId("subject");
  box.replaceChildren();
  byId("headline").replaceChildren();
  if (!chosen) {
    box.append("Nothing is selected.");
    return;
  }
  const several = page.studies.length > 1 ? `, ${chosen.study.label}` : "";
  box.append(chosen.kind === "case" ? `The paper's ${chosen.name === "nominal" ? "nominal design" : `Case ${chosen.name}`}, simulated here${several}` : `Trial ${chosen.number}${several}`);
  const motor = chosen.study.trials.columns.motor ? `${page.kits[chosen.kit].motor}; ` : "";
  box.append(make("span", {}, `${motor}${chosen.why}`));
  const dear = chosen.kind === "trial" ? dearWords(chosen.index, chosen.row) : "";
  if (dear) box.append(make("span", { class: "dear" }, `⚠ ${dear} `, dearer(chosen.measures.height_m)));
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

// A way from a dear design to the one that takes the least from the battery at its height.
function dearer(height) {
  const button = make("button", { type: "button" }, "Show that");
  button.addEventListener("click", () => { state.best = `least ${BATTERY}`; setRange("height_m", [height, null]); showAnswer(true); });
  return button;
}

function showVariables(chosen) {
  const box = make("div", { class: "bounds" });
  if (chosen) {
    for (const variable of page.variables) {
      const q = quantity[variable.name];
      const [low, high] = chosen.study.bounds[variable.name];
      const value = chosen.values[variable.name];
      const label = make("span", { title: `${variable.symbol}: ${variable.meaning}` }, q.label);
      const track = make("div", { class: "track", "aria-hidden": "true" });
      if (high > low) {
        const dot = make("u");
        dot.style.left = `${Math.min(Math.max((value - low) / (high - low), 0), 1) * 100}%`;
        track.append(dot, make("em", {}, tickText(low * q.scale)), make("em", {}, tickText(high * q.scale)));
      } else {
        track.append(make("em", {}, "fixed"));
      }
      box.append(label, track, make("b", {}, shown(variable.name, value)));
    }
  }
  byId("variables").replaceChildren(box);
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

function showGears(chosen) {
  const box = byId("gears");
  box.replaceChildren();
  const { hip, knee } = chosen ?? {};
  if (!hip || !knee) {
    box.append(make("p", { class: "small" }, chosen ? "No gearbox exists for this design's ratios." : "Nothing is selected."));
    return;
  }
  const widest = Math.max(...[hip, knee].flatMap((g) => [g.motor_diameter_mm, g.module_mm * g.ring_teeth + 6]));
  box.append(make("div", { class: "gearpair" }, gearDrawing(hip, widest), gearDrawing(knee, widest)));
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
  box.append(table(["", "hip", "knee"], rows.map(([name, of]) => [name, of(hip), of(knee)])));
}

function showMass(chosen) {
  const box = byId("mass");
  box.replaceChildren();
  const total = chosen?.measures.mass_kg;
  if (!total) {
    box.append(make("p", { class: "small" }, chosen ? "No robot was built from this design." : "Nothing is selected."));
    return;
  }
  const { hip, knee, more, study } = chosen;
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
  const bar = make("div", { class: "stack", "aria-hidden": "true" });
  const body = rows.map(([name, mass], i) => {
    const piece = make("i");
    piece.style.width = `${100 * Math.max(mass, 0) / total}%`;
    piece.style.background = `var(${shades[i]})`;
    bar.append(piece);
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = `var(${shades[i]})`;
    return make("tr", {}, make("th", { scope: "row" }, swatch, name), make("td", { class: "n" }, `${round(mass)} kg`), make("td", { class: "n" }, `${round(100 * mass / total, 0)} %`));
  });
  body.push(make("tr", {}, make("th", { scope: "row" }, make("b", {}, "robot")), make("td", { class: "n" }, make("b", {}, `${round(total)} kg`)), make("td", { class: "n" }, "100 %")));
  box.append(bar, make("table", {}, make("tbody", {}, ...body)));
}

function showMeasures(chosen) {
  const box = byId("measures");
  box.replaceChildren();
  if (!chosen) return;
  const all = { ...chosen.measures, ...chosen.more };
  const skip = new Set([...page.variables.map((v) => v.name), "reason", "status"]);
  const rows = page.quantities.filter((q) => !skip.has(q.name) && all[q.name] !== undefined && all[q.name] !== null && typeof all[q.name] === "number")
    .map((q) => [q.label, shown(q.name, all[q.name])]);
  box.append(rows.length ? table(null, rows) : make("p", { class: "small" }, "No jump, no measures."));
}

function showAudit(chosen) {
  const box = byId("audit");
  box.replaceChildren();
  const audit = chosen?.audit;
  if (chosen?.kind === "trial") box.append(...[asBuilt(chosen), gapOf(chosen.index, chosen.row)].filter(Boolean).map((words) => make("p", { class: "small built" }, words)));
  if (!audit) {
    box.append(make("p", { class: "small" }, chosen?.kind === "trial" && chosen.at >= 0 ? "Not audited yet: the front is audited when the study ends." : chosen ? "Only designs on the front are audited." : "Nothing is selected."));
    return;
  }
  const { good, reason, ...found } = audit;
  box.append(make("p", { class: `verdict${good ? "" : " no"}` }, good ? "Well-conditioned: neither rounding nor the time step decides its height and energy." : `Ill-conditioned: ${reason}.`));
  const rows = Object.entries(found).map(([name, value]) => [quantity[name].label, shown(name, value)]);
  box.append(table(["what changes", "by"], rows));
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

function showCommands(chosen) {
  const box = byId("commands");
  box.replaceChildren();
  if (!chosen) return;
  box.append(...commandsOf(chosen).map(commandLine));
}

// A command with a button that copies it.
function commandLine(line) {
  const button = make("button", { type: "button", "aria-label": `Copy: ${line}` }, "Copy");
  button.addEventListener("click", async () => {
    button.textContent = await copied(line) ? "Copied" : "Select it";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
  return make("div", { class: "command" }, make("code", {}, line), button);
}

async function copied(line) {
  try {
    await navigator.clipboard.writeText(line);
    return true;
  } catch {
    // A page opened as a file may have no clipboard; the older way still works there.
    const area = make("textarea", { style: "position: fixed; opacity: 0" });
    area.value = line;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }
}

function showAll() {
  const chosen = subject();
  showSubject(chosen);
  showVariables(chosen);
  showGears(chosen);
  showMass(chosen);
  showMeasures(chosen);
  showAudit(chosen);
  showCommands(chosen);
}
