// A chart by plotly: axes, lines, few marks, zoom, pan, selections and pictures. Crowds of marks are painted on canvases
// under and over plotly's lines, so that thousands of them take no elements; hovering and choosing look them up here.
//
// A layer has name, x and y (values as shown), and by its mode
//   "markers"  marker { size, symbol, color, opacity, ramp }, each one value or one per point; cloud: many small dots
//   "lines"    line { color, width, dash, shape }
//   "area"     y2 and fill
//   "bars"     ends [[x low, x high, y low, y high], ...] and line
// and may have stands (what a point stands for, given to the listener of a click) and text(i) (shown over point i).

await nextTask();
const Plotly = makePlotly();
await nextTask();

const charts = [];
const NEAR_PX = 14; // a click this near to a mark means it
const TOUCH_PX = 22; // half of the 44 px that a finger needs (WCAG 2.5.5)
const CROWD = 150; // marks of a layer that become an image
const COARSE = matchMedia("(pointer: coarse)").matches; // a finger scrolls the page
const FONT = { family: "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif", size: 12 };

// The line, areas, bars and few marks of a layer as traces.
function tracesOf(layer) {
  const { line, marker, mode, name, x, y } = layer;
  const common = { x, y, name, type: "scatter", hoverinfo: "skip", showlegend: false, cliponaxis: false };
  if (mode === "area") return [{ ...common, y, mode: "lines", line: { width: 0, color: layer.fill } }, { ...common, y: layer.y2, mode: "lines", line: { width: 0, color: layer.fill }, fill: "tonexty", fillcolor: faded(layer.fill, 0.2) }];
  if (mode === "bars") {
    const [xLow, xHigh, yLow, yHigh] = [0, 1, 2, 3].map((k) => layer.ends.map((ends) => ends[k]));
    const bar = (low, high, at) => (low.every((one) => one === null) ? { visible: false } : { type: "data", symmetric: false, array: high.map((v, i) => v - at[i]), arrayminus: low.map((v, i) => at[i] - v), width: 0, thickness: 1, color: line.color });
    return [{ ...common, mode: "markers", marker: { size: 1, opacity: 0 }, opacity: line.opacity ?? 0.6, error_x: bar(xLow, xHigh, x), error_y: bar(yLow, yHigh, y) }];
  }
  const marks = mode.includes("markers") && !layer.crowd;
  if (!marks && !mode.includes("lines")) return [];
  return [{
    ...common, mode: [...(mode.includes("lines") ? ["lines"] : []), ...(marks ? ["markers"] : [])].join("+"), opacity: line?.opacity ?? 1,
    ...(line ? { line: { color: line.color, width: line.width ?? 1.5, dash: line.dash ?? "solid", shape: line.shape ?? "linear" } } : {}),
    ...(marks ? { marker: { size: marker.size, symbol: each(marker.symbol ?? "circle", (symbol) => (symbol === "cross" ? "x-thin-open" : symbol)), color: marker.ramp ? x.map((_, i) => tintOf(marker, i)) : marker.color, opacity: marker.opacity ?? 1, line: { width: /open/.test(entry(marker.symbol ?? "", 0)) ? 1.8 : 0 } } } : {}),
  }];
}

function toolOf(title, icon, click) { return { name: title, title, icon: Plotly.Icons[icon], click }; }

// A file with what plotly shows, and with more of its layout.
function pictureOf(node, format, filename, more) {
  return Plotly.downloadImage({ data: node.data, layout: { ...node.layout, ...more } }, { format, filename, width: node.layout.width, height: node.layout.height, scale: format === "png" ? 2 : 1 });
}

function configOf(picture, tools, scrollZoom) {
  const pictures = [toolOf("Picture as PNG", "camera", () => picture("png")), toolOf("Picture as SVG", "disk", () => picture("svg"))];
  return { displaylogo: false, responsive: false, scrollZoom, doubleClick: false, displayModeBar: true, showTips: false, modeBarButtons: [...(tools.length ? [tools] : []), pictures] };
}

// Plotly's bar of tools stands beside a chart, because a picture or a slider for a screen reader may hold no buttons.
function boxed(node) {
  if (node.parentElement.classList.contains("framed")) return;
  const box = make("div", { class: "framed" });
  node.replaceWith(box);
  box.append(node);
}

// Draws anew what has changed.
function react(node, traces, layout, config) {
  boxed(node);
  Plotly.react(node, traces, layout, config);
  const bar = node.querySelector(".modebar-container");
  if (bar) node.before(bar);
}

function each(list, change) { return Array.isArray(list) ? list.map(change) : change(list); }

// A colour of the style sheet with some opacity.
function faded(tint, alpha) { return tint + Math.round(255 * alpha).toString(16).padStart(2, "0"); }

function axisLook(title, kind, range) {
  return {
    title: { text: plain(title), standoff: 6 }, type: kind, range: kind === "log" ? range.map(Math.log10) : range, gridcolor: colour("grid"), linecolor: colour("line"), mirror: true, showline: true,
    zeroline: false, tickcolor: colour("line"), color: colour("soft"), automargin: false, tickangle: 0, ticklabeloverflow: "allow", nticks: 8, exponentformat: "none", minexponent: 6, ...(kind === "log" ? { dtick: Math.log10(range[1] / range[0]) > 1.3 ? "D2" : undefined } : {}),
  };
}

// Where a pointer is in an element.
function pointerIn(node, event) {
  const box = node.getBoundingClientRect();
  return [event.clientX - box.left - node.clientLeft, event.clientY - box.top - node.clientTop];
}

// Words in a box beside a place of a chart of this width.
function showTip(tip, words, [x, y], width) {
  tip.innerHTML = words; // they were made plain where they were put together
  tip.hidden = false;
  const own = tip.offsetWidth;
  tip.style.left = `${Math.min(Math.max(x + 14 + own > width ? x - own - 14 : x + 14, 0), Math.max(width - own, 0))}px`;
  tip.style.top = `${Math.max(y - tip.offsetHeight / 2, 0)}px`;
}

class Chart {
  constructor(node, { margin = {}, chosen = null, label = "", shown = null, framed = null, moved = null } = {}) {
    Object.assign(this, { node, chosen, shown, framed, moved, layers: [], view: null, margin: { l: 58, r: 14, t: 12, b: 46, ...margin } });
    node.chart = this;
    node.classList.add("plot");
    this.back = draw("svg", { "aria-hidden": "true" });
    this.words = draw("svg", { "aria-hidden": "true" });
    this.sheets = ["below", "above"].map((layer) => make("div", { class: `sheet ${layer}`, "aria-hidden": "true" }, make("canvas")));
    this.sheets[1].append(this.words);
    this.tip = make("div", { class: "tip", hidden: "" });
    node.replaceChildren(this.back, ...this.sheets, this.tip);
    boxed(node);
    if (label) describe(node, label);
    this.listen();
  }

  // x and y: { title, range, kind }; the view stays while the key stays.
  set(layers, x, y, { key = "", margin = {}, names = [], view } = {}) {
    if (view !== undefined) this.view = view;
    else if (key !== this.key) this.view = null;
    Object.assign(this, { layers, given: { x, y }, key, names, margin: { ...this.margin, ...margin } });
    this.node.layers = layers;
    for (const layer of layers) layer.crowd = Boolean(layer.cloud) || (layer.mode?.includes("markers") && layer.x.length > CROWD);
    this.draw();
  }

  measure() {
    const { node, margin } = this;
    const width = Math.max(node.clientWidth, 200), height = Math.max(node.clientHeight, 150);
    this.box = { left: margin.l, top: margin.t, width: width - margin.l - margin.r, height: height - margin.t - margin.b, all: [width, height] };
    const { x, y } = this.given;
    this.x = scaleOf(this.view?.x ?? x.range, x.kind, x.unit);
    this.y = scaleOf(this.view?.y ?? y.range, y.kind, y.unit);
  }

  px(value) { return this.box.left + this.x.share(value) * this.box.width; }

  py(value) { return this.box.top + (1 - this.y.share(value)) * this.box.height; }

  at(x, y) { return [this.px(x), this.py(y)]; }

  draw() {
    if (!this.given) return;
    this.measure();
    for (const layer of this.layers) this.place(layer);
    this.hideTip();
    this.paint();
    this.drawAxes();
    this.shown?.();
    // Plotly's part takes long at first, and then is a task of its own.
    if (this.followed || paperScale()) this.drawLines();
    else setTimeout(() => this.drawLines());
  }

  drawLines() {
    const { all } = this.box, { l, r, t, b } = this.margin;
    react(this.node, this.layers.flatMap((layer) => (this.space ? [] : tracesOf(layer))), {
      width: all[0], height: all[1], margin: { l, r, t, b, pad: 0 }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { ...FONT, color: colour("ink") }, showlegend: false, hovermode: false,
      dragmode: this.space || COARSE ? false : this.mode ?? "zoom", modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("faint"), activecolor: colour("c0"), orientation: "h" },
      xaxis: { ...axisLook(this.given.x.title, this.x.kind, this.x.range), visible: !this.space }, yaxis: { ...axisLook(this.given.y.title, this.y.kind, this.y.range), visible: !this.space },
      newselection: { line: { color: colour("select"), width: 1.5 } },
    }, this.config());
    this.follow();
  }

  // One object per chart: another one makes plotly begin anew.
  config() {
    const steps = ["zoomIn2d", "zoomOut2d", toolOf("Show the whole", "home", () => this.whole())];
    this.configs ??= configOf((format) => this.picture(format), ["zoom2d", "pan2d", ...(this.framed ? ["select2d", "lasso2d"] : []), ...steps], !COARSE && Boolean(this.chosen));
    return this.configs;
  }

  // What lies over and under plotly's lines becomes images and annotations of theirs.
  picture(format) {
    const images = this.sheets.map(({ firstChild }, k) => ({ ...imageOf(firstChild), layer: ["below", "above"][k] }));
    return pictureOf(this.node, format, "chart", { images, annotations: this.annotations() });
  }

  // Crowds of marks: clouds under the lines, marks of a front over them, and names over all.
  paint() {
    const { left, top, width, height } = this.box, marked = this.layers.filter((layer) => layer.crowd || (this.space && layer.mode.includes("markers")));
    this.sheets.forEach((sheet, k) => {
      Object.assign(sheet.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
      const [context, scale] = cleared(sheet.firstChild, width, height);
      context.translate(-left * scale, -top * scale);
      for (const layer of marked) if (Boolean(layer.cloud) !== Boolean(k)) paintMarks(context, layer, scale);
    });
    this.moveSheets([0, 1], [0, 1]);
    this.drawNames();
  }

  // While plotly pans or zooms, the canvases go along: they show these shares of what they were painted for.
  moveSheets([west, east], [south, north]) {
    const { width, height } = this.box, [wide, high] = [east - west, north - south];
    const transform = `translate(${-west / wide * width}px, ${(north - 1) / high * height}px) scale(${1 / wide}, ${1 / high})`;
    for (const part of [...this.sheets.map(({ firstChild }) => firstChild), this.words]) part.style.transform = transform;
  }

  place(layer) {
    layer.px = new Float32Array(layer.x.map((v) => this.px(v)));
    layer.py = new Float32Array(layer.y.map((v) => this.py(v)));
  }

  // Names beside marks, each where it covers neither a name nor a mark, else at the end of a short line.
  drawNames() {
    const { left, top, width, height } = this.box;
    const marks = this.space ? [] : this.names.map((name) => ({ ...name, px: this.px(name.x), py: this.py(name.y) }));
    this.labels = placedNames(marks.filter(({ px, py }) => px >= left && px <= left + width && py >= top && py <= top + height), this.box);
    this.words.replaceChildren(...this.labels.flatMap(({ px, py, from, to, at, far, text: words }) => [
      ...(far ? [draw("line", { x1: px - left, y1: py - top, x2: Math.min(Math.max(px, from), to) - left, y2: at - top, stroke: "var(--soft)" })] : []),
      text((from + to) / 2 - left, at - top + 4, words, "middle", "name halo"),
    ]));
  }

  // The same for a picture.
  annotations() {
    const inAxis = (scale, value) => (scale.kind === "log" ? Math.log10(value) : value);
    return this.labels.map(({ px, py, x, y, from, to, at, far, text: words }) => ({ x: inAxis(this.x, x), y: inAxis(this.y, y), ax: (from + to) / 2 - px, ay: at - py, text: plain(words), arrowhead: 0, arrowwidth: 1, arrowcolor: far ? colour("soft") : "rgba(0,0,0,0)", font: { color: colour("ink"), weight: 600 }, bgcolor: faded(colour("card"), 0.6), borderpad: 0 }));
  }

  drawAxes() { this.back.replaceChildren(); }

  // What plotly tells: another view, a frame or a lasso, another tool.
  follow() {
    if (this.followed) return;
    this.followed = true;
    const ends = (axis, scale) => axis.range.map((value) => (scale.kind === "log" ? 10 ** value : value));
    this.node.on("plotly_relayout", (change) => {
      if (change.dragmode) this.mode = change.dragmode;
      if (!Object.keys(change).some((key) => key.includes("axis.range"))) return;
      const { xaxis, yaxis } = this.node.layout;
      this.look({ x: ends(xaxis, this.x), y: ends(yaxis, this.y) });
    });
    this.node.on("plotly_relayouting", () => {
      const { xaxis, yaxis } = this.node._fullLayout; // only there the axes are as plotly shows them just now
      this.hideTip();
      this.moveSheets(ends(xaxis, this.x).map(this.x.share), ends(yaxis, this.y).map(this.y.share));
    });
    this.node.on("plotly_selected", () => {
      const [drawn] = this.node.layout.selections ?? [];
      if (!drawn) return;
      Plotly.relayout(this.node, { selections: [] });
      const value = (scale, text) => (scale.kind === "log" ? 10 ** Number(text) : Number(text));
      const points = drawn.type === "rect" ? [[drawn.x0, drawn.y0], [drawn.x1, drawn.y1]] : [...drawn.path.matchAll(/([\d.eE+-]+),([\d.eE+-]+)/g)].map(([, x, y]) => [x, y]);
      const corners = points.map(([x, y]) => [value(this.x, x), value(this.y, y)]);
      this.framed?.({ corners, frame: drawn.type === "rect" });
    });
  }

  look(view) {
    this.view = view;
    this.draw();
    this.moved?.(this.view);
  }

  // The point that a pointer at a place means: the nearest mark, else the nearest dot of a cloud.
  nearest(x, y, reach = NEAR_PX, wanted = "stands") {
    for (const clouds of [false, true]) {
      let best = null, least = clouds ? Math.min(reach, NEAR_PX) : reach;
      for (const layer of this.layers) {
        if (!layer[wanted] || Boolean(layer.cloud) !== clouds) continue;
        for (let i = 0; i < layer.px.length; i += 1) {
          const away = Math.hypot(layer.px[i] - x, layer.py[i] - y);
          if (away < least) { least = away; best = { layer, i }; }
        }
      }
      if (best) return best;
    }
    return null;
  }

  // Plotly's own layer takes the mouse's events; those of pointers pass it.
  listen() {
    const { node } = this;
    let start = null, clicked = { time: -Infinity, at: [0, 0] };
    node.addEventListener("pointerdown", (event) => { if (event.isPrimary && event.button === 0 && !event.target.closest(".modebar")) start = pointerIn(node, event); }, true);
    node.addEventListener("pointermove", (event) => { if (!start && this.box) this.hover(...pointerIn(node, event)); }, true);
    window.addEventListener("pointerup", (event) => {
      if (!start) return;
      const from = start, to = pointerIn(node, event);
      start = null;
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) > 4) { this.dragged?.(from, to); return; }
      const again = event.timeStamp - clicked.time < 400 && Math.hypot(to[0] - clicked.at[0], to[1] - clicked.at[1]) < 8;
      clicked = { time: event.timeStamp, at: to };
      if (again) { this.whole(); return; }
      const found = this.nearest(...to, event.pointerType === "touch" ? TOUCH_PX : NEAR_PX);
      const stands = found && entry(found.layer.stands, found.i);
      if (stands) this.chosen?.(stands);
    });
    node.addEventListener("pointercancel", () => { start = null; });
    node.addEventListener("pointerleave", () => this.hideTip());
  }

  hover(x, y) {
    const { left, top, width, height, all } = this.box;
    const inside = x >= left && x <= left + width && y >= top && y <= top + height;
    const found = inside ? this.nearest(x, y, NEAR_PX, "text") : null, words = found?.layer.text(found.i);
    if (!words) { this.hideTip(); return; }
    showTip(this.tip, words, [found.layer.px[found.i], found.layer.py[found.i]], all[0]);
  }

  hideTip() { this.tip.hidden = true; }

  // Nearer about a point of the chart, or farther with a factor above 1.
  zoom(factor, [x, y]) {
    const { left, top, width, height } = this.box;
    const corner = (sx, sy) => [x + (left + sx * width - x) * factor, y + (top + sy * height - y) * factor];
    const [from, to] = [corner(0, 0), corner(1, 1)];
    const ends = (scale, a, b) => [scale.value(a), scale.value(b)];
    this.look({ x: ends(this.x, (from[0] - left) / width, (to[0] - left) / width), y: ends(this.y, 1 - (to[1] - top) / height, 1 - (from[1] - top) / height) });
  }

  whole() { this.look(null); }
}
