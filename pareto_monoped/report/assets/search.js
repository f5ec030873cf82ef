// Convergence, the stage 1 map and link mass.

function drawConvergence(node) {
  const comparison = page.comparison;
  if (!page.studies.some((study) => study.history.evaluations.length)) {
    node.replaceChildren(small("No generation is complete yet, so there is no convergence to show."));
    node.style.height = "auto";
    return;
  }
  // Hypervolumes under different objectives have different units: each then is a share of its last value.
  const alike = page.studies.every((study) => String(study.objectives) === String(page.objectives));
  const unit = alike ? page.studies[0].hypervolume_unit : "% of the last";
  const volumes = ({ hypervolume: all }) => (alike ? all : all.map((value) => 100 * value / (all.at(-1) || 1)));
  const list = page.studies.map((study, i) => ({
    mode: study.history.evaluations.length > 1 ? "lines" : "markers", name: study.label,
    x: study.history.evaluations, y: volumes(study.history), line: { ...seriesStyle(i), shape: "hv" }, marker: { size: 6, symbol: "circle", color: studyColour(i) },
    text: (k) => `${plain(study.label)}<br>${study.history.evaluations[k]} evaluations: ${round(volumes(study.history)[k])} ${unit}`,
  }));
  (comparison?.growth ?? []).forEach((growth, k) => {
    const first = page.studies.findIndex((study) => study.label === growth.labels[0]);
    list.push(...band(growth.evaluations, growth.low, growth.median, growth.high, studyColour(first), growth.middle));
  });
  plot(node, list, "evaluations", `hypervolume, ${unit}`, { fromZero: [true, false], names: list.length > 1 });
  const last = page.studies[0].history;
  describe(node, last.evaluations.length ? `Hypervolume over evaluations: ${round(last.hypervolume.at(-1), 2)} ${page.studies[0].hypervolume_unit} after ${last.evaluations.at(-1)}` : "No evaluations yet");
}

// Attainment surfaces of several seeds: what the best, the median and the worst run reached.
function drawAttainment(node) {
  const list = page.comparison.surfaces.flatMap((surface) => {
    const first = page.studies.findIndex((study) => study.label === surface.labels[0]);
    const tint = studyColour(first);
    const line = (name, y, dash, width) => ({
      mode: "lines", name, x: inUnit(SECOND, y), y: inUnit(FIRST, surface.first), line: { color: tint, dash, width },
      text: (i) => `${name}<br>${plain(quantity[FIRST].label)} ${shown(FIRST, surface.first[i])}, ${plain(quantity[SECOND].label)} ${shown(SECOND, y[i])}`,
    });
    return [line("best seed", surface.best, "dot", 1.2), ...(surface.median.length ? [line(`median of ${surface.labels.length} seeds`, surface.median, "solid", 2.5)] : []), line("worst seed", surface.worst, "dash", 1.2)];
  });
  plot(node, list, titled(SECOND), `${quantity[FIRST].label} reached, ${quantity[FIRST].unit}`, { fromZero: [true, false] });
  describe(node, `Attainment surfaces: the ${quantity[FIRST].label} that the best, the median and the worst seed reached at each ${quantity[SECOND].label}`);
}

function drawMap(node) {
  const list = [];
  const style = { ISSPG: [colour("c2"), "circle"], ESSPG: [colour("c0"), "diamond"] };
  const many = page.maps.length > 2; // colours then tell motors apart, filled symbols only one
  page.maps.forEach((map, k) => {
    for (const [family, [own, symbol]] of Object.entries(style)) {
      const tint = many ? colour(`c${k % 6}`) : own;
      const rows = map.points.filter((p) => p.family_mass_kg[family] !== undefined);
      const best = (p) => p.gearbox !== null && page.gearboxes[p.gearbox].family === family;
      list.push({
        mode: "markers", name: `${family}${page.maps.length > 1 ? `, ${map.motor}` : ""}`,
        x: rows.map((p) => p.ratio_low), y: rows.map((p) => p.family_mass_kg[family]),
        marker: { size: 7, symbol: rows.map(() => (k && !many ? `${symbol}-open` : symbol)), color: tint, opacity: rows.map((p) => (best(p) ? 1 : 0.35)) },
        text: (i) => {
          const p = rows[i], g = best(p) ? page.gearboxes[p.gearbox] : null;
          const teeth = g ? `<br>${g.sun_teeth}/${g.planet_teeth}/${g.ring_teeth}, module ${g.module_mm} mm, ${g.planets} planets` : "<br>not the lighter family here";
          return `<b>${family}</b>, [${round(p.ratio_low, 1)}, ${round(p.ratio_low + map.ratio_step, 1)})<br>${round(p.family_mass_kg[family])} kg${teeth}`;
        },
      });
    }
  });
  plot(node, list, "gear ratio", "actuator mass with motor, kg");
  describe(node, `Actuator mass over gear ratio; ${page.maps.map((m) => m.points.filter((p) => p.gearbox !== null).length).join(" and ")} intervals of ${page.maps[0].ratio_step} have a gearbox`);
  byId("map-note").textContent = `Lightest actuator of each family in each ratio interval of ${page.maps[0].ratio_step}${page.maps.length === 1 ? `, motor ${page.maps[0].motor}` : many ? "; circles: ISSPG, diamonds: ESSPG" : "; open symbols: the second motor"}. Faint: the other family is lighter.`;
}

function drawLinks(node) {
  const inMm = (leg) => leg.length_m.map((l) => l * 1000);
  const line = (name, x, y, more) => ({ mode: "lines", name, x, y, line: more, text: (i) => `${plain(name)}<br>${round(x[i], 0)} mm: ${round(y[i])} kg` });
  const links = page.maps.flatMap(({ motor, leg }, k) => [["thigh", "hip"], ["shank", "knee"]].map(([part, joint]) => (
    line(`${part}${page.maps.length > 1 ? `, ${motor}` : ""}`, inMm(leg), leg[`${part}_kg`], { color: colour(joint), width: 2.2, dash: k ? "dot" : "solid" })
  )));
  const [{ leg }] = page.maps, { published_link_kg: base, published_link_kg_per_m: slope } = page.constants;
  const list = [...links, line("published link", inMm(leg), leg.length_m.map((l) => base + slope * l), { color: colour("faint"), width: 1.6, dash: "dash" })];
  plot(node, list, "link length, mm", "mass, kg", { fromZero: [false, true] });
}

function startSearch() {
  lazily("convergence", drawConvergence);
  if (byId("attainment")) lazily("attainment", drawAttainment);
  lazily("map-chart", drawMap);
  lazily("link-chart", drawLinks);
}
