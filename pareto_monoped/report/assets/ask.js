// Ask the front: the best design for a value of the first objective, or of the second.

function better(name) { return page.directions[name] === "maximise" ? 1 : -1; }

// Words for the paper's measures; any other is called by its label.
function superlative(name) {
  if (name === "height_m") return "the highest jump";
  return `the ${better(name) > 0 ? "most" : "least"} ${quantity[name].label}`;
}

function condition(name) {
  if (name === "height_m") return "jump this high";
  if (name === "energy_j") return "need no more";
  return `have no ${better(name) > 0 ? "less" : "more"}`;
}

// The design of the front with the measure at the value (in the unit shown) or better, and best in the other one.
function answer(name, other, typed) {
  const { front, trials: { columns, trial } } = current();
  const q = quantity[name], way = better(name), value = typed / q.scale;
  const able = front.filter((row) => columns[name][row] !== null && way * (columns[name][row] - value) >= 0);
  const words = (row) => told(page.objectives, (key) => columns[key][row]);
  if (!able.length) {
    if (!front.length) return { text: "There is no front to search." };
    const [low, high] = extent(front.map((row) => columns[name][row]));
    return way > 0
      ? { text: `The front ends at ${shown(name, high)}: ask for less, or run the study longer.` }
      : { text: `The front begins at ${shown(name, low)}: allow more, or run the study longer.` };
  }
  const row = able.reduce((best, next) => (better(other) * (columns[other][next] - columns[other][best]) > 0 ? next : best));
  const limit = way > 0 ? "At least" : q.unit === "J" ? "On at most" : "At most";
  return { row, text: `${limit} ${typed} ${q.unit}: trial ${trial[row]}, ${words(row)}, ${superlative(other)} among the ${able.length} designs that ${condition(name)}.` };
}

function startAsk() {
  const first = byId("ask-height"), second = byId("ask-energy"), out = byId("ask-answer");
  let last = first;
  const run = () => {
    const value = last.valueAsNumber;
    if (!Number.isFinite(value)) { out.textContent = ""; return; }
    const { row, text: words } = last === first ? answer(FIRST, SECOND, value) : answer(SECOND, FIRST, value);
    out.classList.toggle("bad", row === undefined);
    out.textContent = words;
    if (row !== undefined) select(state.study, row);
  };
  first.addEventListener("input", () => { last = first; second.value = ""; run(); });
  second.addEventListener("input", () => { last = second; first.value = ""; run(); });
  byId("ask").addEventListener("submit", (event) => { event.preventDefault(); run(); });
  const range = extent(current().front.map((row) => current().trials.columns[FIRST][row]));
  if (current().front.length) first.placeholder = round((range[0] + 0.4 * (range[1] - range[0])) * quantity[FIRST].scale, 2);
}
