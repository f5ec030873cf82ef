// Robots to scale in the plane of their leg, and players of their jumps.

const stage = byId("stage");
const PIN_RADIUS_M = 0.012; // of the dot that marks the knee axis
const STOP_RADIUS_M = 0.085, BUMPER_RADIUS_M = 0.011; // of the arcs that mark the joints' ranges, and of their ends
const FORCE_M_PER_N = 1 / 800; // length of the arrow of the floor's force
const DEGREES = 180 / Math.PI;
let robot = null;

// Plays time by a button, a slider and a choice of speeds with these ids; end() is its end, moved() shows a moment.
class Player {
  constructor([play, scrub, speed], words, end, moved) {
    Object.assign(this, { play: byId(play), scrub: byId(scrub), speed: byId(speed), words, end, moved, time: 0, playing: false });
    this.play.addEventListener("click", () => this.run(!this.playing));
    this.scrub.addEventListener("input", () => { this.run(false); this.set(this.scrub.value / 1000 * end()); });
  }

  // To the start, at rest; without a jump nothing can be played.
  reset(able) {
    this.run(false);
    this.time = 0;
    for (const control of [this.play, this.scrub, this.speed]) control.disabled = !able;
  }

  set(time) {
    const end = this.end();
    this.time = Math.min(Math.max(time, 0), end);
    this.scrub.value = end ? Math.round(1000 * this.time / end) : 0;
    this.scrub.setAttribute("aria-valuetext", `${round(this.time)} s of ${round(end)} s`);
    this.moved();
  }

  run(playing) {
    this.playing = playing && this.end() > 0;
    this.play.textContent = this.playing ? "Pause" : this.words;
    cancelAnimationFrame(this.request);
    if (!this.playing) return;
    if (this.time >= this.end()) this.time = 0;
    let last = performance.now();
    const step = (now) => {
      this.set(this.time + (now - last) / 1000 * Number(this.speed.value));
      last = now;
      if (this.time >= this.end()) this.run(false);
      else this.request = requestAnimationFrame(step);
    };
    this.request = requestAnimationFrame(step);
  }
}

// The player of the selected design's jump.
const player = new Player(["play", "scrub", "speed"], "Play", () => player.jump?.time_s.at(-1) ?? 0, () => {
  if (robot) robot.pose(player.jump, player.time);
  showLoads();
  tell("time");
});

// One scale for all designs: the highest jump of all fronts and cases fits.
const STAGE_TOP = (() => {
  const heights = page.studies.flatMap((study) => [...study.front.map((row) => study.trials.columns.height_m[row]), ...study.cases.map((made) => made.height_m ?? 0)]);
  return Math.max(heights.reduce((most, height) => Math.max(most, height), START_HEIGHT) + 0.14, 0.95);
})();

// The outline of a link that hangs down from the origin: two discs and the bar between them.
function linkPath(top, bottom, half, length) {
  const a = Math.sqrt(Math.max(top * top - half * half, 0)), b = Math.sqrt(Math.max(bottom * bottom - half * half, 0));
  return `M${-half} ${a} A${top} ${top} 0 1 1 ${half} ${a} L${half} ${length - b} A${bottom} ${bottom} 0 1 1 ${-half} ${length - b} Z`;
}

// The point at an angle of a link that hangs down at zero; positive turns its lower end backward.
function hanging(angle, length) { return [-length * Math.sin(angle), length * Math.cos(angle)]; }

// The range of a joint between its stops, and a dot for the bumper at each end.
function stopMarks([least, most]) {
  const group = draw("g", { class: "stops" });
  if (least === null || most === null) return { group, bumpers: [] };
  const [x1, y1] = hanging(least, STOP_RADIUS_M), [x2, y2] = hanging(most, STOP_RADIUS_M);
  group.append(draw("path", { d: `M${x1} ${y1} A${STOP_RADIUS_M} ${STOP_RADIUS_M} 0 ${most - least > Math.PI ? 1 : 0} 1 ${x2} ${y2}` }));
  const bumpers = [[x1, y1, least, -1], [x2, y2, most, 1]].map(([cx, cy, end, side]) => ({ dot: draw("circle", { cx, cy, r: BUMPER_RADIUS_M }), end, side }));
  group.append(...bumpers.map((bumper) => bumper.dot));
  return { group, bumpers };
}

// A robot as a node, with pose(jump, time) that moves it; without a jump it stands at its start.
function drawRobot(chosen, { marks = true } = {}) {
  const { values, study } = chosen;
  const d = legOf(chosen.kit);
  const l1 = values.thigh_length_m, l2 = values.shank_length_m, start = values.start_height_m ?? START_HEIGHT;
  const stroke = { "stroke-width": 0.004, stroke: "var(--card)" };
  const base = draw("path", { d: `M${-d.base_top_radius_m} ${-d.base_top_m} A${d.base_top_radius_m} ${d.base_top_radius_m} 0 0 1 ${d.base_top_radius_m} ${-d.base_top_m} L${d.housing_radius_m} 0 L${-d.housing_radius_m} 0 Z`, fill: "var(--metal)", ...stroke });
  const thigh = draw("path", { d: linkPath(d.thigh_hip_radius_m, d.thigh_knee_radius_m, d.thigh_half_width_m, l1), fill: "var(--hip)", "fill-opacity": 0.85, ...stroke });
  const shank = draw("g", {},
    draw("path", { d: linkPath(d.shank_knee_radius_m, d.shank_foot_radius_m, d.shank_foot_radius_m * 0.98, l2), fill: "var(--knee)", "fill-opacity": 0.85, ...stroke }),
    draw("circle", { cx: 0, cy: l2, r: study.foot_radius_m, fill: "var(--dark)" }));
  const housing = draw("g", {}, draw("circle", { r: d.housing_radius_m, fill: "var(--metal)", ...stroke }), draw("circle", { r: d.output_radius_m, fill: "var(--dark)" }));
  const pin = draw("circle", { r: PIN_RADIUS_M, fill: "var(--card)" });
  const [hipRange, kneeRange] = study.stops_rad[chosen.kit] ?? [[null, null], [null, null]];
  const hipStops = stopMarks(hipRange), kneeStops = stopMarks(kneeRange);
  const force = draw("path", { class: "force" });
  const node = draw("g", {}, base, shank, thigh, housing, pin);
  if (marks) node.append(hipStops.group, kneeStops.group, force);
  const place = (part, x, y, angle = 0) => part.setAttribute("transform", `translate(${x} ${y})${angle ? ` rotate(${angle * DEGREES})` : ""}`);
  const pose = (jump, time) => {
    let x = 0, z = start, hip, knee, push = 0;
    if (jump) {
      const at = frameAt(jump, time);
      [x, z, hip, knee, push] = ["base_x_m", "base_z_m", "hip_rad", "knee_rad", "contact_z_n"].map((name) => mixed(jump, name, at));
    } else {
      const span = start - study.foot_radius_m;
      knee = Math.acos(Math.min(Math.max((span * span - l1 * l1 - l2 * l2) / (2 * l1 * l2), -1), 1));
      hip = -Math.atan2(l2 * Math.sin(knee), l1 + l2 * Math.cos(knee));
    }
    const [dx, dy] = hanging(hip, l1);
    const [fx, fy] = hanging(hip + knee, l2);
    place(base, x, -z);
    place(housing, x, -z);
    place(thigh, x, -z, hip);
    place(shank, x + dx, -z + dy, hip + knee);
    place(pin, x + dx, -z + dy);
    if (!marks) return;
    place(hipStops.group, x, -z);
    place(kneeStops.group, x + dx, -z + dy, hip);
    for (const [{ bumpers }, angle] of [[hipStops, hip], [kneeStops, knee]]) {
      for (const { dot, end, side } of bumpers) dot.classList.toggle("pressed", side * (angle - end) >= 0);
    }
    const long = push * FORCE_M_PER_N, foot = [x + dx + fx, -z + dy + fy];
    force.setAttribute("d", long > 0.03 ? `M${foot[0]} ${foot[1]}v${-long}m-0.018 0.03l0.018 -0.03l0.018 0.03` : "");
  };
  return { node, pose };
}

// The ground, lines of height and their labels, in a picture that shows up to STAGE_TOP.
function drawStage(label, wide = 1.05 * STAGE_TOP) {
  const svg = draw("svg", { viewBox: `${-wide / 2} ${-STAGE_TOP} ${wide} ${STAGE_TOP + 0.06}`, role: "img", preserveAspectRatio: "xMidYMax meet", "aria-label": label });
  const font = `font-size: ${0.03 * STAGE_TOP}px`;
  for (const h of ticks(0, STAGE_TOP - 0.02, 5)) {
    svg.append(draw("line", { x1: -wide / 2, x2: wide / 2, y1: -h, y2: -h, class: "gridline", "stroke-width": h ? 0.003 : 0.008, ...(h ? {} : { style: "stroke: var(--soft)" }) }));
    if (!h) continue;
    const words = draw("text", { x: -wide / 2 + 0.01, y: -h - 0.008, style: font });
    words.textContent = `${tickText(h)} m`;
    svg.append(words);
  }
  return svg;
}

// The path of the base.
function coursePath(jump, more = {}) {
  const d = jump.base_z_m.map((z, i) => `${jump.base_x_m[i].toFixed(4)} ${(-z).toFixed(4)}`).join("L");
  return draw("path", { d: `M${d}`, fill: "none", stroke: "var(--faint)", "stroke-width": 0.005, "stroke-dasharray": "0.012 0.01", ...more });
}

function buildStage(chosen) {
  const { thigh_length_m: l1, shank_length_m: l2 } = chosen.values;
  const highest = player.jump ? Math.max(...player.jump.base_z_m) : null;
  const jumping = highest === null ? "standing" : `jumping to ${round(highest, 2)} m`;
  const svg = drawStage(`The robot to scale, ${jumping}: thigh ${shown("thigh_length_m", l1)}, shank ${shown("shank_length_m", l2)}; arcs mark the joints' ranges between their stops`);
  if (player.jump) svg.append(coursePath(player.jump));
  robot = drawRobot(chosen);
  svg.append(robot.node);
  stage.replaceChildren(svg);
  robot.pose(player.jump, player.time);
}

// The frame before a time, and how far it is on to the next.
function frameAt(jump, time) {
  const t = jump.time_s;
  let i = 0;
  while (i < t.length - 2 && t[i + 1] <= time) i += 1;
  return { i, f: t.length > 1 ? Math.min(Math.max((time - t[i]) / (t[i + 1] - t[i]), 0), 1) : 0 };
}

function mixed(jump, name, { i, f }) {
  const values = jump[name];
  return values.length > 1 ? values[i] + (values[i + 1] - values[i]) * f : values[0];
}

// What acts at the moment that the picture shows.
function showLoads() {
  const box = byId("loads"), { jump } = player;
  if (!jump) { box.textContent = ""; return; }
  const chosen = subject();
  const at = frameAt(jump, player.time);
  const words = [`${round(player.time)} s`, `floor ${round(mixed(jump, "contact_z_n", at), 0)} N`];
  const ranges = chosen.study.stops_rad[chosen.kit] ?? [];
  ["hip", "knee"].forEach((side, k) => {
    const limit = chosen[side] ? ` of ${round(chosen[side].peak_torque_n_m, 0)}` : "";
    const angle = mixed(jump, `${side}_rad`, at), [least, most] = ranges[k] ?? [null, null];
    const stop = least !== null && (angle <= least || angle >= most) ? ", in its stop" : "";
    words.push(`${side} ${round(mixed(jump, `${side}_motor_torque_n_m`, at), 1)}${limit} N m${stop}`);
  });
  box.textContent = words.join("; ");
}

function startRobot() {
  on("selection", (how) => {
    const chosen = subject();
    player.jump = jumpOf(chosen);
    player.reset(player.jump !== null);
    if (chosen) buildStage(chosen);
    else stage.replaceChildren();
    showLoads();
    if (!player.jump) return;
    // At rest the picture shows the lift-off; a click plays the jump from its start.
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (how.byUser && !still) player.run(true);
    else player.set(player.jump.lift_off_s);
  });
}
