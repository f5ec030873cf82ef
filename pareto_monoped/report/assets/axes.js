// What the front chart shows, by choice: axes, colour, size, layers, studies and motors.

// One of six colours and marks for a kit of motors, by its number.
function motorTint(kit) { return MOTORS.indexOf(kit) % MARKS.length; }

function optionsOf(names) {
  const first = new Set([...page.goals, ...page.leading]);
  const groupOf = (name) => (first.has(name) ? "objectives and energies" : quantity[name].group);
  return ["objectives and energies", "under uncertainty", "variables", "other measures"].flatMap((label) => {
    const own = names.filter((name) => groupOf(name) === label);
    return own.length ? [make("optgroup", { label }, ...own.map((name) => make("option", { value: name }, titled(name))))] : [];
  });
}

// Whether the designs of the front ask for a logarithmic axis.
function asksForLog(name) { return kindFor(page.studies.flatMap((study, i) => shownColumn(i, name, study.front))) === "log"; }

const PHONE_PX = 700; // as in the style sheet

function startAxes() {
  const sides = [...document.querySelectorAll("[data-side]")], turn = byId("turn");
  const group = KITS.length ? "motor" : page.studies.length > 1 ? "study" : "none";
  const ways = page.objectives.length > 2 ? [["auto", "third objective"], ["", group]] : [["auto", group]];
  byId("colour").append(...ways.map(([value, words]) => make("option", { value }, words)));
  for (const field of sides) {
    const key = field.dataset.side, asked = { x: "logX", y: "logY" }[key];
    if (field.type === "checkbox") follows(field, "axes", () => state.axes[key], (shown) => setAxes({ [key]: shown }));
    else {
      field.append(...optionsOf(axisNames()));
      field.addEventListener("change", () => setAxes({ [key]: field.value, ...(asked ? { [asked]: asksForLog(field.value) } : {}) }));
    }
  }
  turn.addEventListener("input", () => front.turnTo(Number(turn.value)));
  const follow = () => {
    for (const field of sides) if (field.type !== "checkbox") field.value = state.axes[field.dataset.side];
    turn.parentElement.hidden = !state.axes.space;
  };
  on("axes", follow);
  follow();
}

// The colours' numbers and the sizes' range under the chart.
function showRamp() {
  const box = byId("ramp");
  const tint = tinted(), { size } = state.axes;
  box.replaceChildren();
  box.hidden = !tint && !size;
  if (tint) {
    const [low, high] = rangeOver(tint), { decimals } = quantity[tint];
    const bar = make("i", { "aria-hidden": "true" });
    bar.style.background = `linear-gradient(90deg, ${RAMP.map((rgb) => `rgb(${rgb.join(" ")})`).join(", ")})`;
    box.append(make("span", {}, `Colour: ${titled(tint)}`), make("span", {}, low.toFixed(decimals)), bar, make("span", {}, high.toFixed(decimals)));
  }
  if (size) {
    const [low, high] = rangeOver(size), { decimals } = quantity[size];
    box.append(make("span", {}, `Size: ${titled(size)}, ${low.toFixed(decimals)} to ${high.toFixed(decimals)}`));
  }
}

// A switch for each kit of motors that designs choose from: without it, its designs are out of range everywhere.
function startMotorSwitches() {
  const box = byId("motors");
  box.hidden = MOTORS.length === 0;
  for (const kit of MOTORS) {
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true" }, markOf(MARKS[motorTint(kit)], 7, 7, `var(--c${motorTint(kit)})`));
    box.append(switchOf({ "data-motor": kit }, symbol, page.kits[kit].motor, "conditions", () => !state.withoutMotors.has(kit), (shown) => showMotor(kit, shown)));
  }
}

// A box to tick that follows the state.
function follows(input, event, isOn, turn) {
  input.checked = isOn();
  input.addEventListener("change", () => turn(input.checked));
  on(event, () => { input.checked = isOn(); });
}

function switchOf(attributes, symbol, words, event, isOn, turn) {
  const input = make("input", { type: "checkbox", ...attributes });
  follows(input, event, isOn, turn);
  return make("label", {}, input, symbol, words);
}

function startSwitches() {
  const box = byId("switches"), there = { best: hasBest(), spread: hasRobust(), robust: hasRobust() };
  for (const input of box.querySelectorAll("[data-show]")) {
    const key = input.dataset.show;
    if (there[key] ?? true) follows(input, "layers", () => state.layers[key], (shown) => showLayer(key, shown));
    else input.closest("label").remove();
  }
  box.hidden = byId("axes").hidden = false;
  if (page.studies.length < 2) return;
  page.studies.forEach((study, i) => {
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true" }, markOf(MARKS[i % 6], 7, 7, `var(--c${i % 6})`));
    box.append(switchOf({ "data-study": i }, symbol, study.label, "conditions", () => state.visible.has(i), (shown) => showStudy(i, shown)));
  });
}
