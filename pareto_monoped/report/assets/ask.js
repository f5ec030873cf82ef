// Ask the front: conditions that may hold together, and the best design that meets them all.

function better(name) { return (page.directions[name] ?? page.measure_directions[name]) === "maximise" ? 1 : -1; }

// The end of a range that a question sets: the least of what should be much, the most of what should be little.
function askedEnd(name) { return better(name) > 0 ? 0 : 1; }

// Words for the paper's measures; any other is called by its label.
function superlative(name) {
  if (name === "height_m") return "the highest jump";
  return `the ${better(name) > 0 ? "most" : "least"} ${quantity[name].label}`;
}

function conditionText(name, [least, most]) {
  const { label, unit } = quantity[name];
  const number = (value) => Number((value * quantity[name].scale).toPrecision(5));
  if (least !== null && most !== null) return `${label} ${number(least)} to ${number(most)} ${unit}`;
  return least !== null ? `${label} ≥ ${number(least)} ${unit}` : `${label} ≤ ${number(most)} ${unit}`;
}

function measuresInWords([study, row]) {
  const { trials, label } = page.studies[study];
  const asked = Object.keys(state.ranges).filter((name) => !page.objectives.includes(name) && !page.variables.some((v) => v.name === name));
  const rest = asked.map((name) => `, ${quantity[name].label} ${shown(name, valueAt(study, name, row))}`).join("");
  return `trial ${trials.trial[row]}${page.studies.length > 1 ? ` of ${label}` : ""}, ${told(page.objectives, (key) => trials.columns[key][row])}${rest}`;
}

// Of some designs the one that misses the conditions least, each miss as a share of its measure's extent: the least
// greatest miss, then the least sum.
function nearestOf({ size, stand, joined }, list) {
  const missed = list.map(({ name, side, value }) => {
    const values = joined((study) => columnOf(study, name)), [low, high] = extent(values);
    return values.map((one) => (Number.isNaN(one) ? Infinity : Math.max(side ? one - value : value - one, 0) / (high - low || 1)));
  });
  const [worst, sum] = [(i) => Math.max(...missed.map((one) => one[i])), (i) => missed.reduce((all, one) => all + one[i], 0)];
  let best = 0;
  for (let i = 1; i < size; i += 1) if ((worst(i) - worst(best) || sum(i) - sum(best)) < 0) best = i;
  return stand(best);
}

// A number of five digits, in the unit shown, that a value still meets as a condition.
function enough(value, side) {
  const rounded = Number(value.toPrecision(5));
  if (side ? rounded >= value : rounded <= value) return rounded;
  const step = 10 ** (Math.floor(Math.log10(Math.abs(value))) - 4);
  return Number((side ? rounded + step : rounded - step).toPrecision(5));
}

// Why nothing meets the conditions: the nearest design, and which of them alone would have to give how much.
function nothing() {
  const list = conditionList();
  const wanted = pooled((study) => rowsMeeting(study, soundRows(study), []));
  if (!wanted.size) return "No stored design has one of these motors.";
  const cures = list.flatMap((one, k) => {
    const values = [...state.visible].flatMap((study) => rowsMeeting(study, soundRows(study), list.filter((_, j) => j !== k)).map((row) => columnOf(study, one.name)[row])).filter((value) => !Number.isNaN(value));
    if (!values.length) return [];
    const { scale, label, unit } = quantity[one.name], [low, high] = extent(values);
    const value = enough((one.side ? low : high) * scale, one.side), by = Number(Math.abs(value - one.value * scale).toPrecision(3));
    return [`${label} ${one.side ? "≤" : "≥"} ${value} ${unit} (${by} ${one.side ? "more" : "less"})`.replace(" 1 (", " (")];
  });
  const cure = cures.length ? `It is met with ${cures.join(", or with ")}` : "No single condition is in the way: relax two";
  return `No stored design meets ${list.length > 1 ? "all of this" : "this"}. The nearest is ${measuresInWords(nearestOf(wanted, list))}. ${cure}.`;
}

// What the studies shown answer to the conditions: words, and the design if there is one.
function answer() {
  if (![...state.visible].some((study) => soundRows(study).length)) return { words: "There is no design to choose." };
  const found = chosenDesign();
  if (!found) return { words: nothing() };
  const { design, count, onFront } = found, words = measuresInWords(design);
  const left = page.studies.reduce((sum, s) => sum + s.trials.total - s.trials.trial.length, 0);
  const out = left ? ` ${left} trials are not on this page: pick looks at all of them.` : "";
  return { design, words: `${words[0].toUpperCase()}${words.slice(1)}: ${found.words}${filtered() ? " that these conditions leave" : ""}; ${count} ${count === 1 ? "design meets" : "designs meet"} this, ${onFront} on the front.${out}` };
}

function showAnswer(choose) {
  const out = byId("ask-answer");
  const any = filtered() || state.best !== "";
  const { design, words } = any ? answer() : { words: "" };
  out.classList.toggle("bad", any && !design);
  out.textContent = words;
  if (design && choose) select(...design);
}

// The conditions in words, each with a button that drops it.
function showConditions() {
  const box = byId("conditions");
  const chip = (id, words, drop) => buttonOf(`${words} ×`, () => { drop(); box.querySelector("button")?.focus(); }, { "data-drop": id, "aria-label": `Drop the condition ${words}` });
  const chips = Object.entries(state.ranges).map(([name, range]) => chip(name, conditionText(name, range), () => setRange(name, null)));
  for (const kit of state.withoutMotors) chips.push(chip(`motor-${kit}`, `without ${page.kits[kit].motor}`, () => showMotor(kit, true)));
  if (chips.length > 1) chips.push(chip("all", "all conditions", clearConditions));
  box.replaceChildren(...(chips.length ? ["Conditions: ", ...chips] : []));
  box.hidden = chips.length === 0;
}

// Two fields for the ends of a measure's range; a field has as its end what it stands for.
function rangeFields(name, attributesOf) {
  const fields = ["from", "to"].map((word) => make("input", { type: "number", step: "any", class: "range", placeholder: word, ...attributesOf(word) }));
  fields.forEach((field, side) => {
    field.end = [name, side];
    field.addEventListener("change", () => {
      const typed = fields.map((one) => (Number.isFinite(one.valueAsNumber) ? one.valueAsNumber / quantity[name].scale : null));
      setRange(name, typed.includes(null) || typed[0] <= typed[1] ? typed : typed.reverse());
    });
  });
  return fields;
}

// What fields show follows the conditions, but for the one that is being typed in.
function fillRanges() {
  for (const field of document.querySelectorAll(".range")) {
    const [name, side] = field.end, end = state.ranges[name]?.[side] ?? null;
    if (document.activeElement !== field) field.value = end === null ? "" : Number((end * quantity[name].scale).toPrecision(9));
  }
}

function startAsk() {
  const fields = [...document.querySelectorAll("[data-ask]")];
  for (const field of fields) {
    const name = field.dataset.ask, end = askedEnd(name);
    field.classList.add("range");
    field.end = [name, end];
    field.addEventListener("input", () => {
      const range = [...(state.ranges[name] ?? [null, null])];
      range[end] = Number.isFinite(field.valueAsNumber) ? field.valueAsNumber / quantity[name].scale : null;
      // A new end beyond the other one drops that: the question asks for the new one.
      if (range[0] !== null && range[1] !== null && range[0] > range[1]) range[1 - end] = null;
      setRange(name, range);
      showAnswer(true);
    });
  }
  const ways = byId("best");
  ways.append(
    make("optgroup", { label: "on the front" }, ...[["", "best that is left"], ["knee", "knee"], ["compromise", "compromise"]].map(([value, words]) => make("option", { value }, words))),
    ...["least", "most"].map((word) => make("optgroup", { label: `${word} of any` }, ...axisNames().map((name) => make("option", { value: `${word} ${name}` }, `${word} ${quantity[name].label}`)))),
  );
  ways.addEventListener("change", () => { setBest(ways.value); showAnswer(true); });
  byId("ask").addEventListener("submit", (event) => { event.preventDefault(); showAnswer(true); });
  const follow = ({ final }) => {
    fillRanges();
    ways.value = state.best;
    showConditions();
    if (final) showAnswer(false);
  };
  on("conditions", follow);
  follow({ final: true });
  const rows = current().front;
  const [low, high] = extent(rows.map((row) => current().trials.columns[FIRST][row]));
  if (rows.length) fields[0].placeholder = round((low + 0.4 * (high - low)) * quantity[FIRST].scale, 2);
}
