// What all charts share: drawing when they come into view, names, legends, printing.

const DASHES = { solid: [], dash: [7, 4], dot: [1.5, 3.5], dashdot: [7, 3, 1.5, 3], longdash: [12, 4], longdashdot: [12, 3, 1.5, 3] };

// Draws a chart when it comes near the view; later changes wait until it is there again. A change of its width is one.
// Returns what asks for a redraw.
function lazily(id, render) {
  const node = byId(id);
  let near = false, stale = true, width = null;
  const now = () => { stale = false; render(node); };
  const again = () => { stale = true; if (near || paperScale()) now(); };
  charts.push(again);
  new IntersectionObserver((entries) => {
    near = entries.at(-1).isIntersecting;
    if (near) setTimeout(() => { if (stale) now(); }); // each chart in a task of its own
  }, { rootMargin: "300px" }).observe(node);
  new ResizeObserver(() => {
    const before = width;
    width = node.clientWidth;
    if (before !== null && width !== before) again();
  }).observe(node);
  window.addEventListener("beforeprint", () => { if (stale) now(); });
  return again;
}

let printing = false;
for (const event of ["beforeprint", "afterprint"]) window.addEventListener(event, () => { printing = event === "beforeprint"; });

// A page is printed with more dots per inch than a screen has.
function paperScale() { return printing || matchMedia("print").matches ? 3 : null; }

function describe(node, words) {
  node.setAttribute("role", "img");
  node.setAttribute("aria-label", words);
}

// The lines and marks of a chart with their names, as a list under it.
function legend(node, layers) {
  const old = node.nextElementSibling?.classList.contains("legend") ? node.nextElementSibling : null;
  const list = make("ul", { class: "legend" }, ...layers.map((layer) => {
    const tint = layer.line?.color ?? entry(layer.marker.color, 0);
    const symbol = draw("svg", { width: 22, height: 12, "aria-hidden": "true" });
    if (layer.mode.includes("lines")) symbol.append(draw("line", { x1: 0, x2: 22, y1: 6, y2: 6, stroke: tint, "stroke-width": layer.line.width ?? 1.5, "stroke-dasharray": (DASHES[layer.line.dash ?? "solid"]).join(" ") || "none" }));
    else symbol.append(markOf(entry(layer.marker.symbol, 0), 11, 6, tint));
    return make("li", {}, symbol, layer.title ?? layer.name);
  }));
  if (old) old.replaceWith(list);
  else node.after(list);
}

const SPOTS = [[1, 0], [-1, 0], [0, -1], [0, 1], [0.75, -0.75], [-0.75, -0.75], [0.75, 0.75], [-0.75, 0.75]];
const LETTER_PX = 7.2; // of a letter of 12 px

// Where names go: beside their own mark, farther away where others are in the way.
function placedNames(marks, { left, top, width, height }) {
  const taken = marks.map(({ px, py }) => [px - 8, px + 8, py - 8, py + 8]);
  return marks.filter((mark) => mark.text).map((mark) => {
    const half = (LETTER_PX * mark.text.length + 4) / 2;
    const spots = [13, 24, 38, 54].flatMap((away) => SPOTS.map(([dx, dy]) => [mark.px + dx * (away + half - 4), mark.py + dy * (away + 4)]));
    const boxed = ([x, y]) => [x - half, x + half, y - 8, y + 8];
    const others = marks.filter((other) => other !== mark);
    const own = ([x, y]) => others.every((other) => Math.hypot(other.px - x, other.py - y) > Math.hypot(mark.px - x, mark.py - y));
    const free = (spot) => {
      const [a, b, c, d] = boxed(spot);
      return a >= left && b <= left + width && c >= top && d <= top + height && !taken.some(([e, f, g, h]) => a < f && b > e && c < h && d > g);
    };
    const spot = spots.find((one) => free(one) && own(one)) ?? spots.find(free) ?? spots[0];
    const [from, to, ...rest] = boxed(spot), at = spot[1];
    taken.push([from, to, ...rest]);
    const far = Math.hypot(Math.max(from - mark.px, mark.px - to, 0), Math.max(Math.abs(at - mark.py) - 8, 0)) > 14;
    return { ...mark, from, to, at, far };
  });
}

function seriesStyle(i) {
  return { color: studyColour(i), width: 1.8, dash: ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"][i % 6] };
}

function band(x, low, middle, high, tint, name) {
  return [
    { name: `${name}, least to greatest`, mode: "area", x, y: low, y2: high, fill: tint },
    { name, mode: "lines", x, y: middle, line: { color: tint, width: 2.5 }, text: (i) => `${plain(name)}<br>${x[i]} evaluations: ${round(middle[i])}` },
  ];
}

// Draws layers of lines or marks on axes that hold all of them.
function plot(node, layers, x, y, { fromZero = [false, false], names = true } = {}) {
  const span = (key, zero) => {
    const [low, high] = extent(layers.flatMap((layer) => [...layer[key], ...(key === "y" ? layer.y2 ?? [] : [])]));
    const room = 0.05 * (high - low) || 1;
    return zero ? [0, high + room] : [low - room, high + room];
  };
  const chart = node.chart ?? new Chart(node);
  chart.set(layers, { title: x, range: span("x", fromZero[0]) }, { title: y, range: span("y", fromZero[1]) });
  if (names) legend(node, layers.filter((layer) => layer.mode !== "area" && layer.x.length));
}

function inUnit(name, values) { return values.map((value) => (value === null ? null : value * quantity[name].scale)); }

function redrawAll() {
  tints.clear();
  pictures.clear();
  for (const redraw of charts) redraw();
}
