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

// The designs on the fronts shown, as [study, row].
function shownDesigns() { return [...state.visible].sort((a, b) => a - b).flatMap((study) => page.studies[study].front.map((row) => [study, row])); }

function bestOf(designs, name, other) {
  const value = (key, [study, row]) => page.studies[study].trials.columns[key][row] * better(key);
  return designs.reduce((best, next) => {
    const gain = value(name, next) - value(name, best) || value(other, next) - value(other, best);
    return gain > 0 ? next : best;
  });
}

function measuresInWords([study, row]) {
  const { trials, label } = page.studies[study];
  const asked = Object.keys(state.ranges).filter((name) => !page.objectives.includes(name) && !page.variables.some((v) => v.name === name));
  const rest = asked.map((name) => `, ${quantity[name].label} ${shown(name, valueAt(study, name, row))}`).join("");
  return `trial ${trials.trial[row]}${page.studies.length > 1 ? ` of ${label}` : ""}, ${told(page.objectives, (key) => trials.columns[key][row])}${rest}`;
}

// By how much a design misses the conditions: the sum of what is missing, each as a share of its measure's extent.
function missing([study, row], spans) {
  let sum = 0;
  for (const [name, [least, most]] of Object.entries(state.ranges)) {
    const value = valueAt(study, name, row);
    if (value === null) return Infinity;
    sum += Math.max((least ?? value) - value, value - (most ?? value), 0) / spans[name];
  }
  return sum;
}

function nothing(designs) {
  const names = Object.keys(state.ranges);
  const alone = names.length === 1 && state.withoutMotors.size === 0;
  if (alone && page.objectives.includes(names[0])) {
    const [name] = names, [low, high] = extent(designs.map(([study, row]) => valueAt(study, name, row)));
    const [least, most] = state.ranges[name];
    if (least !== null && least > high) return `The front ends at ${shown(name, high)}: ask for less, or run the study longer.`;
    if (most !== null && most < low) return `The front begins at ${shown(name, low)}: allow more, or run the study longer.`;
  }
  const spans = Object.fromEntries(names.map((name) => {
    const [low, high] = extent(designs.map(([study, row]) => valueAt(study, name, row)));
    return [name, high - low || Math.abs(high) || 1];
  }));
  const wanted = designs.filter(([study, row]) => !page.studies[study].trials.columns.motor || !state.withoutMotors.has(kitOf(page.studies[study], row)));
  if (!wanted.length) return "No design of the front has one of these motors.";
  const nearest = wanted.reduce((best, next) => (missing(next, spans) < missing(best, spans) ? next : best));
  return `No design of the front meets all of this. The nearest is ${measuresInWords(nearest)}.`;
}

// What the front answers to the conditions: words, and the design if there is one.
function answer() {
  const designs = shownDesigns();
  if (!designs.length) return { words: "There is no front to search." };
  const able = designs.filter(([study, row]) => inRanges(study, row));
  if (!able.length) return { words: nothing(designs) };
  // A wanted first objective is had for the least of the second; else all else buys the best first.
  const wanted = (state.ranges[FIRST]?.[askedEnd(FIRST)] ?? null) !== null;
  const [name, other] = wanted ? [SECOND, FIRST] : [FIRST, SECOND];
  const design = bestOf(able, name, other);
  const count = `${able.length} ${able.length === 1 ? "design" : "designs"} of the front ${able.length === 1 ? "meets" : "meet"} this`;
  const words = measuresInWords(design);
  return { design, words: `${words[0].toUpperCase()}${words.slice(1)}: ${superlative(name)} that these conditions leave; ${count}.` };
}

function showAnswer(choose) {
  const out = byId("ask-answer");
  const any = filtered();
  const { design, words } = any ? answer() : { words: "" };
  out.classList.toggle("bad", any && !design);
  out.textContent = words;
  if (design && choose) select(...design);
}

// The conditions in words, each with a button that drops it.
function showConditions() {
  const box = byId("conditions");
  const chip = (id, words, drop) => {
    const button = make("button", { type: "button", "data-drop": id, "aria-label": `Drop the condition ${words}` }, `${words} ×`);
    button.addEventListener("click", () => { drop(); box.querySelector("button")?.focus(); });
    return button;
  };
  const chips = Object.entries(state.ranges).map(([name, range]) => chip(name, conditionText(name, range), () => setRange(name, null)));
  for (const kit of state.withoutMotors) chips.push(chip(`motor-${kit}`, `without ${page.kits[kit].motor}`, () => showMotor(kit, true)));
  if (chips.length > 1) chips.push(chip("all", "all conditions", clearConditions));
  box.replaceChildren(...(chips.length ? ["Conditions: ", ...chips] : []));
  box.hidden = chips.length === 0;
}

function startAsk() {
  const fields = [...document.querySelectorAll("[data-ask]")];
  for (const field of fields) {
    const name = field.dataset.ask, end = askedEnd(name);
    field.addEventListener("input", () => {
      const range = [...(state.ranges[name] ?? [null, null])];
      range[end] = Number.isFinite(field.valueAsNumber) ? field.valueAsNumber / quantity[name].scale : null;
      // A new end beyond the other one drops that: the question asks for the new one.
      if (range[0] !== null && range[1] !== null && range[0] > range[1]) range[1 - end] = null;
      setRange(name, range);
      showAnswer(true);
    });
  }
  byId("ask").addEventListener("submit", (event) => { event.preventDefault(); showAnswer(true); });
  const follow = ({ final }) => {
    for (const field of fields) {
      const value = state.ranges[field.dataset.ask]?.[askedEnd(field.dataset.ask)] ?? null;
      if (document.activeElement !== field || !final) field.value = value === null ? "" : Number((value * quantity[field.dataset.ask].scale).toPrecision(6));
    }
    showConditions();
    if (final) showAnswer(false);
  };
  on("conditions", follow);
  follow({ final: true });
  const rows = current().front;
  const [low, high] = extent(rows.map((row) => current().trials.columns[FIRST][row]));
  if (rows.length) fields[0].placeholder = round((low + 0.4 * (high - low)) * quantity[FIRST].scale, 2);
}
