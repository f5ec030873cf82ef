// Ask the front: the cheapest design for a height, or the highest jump on an energy.

function answerHeight(wanted) {
  const { front, trials: { columns, trial } } = current();
  const at = front.findIndex((row) => columns.height_m[row] >= wanted);
  if (at < 0) {
    const highest = front.length ? shown("height_m", columns.height_m[front.at(-1)]) : null;
    return { text: highest ? `The front ends at ${highest}: ask for less, or run the study longer.` : "There is no front to search." };
  }
  const row = front[at];
  return { row, text: `At least ${wanted} m: trial ${trial[row]}, ${shown("height_m", columns.height_m[row])} on ${shown("energy_j", columns.energy_j[row])}, the least energy among the ${front.length - at} designs that jump this high.` };
}

function answerEnergy(allowed) {
  const { front, trials: { columns, trial } } = current();
  const able = front.filter((row) => columns.energy_j[row] <= allowed);
  if (!able.length) {
    const least = front.length ? shown("energy_j", columns.energy_j[front[0]]) : null;
    return { text: least ? `The front begins at ${least}: allow more, or run the study longer.` : "There is no front to search." };
  }
  const row = able.at(-1);
  return { row, text: `On at most ${allowed} J: trial ${trial[row]}, ${shown("height_m", columns.height_m[row])} on ${shown("energy_j", columns.energy_j[row])}, the highest jump among the ${able.length} designs that need no more.` };
}

function startAsk() {
  const height = byId("ask-height"), energy = byId("ask-energy"), out = byId("ask-answer");
  let last = height;
  const ask = (field, answer) => {
    const value = field.valueAsNumber;
    if (!Number.isFinite(value)) { out.textContent = ""; return; }
    const { row, text: words } = answer(value);
    out.classList.toggle("bad", row === undefined);
    out.textContent = words;
    if (row !== undefined) select(state.study, row);
  };
  const run = () => ask(last, last === height ? answerHeight : answerEnergy);
  height.addEventListener("input", () => { last = height; energy.value = ""; run(); });
  energy.addEventListener("input", () => { last = energy; height.value = ""; run(); });
  byId("ask").addEventListener("submit", (event) => { event.preventDefault(); run(); });
  const heights = extent(current().front.map((row) => current().trials.columns.height_m[row]));
  if (current().front.length) height.placeholder = round(heights[0] + 0.4 * (heights[1] - heights[0]), 2);
}
