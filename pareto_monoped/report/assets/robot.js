// The robot to scale in the plane of its leg; it moves as simulated.

const stage = byId("stage");
const player = { frame: 0, time: 0, playing: false, last: 0, jump: null, request: 0 };
const PIN_RADIUS_M = 0.012; // of the dot that marks the knee axis
let parts = null;

// A jump's columns in SI units.
function decoded(jump) {
  const result = {};
  for (const [name, values] of Object.entries(jump.columns)) result[name] = values.map((v) => v * jump.scale[name]);
  return result;
}

// The outline of a link that hangs down from the origin: two discs and the bar between them.
function linkPath(top, bottom, half, length) {
  const a = Math.sqrt(Math.max(top * top - half * half, 0)), b = Math.sqrt(Math.max(bottom * bottom - half * half, 0));
  return `M${-half} ${a} A${top} ${top} 0 1 1 ${half} ${a} L${half} ${length - b} A${bottom} ${bottom} 0 1 1 ${-half} ${length - b} Z`;
}

function buildStage(chosen) {
  stage.replaceChildren();
  parts = null;
  const { values } = chosen;
  const d = legOf(chosen.kit);
  const l1 = values.thigh_length_m, l2 = values.shank_length_m;
  const flight = player.jump;
  const foot = chosen.study.foot_radius_m;
  const highest = flight ? Math.max(...flight.base_z_m) : START_HEIGHT;
  const top = Math.max(highest + 0.14, 0.95);
  const wide = 1.05 * top;
  const svg = draw("svg", { viewBox: `${-wide / 2} ${-top} ${wide} ${top + 0.06}`, role: "img", preserveAspectRatio: "xMidYMax meet" });
  svg.setAttribute("aria-label", `The robot to scale: thigh ${shown("thigh_length_m", l1)}, shank ${shown("shank_length_m", l2)}, jumping from ${START_HEIGHT} m to ${round(highest, 2)} m`);
  const font = `font-size: ${0.03 * top}px`;
  for (const h of ticks(0, top - 0.02, 5)) {
    svg.append(draw("line", { x1: -wide / 2, x2: wide / 2, y1: -h, y2: -h, class: "gridline", "stroke-width": h ? 0.003 : 0.008, ...(h ? {} : { style: "stroke: var(--soft)" }) }));
    if (h) {
      const label = draw("text", { x: -wide / 2 + 0.01, y: -h - 0.008, style: font });
      label.textContent = `${tickText(h)} m`;
      svg.append(label);
    }
  }
  const path = draw("path", { fill: "none", stroke: "var(--c4)", "stroke-width": 0.004, "stroke-dasharray": "0.012 0.01" });
  if (flight) path.setAttribute("d", `M${flight.base_z_m.map((z, i) => `${flight.base_x_m[i].toFixed(4)} ${(-z).toFixed(4)}`).join("L")}`);
  const stroke = { "stroke-width": 0.004, stroke: "var(--card)" };
  const base = draw("g", {},
    draw("path", { d: `M${-d.base_top_radius_m} ${-d.base_top_m} A${d.base_top_radius_m} ${d.base_top_radius_m} 0 0 1 ${d.base_top_radius_m} ${-d.base_top_m} L${d.housing_radius_m} 0 L${-d.housing_radius_m} 0 Z`, fill: "var(--metal)", ...stroke }));
  const thigh = draw("path", { d: linkPath(d.thigh_hip_radius_m, d.thigh_knee_radius_m, d.thigh_half_width_m, l1), fill: "var(--hip)", "fill-opacity": 0.85, ...stroke });
  const shank = draw("g", {},
    draw("path", { d: linkPath(d.shank_knee_radius_m, d.shank_foot_radius_m, d.shank_foot_radius_m * 0.98, l2), fill: "var(--knee)", "fill-opacity": 0.85, ...stroke }),
    draw("circle", { cx: 0, cy: l2, r: foot, fill: "var(--dark)" }));
  const housing = draw("g", {},
    draw("circle", { r: d.housing_radius_m, fill: "var(--metal)", ...stroke }), draw("circle", { r: d.output_radius_m, fill: "var(--dark)" }));
  const pin = draw("circle", { r: PIN_RADIUS_M, fill: "var(--card)" });
  svg.append(path, base, shank, thigh, housing, pin);
  stage.append(svg);
  parts = { base, thigh, shank, housing, pin, l1, l2 };
  setPose();
}

// Joint angles about the lateral axis: at zero both links hang straight down, positive turns the foot backward.
function setPose() {
  if (!parts) return;
  const { l1, l2 } = parts;
  let x = 0, z = START_HEIGHT, hip, knee;
  if (player.jump) {
    const j = player.jump, k = frameAt(player.time);
    const mix = (name) => j[name][k.i] + (j[name][k.i + 1] - j[name][k.i]) * k.f;
    x = mix("base_x_m"); z = mix("base_z_m"); hip = mix("hip_rad"); knee = mix("knee_rad");
  } else {
    const span = START_HEIGHT - current().foot_radius_m;
    const cosine = Math.min(Math.max((span * span - l1 * l1 - l2 * l2) / (2 * l1 * l2), -1), 1);
    knee = Math.acos(cosine);
    hip = -Math.atan2(l2 * Math.sin(knee), l1 + l2 * Math.cos(knee));
  }
  const degrees = 180 / Math.PI;
  const kneeX = x - l1 * Math.sin(hip), kneeZ = z - l1 * Math.cos(hip);
  parts.base.setAttribute("transform", `translate(${x} ${-z})`);
  parts.housing.setAttribute("transform", `translate(${x} ${-z})`);
  parts.thigh.setAttribute("transform", `translate(${x} ${-z}) rotate(${hip * degrees})`);
  parts.shank.setAttribute("transform", `translate(${kneeX} ${-kneeZ}) rotate(${(hip + knee) * degrees})`);
  parts.pin.setAttribute("transform", `translate(${kneeX} ${-kneeZ})`);
}

function frameAt(time) {
  const t = player.jump.time_s;
  let i = 0;
  while (i < t.length - 2 && t[i + 1] <= time) i += 1;
  return { i, f: t.length > 1 ? Math.min(Math.max((time - t[i]) / (t[i + 1] - t[i]), 0), 1) : 0 };
}

function endTime() { return player.jump ? player.jump.time_s.at(-1) : 0; }

function setTime(time) {
  player.time = Math.min(Math.max(time, 0), endTime());
  byId("scrub").value = endTime() ? Math.round(1000 * player.time / endTime()) : 0;
  byId("scrub").setAttribute("aria-valuetext", `${round(player.time)} s of ${round(endTime())} s`);
  setPose();
  tell("time");
}

function setPlaying(playing) {
  player.playing = playing && player.jump !== null;
  byId("play").textContent = player.playing ? "Pause" : "Play";
  byId("play").setAttribute("aria-label", player.playing ? "Pause the jump" : "Play the jump");
  cancelAnimationFrame(player.request);
  if (!player.playing) return;
  if (player.time >= endTime()) player.time = 0;
  player.last = performance.now();
  const step = (now) => {
    if (!player.playing) return;
    setTime(player.time + (now - player.last) / 1000 * Number(byId("speed").value));
    player.last = now;
    if (player.time >= endTime()) setPlaying(false);
    else player.request = requestAnimationFrame(step);
  };
  player.request = requestAnimationFrame(step);
}

function startRobot() {
  byId("play").addEventListener("click", () => setPlaying(!player.playing));
  byId("scrub").addEventListener("input", () => { setPlaying(false); setTime(byId("scrub").value / 1000 * endTime()); });
  on("selection", (how) => {
    setPlaying(false);
    const chosen = subject();
    player.jump = chosen && chosen.jump ? decoded(chosen.jump) : null;
    player.time = 0;
    for (const id of ["play", "scrub", "speed"]) byId(id).disabled = !player.jump;
    if (chosen) buildStage(chosen);
    else stage.replaceChildren();
    if (player.jump) {
      // At rest the picture shows the lift-off; a click plays the jump from its start.
      const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
      if (how.byUser && !still) setPlaying(true);
      else setTime(chosen.jump.lift_off_s ?? 0);
    }
  });
}
