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
  const box = byId("axes");
  const pick = (id, label, key, extra = []) => {
    const choice = make("select", { id }, ...extra.map(([value, words]) => make("option", { value }, words)), ...optionsOf(axisNames()));
    const logOf = { x: (name) => ({ logX: asksForLog(name) }), y: (name) => ({ logY: asksForLog(name) }) }[key] ?? (() => ({}));
    choice.addEventListener("change", () => setAxes({ [key]: choice.value, ...logOf(choice.value) }));
    const follow = () => { choice.value = state.axes[key]; };
    follow();
    on("axes", follow);
    return make("label", {}, `${label} `, choice);
  };
  const check = (id, label, key) => switchOf({ id }, "", label, "axes", () => state.axes[key], (shown) => setAxes({ [key]: shown }));
  const third = page.objectives.length > 2;
  const group = KITS.length ? "motor" : page.studies.length > 1 ? "study" : "none";
  const turn = make("input", { type: "range", id: "turn", min: -90, max: 90, value: -35, "aria-label": "Turn the 3D view" });
  turn.addEventListener("input", () => front.turnTo(Number(turn.value)));
  const turnLabel = make("label", {}, "turn", turn);
  const follow = () => { turnLabel.hidden = !state.axes.space; };
  on("axes", follow);
  follow();
  box.append(
    pick("across", "Right", "x"), check("log-x", "log", "logX"), pick("upward", "Up", "y"), check("log-y", "log", "logY"),
    pick("colour", "Colour", "colour", third ? [["auto", "third objective"], ["", group]] : [["auto", group]]), pick("size", "Size", "size", [["", "all alike"]]),
    check("space", "3D", "space"), turnLabel,
  );
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
function switchOf(attributes, symbol, words, event, isOn, turn) {
  const input = make("input", { type: "checkbox", ...attributes });
  input.checked = isOn();
  input.addEventListener("change", () => turn(input.checked));
  on(event, () => { input.checked = isOn(); });
  return make("label", {}, input, symbol, words);
}

const SYMBOLS = {
  cloud: '<circle cx="7" cy="7" r="2.5" fill="var(--cloud)"/>',
  infeasible: '<path d="M4 4L10 10M10 4L4 10" stroke="var(--bad)" stroke-width="1.5"/>',
  front: '<path d="M0 7H14" stroke="var(--c0)"/><circle cx="7" cy="7" r="3.8" fill="var(--c0)"/>',
  published: '<path d="M7 2L12 7L7 12L2 7Z" fill="none" stroke="var(--paper)" stroke-width="1.6"/>',
  simulated: '<path d="M7 2L12 7L7 12L2 7Z" fill="var(--paper)"/>',
  floor: '<path d="M0 11L14 3" stroke="var(--faint)" stroke-width="1.6" stroke-dasharray="2 2.5"/>',
  picks: '<path d="M7 1L8.8 5.2L13.3 5.5L9.8 8.4L11 12.9L7 10.4L3 12.9L4.2 8.4L.7 5.5L5.2 5.2Z" fill="var(--ink)"/>',
  spread: '<path d="M7 1V13M1 7H13" stroke="var(--soft)" stroke-width="1.4"/>',
  robust: '<path d="M0 11L14 4" stroke="var(--ink)" stroke-width="1.6" stroke-dasharray="5 2.5"/>',
  best: '<path d="M0 7H14" stroke="var(--c0)" stroke-dasharray="3 2"/><path d="M3 7L10 3V11Z" fill="none" stroke="var(--c0)" stroke-width="1.5"/>',
};

function startSwitches() {
  const names = {
    front: "front", ...(hasBest() ? { best: "best torque found" } : {}), cloud: "dominated", infeasible: "infeasible", published: "paper, as published",
    simulated: "paper, simulated here", picks: "knee", floor: "floor: least rise of potential energy",
    ...(hasRobust() ? { spread: "spread under uncertainty, 5 to 95 %", robust: "robust front" } : {}),
  };
  const box = byId("switches");
  for (const [key, words] of Object.entries(names)) {
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true" });
    symbol.innerHTML = SYMBOLS[key]; // constant text from above
    const label = switchOf({ "data-show": key }, symbol, words, "layers", () => state.layers[key], (shown) => showLayer(key, shown));
    if (key === "best") label.title = "Each mark is a jump that was found with the hardware of one of the designs and torques free over time (pareto-monoped limit); the line only joins them. Better ones may exist, none beyond the floor.";
    if (key === "floor") label.title = "No design that jumped in these studies can reach a height on less, whatever its controller: the least rise of potential energy from its start to any pose with the base there, with the foot above the ground and the joints between their stops, less what the foot's spring gives back. Losses and all motion at the apex come on top.";
    box.append(label);
  }
  if (page.studies.length < 2) return;
  page.studies.forEach((study, i) => {
    const symbol = draw("svg", { width: 14, height: 14, "aria-hidden": "true" }, markOf(MARKS[i % 6], 7, 7, `var(--c${i % 6})`));
    box.append(switchOf({ "data-study": i }, symbol, study.label, "conditions", () => state.visible.has(i), (shown) => showStudy(i, shown)));
  });
}
