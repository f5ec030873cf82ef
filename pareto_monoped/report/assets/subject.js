// The selection as one object with everything that the page knows of it, a trial or one of the paper's cases.

function subject() {
  if (state.caseName !== null) return caseSubject(state.study, state.caseName);
  return state.row === null ? null : trialSubject(state.study, state.row);
}

function caseSubject(index, name) {
  const study = page.studies[index];
  const at = study.cases.findIndex((c) => c.name === name);
  const made = study.cases[at];
  const published = page.published.find((c) => c.name === name);
  return {
    kind: "case", study, index, name: made.name, values: published.design, measures: { ...made.measures, ...made }, more: {}, status: made.status,
    kit: study.kit, hip: page.gearboxes[study.case_gearboxes.hip[at]] ?? null, knee: page.gearboxes[study.case_gearboxes.knee[at]] ?? null, published,
    why: `published: ${published.height_m.toFixed(3)} m on ${published.energy_j.toFixed(2)} J`,
  };
}

function trialSubject(index, row) {
  const study = page.studies[index];
  const { columns, packed } = study.trials;
  const number = study.trials.trial[row];
  const values = Object.fromEntries(page.variables.map((v) => [v.name, columns[v.name][row]]));
  const at = study.front.indexOf(row);
  const names = [...Object.keys(columns), ...Object.keys(packed ?? {})];
  const measures = Object.fromEntries(names.map((name) => [name, valueAt(index, name, row)]));
  const more = at < 0 ? {} : Object.fromEntries(Object.entries(study.more).map(([name, list]) => [name, list[at]]));
  const letter = study.trials.state[row];
  return {
    kind: "trial", study, index, number, row, values, measures, more, at, why: whyOf(study, row, at), letter, kit: kitOf(study, row),
    audit: study.audits[number] ?? null, model: study.models[number] ?? null,
    hip: page.gearboxes[columns.hip_gearbox[row]] ?? null, knee: page.gearboxes[columns.knee_gearbox[row]] ?? null,
  };
}

function whyOf(study, row, at) {
  const picked = study.picks.find((p) => p.row === row);
  if (picked) return picked.why.replace(/^trial \d+ \(.*?\): /, "");
  if (study.ill_conditioned.includes(row)) return "taken off the front by its audit";
  const kept = keptFront(page.studies.indexOf(study)), place = kept.indexOf(row);
  const unseen = Object.keys(study.audits).length && !study.audits[study.trials.trial[row]] ? "; not audited" : "";
  if (place >= 0) return `on the front${filtered() ? " within the conditions" : ""}, ${place + 1} of ${kept.length}${unseen}`;
  if (at >= 0) return `on the front, ${at + 1} of ${study.front.length}, but not within the conditions`;
  return { f: `feasible, but dominated${unseen}`, i: "infeasible: breaks a constraint", x: "failed: no jump" }[study.trials.state[row]];
}
