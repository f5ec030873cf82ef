// What is known of designs under uncertainty: bars from the 5th to the 95th percentile, and the front of the bad ends;
// and the front of the best torque found with the hardware of the designs.

function hasRobust() { return page.studies.some((study) => study.robust); }

// The end of a measure that nineteen of twenty built robots are better than.
function badEnd(name) { return `${name}.${better(name) > 0 ? "p05" : "p95"}`; }

function robustLayers(study) {
  const { x, y, space } = state.axes;
  const { robust, objectives } = page.studies[study];
  if (space || !robust) return [];
  const known = knownNames();
  const list = [];
  if (state.layers.spread && [x, y].some((name) => known.includes(`${name}.p05`))) {
    const { rows } = page.studies[study].robust;
    const ends = (name) => (known.includes(`${name}.p05`) ? ["p05", "p95"].map((end) => shownColumn(study, `${name}.${end}`, rows)) : null);
    const across = ends(x), up = ends(y);
    list.push({
      name: "spread", mode: "bars", x: shownColumn(study, x, rows), y: shownColumn(study, y, rows), line: { color: colour("soft"), opacity: 0.55 },
      ends: rows.map((_, i) => [...(across ? across.map((end) => end[i]) : [null, null]), ...(up ? up.map((end) => end[i]) : [null, null])]),
    });
  }
  if (state.layers.robust && y === FIRST && objectives.includes(FIRST) && objectives.includes(x)) {
    const rows = robust.front.toSorted((a, b) => valueAt(study, badEnd(x), a) - valueAt(study, badEnd(x), b));
    list.push({
      name: "robust", mode: "lines+markers", x: shownColumn(study, badEnd(x), rows), y: shownColumn(study, badEnd(y), rows), stands: rows.map((row) => [study, row]),
      text: (i) => `<b>robust front: ${shown(y, valueAt(study, badEnd(y), rows[i]))} on ${shown(x, valueAt(study, badEnd(x), rows[i]))} or better in 95 % of jumps each</b><br>${hoverText(study, rows[i])}`,
      marker: { size: 5, symbol: "circle", color: colour("ink") }, line: { color: colour("ink"), width: 1.4, dash: "dash", shape: page.directions[FIRST] === "maximise" ? "hv" : "vh" },
    });
  }
  return list;
}

function hasBest() { return page.studies.some((study) => study.best); }

// Jumps of the best torque found, each a row, height and energy; none on axes of something else.
function bestJumps(study) {
  const { best } = page.studies[study], { x, y, space } = state.axes;
  return best && y === "height_m" && x === best.energy && !space ? best.front : [];
}

function bestLayers(study) {
  const jumps = bestJumps(study), { x, y } = state.axes, tint = studyColour(study);
  if (!state.layers.best || !jumps.length) return [];
  const words = page.studies[study].best.held ? ", no part overloaded" : "";
  return [{
    name: "best", mode: "lines+markers", x: jumps.map(([, , energy]) => inShown(x, energy)), y: jumps.map(([, height]) => inShown(y, height)), stands: jumps.map(([row]) => [study, row]),
    text: (i) => `<b>best torque found with this hardware${words}: ${shown(y, jumps[i][1])} on ${shown(x, jumps[i][2])}</b><br>${hoverText(study, jumps[i][0])}`,
    marker: { size: 8, symbol: "triangle-left-open", color: tint }, line: { color: tint, width: 1.4, dash: "dash" },
  }];
}

// What the best torque found saves of a design's energy at its height; empty where nobody has searched.
function gapOf(index, row) {
  const { best } = page.studies[index], at = best ? best.rows.indexOf(row) : -1;
  if (at < 0 || best.gap[at] === null) return "";
  return `Controller gap: the best torque found with this hardware takes ${best.gap[at].toFixed(1)} % less of ${quantity[best.energy].label} for this height${best.held ? ", with no part overloaded" : ""}.`;
}
