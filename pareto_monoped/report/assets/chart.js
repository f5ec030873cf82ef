// A chart in the plane: axes in SVG, clouds and marks on canvases, hovering, choosing and zooming.
//
// A layer has name, x and y (values as shown), and by its mode
//   "markers"  marker { size, symbol, color, opacity, ramp }, each one value or one per point; cloud: many small dots
//   "lines"    line { color, width, dash, shape }
//   "area"     y2 and fill
//   "bars"     ends [[x low, x high, y low, y high], ...] and line
// and may have stands (what a point stands for, given to the listener of a click) and text(i) (shown over point i).

const charts = [];
const NEAR_PX = 14; // a click this near to a mark means it
const TOUCH_PX = 22; // half of the 44 px that a finger needs (WCAG 2.5.5)
const LEAST_DRAG_PX = 8;

class Chart {
  constructor(node, { margin = {}, chosen = null, label = "", shown = null } = {}) {
    Object.assign(this, { node, chosen, shown, layers: [], view: null, margin: { l: 58, r: 14, t: 12, b: 46, ...margin } });
    node.chart = this;
    this.back = draw("svg", { "aria-hidden": "true" });
    this.cloud = make("canvas", { "aria-hidden": "true" });
    this.marks = make("canvas", { "aria-hidden": "true" });
    this.front = draw("svg", { "aria-hidden": "true", "pointer-events": "none" });
    this.band = make("div", { class: "band", hidden: "" });
    this.tip = make("div", { class: "tip", hidden: "" });
    node.classList.add("plot");
    node.replaceChildren(this.back, this.cloud, this.marks, this.front, this.band, this.tip);
    if (label) describe(node, label);
    this.listen();
    new ResizeObserver(() => { if (this.drawn && (node.clientWidth !== this.drawn[0] || node.clientHeight !== this.drawn[1])) this.draw(); }).observe(node);
  }

  // x and y: { title, range, kind }; the view stays while the key stays.
  set(layers, x, y, { key = "", margin = {}, names = [] } = {}) {
    if (key !== this.key) this.view = null;
    Object.assign(this, { layers, given: { x, y }, key, names, margin: { ...this.margin, ...margin } });
    this.node.data = layers;
    this.draw();
  }

  measure() {
    const { node, margin } = this;
    const width = Math.max(node.clientWidth, 200), height = Math.max(node.clientHeight, 150);
    this.drawn = [node.clientWidth, node.clientHeight];
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
    this.paint();
    this.drawAxes();
    this.drawNames();
    this.hideTip();
    this.shown?.();
  }

  place(layer) {
    const own = (list, to) => { const result = new Float32Array(list.length); for (let i = 0; i < list.length; i += 1) result[i] = to(list[i]); return result; };
    const across = (v) => this.px(v), up = (v) => this.py(v);
    layer.px = own(layer.x, across);
    layer.py = own(layer.y, up);
    if (layer.y2) layer.py2 = own(layer.y2, up);
    if (layer.ends) layer.bars = layer.ends.map(([a, b, c, d], i) => [...[a, b].map((v) => (v === null ? null : across(v))), ...[c, d].map((v) => (v === null ? null : up(v))), layer.px[i], layer.py[i]]);
  }

  paint() {
    const scale = paperScale() ?? (window.devicePixelRatio || 1);
    const [width, height] = this.box.all;
    for (const canvas of [this.cloud, this.marks]) {
      if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
      if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
    }
    const under = this.cloud.getContext("2d");
    under.clearRect(0, 0, this.cloud.width, this.cloud.height);
    const clouds = this.layers.filter((layer) => layer.cloud);
    if (clouds.length) {
      const image = under.createImageData(this.cloud.width, this.cloud.height);
      for (const layer of clouds) paintCloud(image, layer, scale);
      under.putImageData(image, 0, 0);
      this.trim(under, scale);
    }
    const context = this.marks.getContext("2d");
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    context.save();
    const { left, top, width: w, height: h } = this.box;
    context.beginPath();
    context.rect(left - 6, top - 6, w + 12, h + 12);
    context.clip();
    for (const layer of this.layers) {
      if (layer.cloud) continue;
      if (layer.mode === "area") paintArea(context, layer);
      if (layer.mode === "bars") paintBars(context, layer);
      if (layer.mode.includes("lines")) paintLine(context, layer);
      if (layer.mode.includes("markers")) paintMarks(context, layer, scale);
    }
    context.restore();
  }

  // Dots outside the frame, which lie over the axes' numbers after zooming, are wiped away.
  trim(context, scale) {
    const { left, top, width, height, all } = this.box;
    context.clearRect(0, 0, (left - 4) * scale, all[1] * scale);
    context.clearRect(0, (top + height + 4) * scale, all[0] * scale, all[1] * scale);
    context.clearRect(0, 0, all[0] * scale, (top - 6) * scale);
    context.clearRect((left + width + 6) * scale, 0, all[0] * scale, all[1] * scale);
  }

  drawAxes() {
    const { left, top, width, height, all } = this.box;
    const { x, y } = this.given;
    const right = left + width, bottom = top + height;
    const parts = [];
    const inside = (share) => share >= -1e-6 && share <= 1 + 1e-6;
    for (const value of this.y.ticks(Math.max(Math.round(height / 55), 2))) {
      if (!inside(this.y.share(value))) continue;
      const at = this.py(value);
      parts.push(draw("line", { x1: left, x2: right, y1: at, y2: at, class: "gridline" }), text(left - 6, at + 4, tickText(value), "end"));
    }
    for (const value of this.x.ticks(Math.max(Math.round(width / 70), 3))) {
      if (!inside(this.x.share(value))) continue;
      const at = this.px(value);
      parts.push(draw("line", { x1: at, x2: at, y1: top, y2: bottom, class: "gridline" }), text(at, bottom + 16, tickText(value), "middle"));
    }
    parts.push(draw("rect", { x: left, y: top, width, height, class: "frame" }));
    const title = text(13, top + height / 2, y.title, "middle", "title");
    title.setAttribute("transform", `rotate(-90 13 ${top + height / 2})`);
    parts.push(text(left + width / 2, all[1] - 7, x.title, "middle", "title"), title);
    this.back.replaceChildren(...parts);
  }

  // Names beside marks, each where it covers neither a name nor a mark, else at the end of a short line.
  drawNames() {
    const { left, top, width, height } = this.box;
    const marks = this.names.map((name) => ({ ...name, px: this.px(name.x), py: this.py(name.y) })).filter(({ px, py }) => px >= left && px <= left + width && py >= top && py <= top + height);
    this.labels = placedNames(marks, this.box);
    this.front.replaceChildren(...this.labels.flatMap(({ px, py, from, to, at, text: words }) => {
      const label = text((from + to) / 2, at + 4, words, "middle", "strong halo");
      const far = Math.hypot(Math.max(from - px, px - to, 0), Math.max(Math.abs(at - py) - 8, 0)) > 14;
      return far ? [draw("line", { x1: px, y1: py, x2: Math.min(Math.max(px, from), to), y2: at + (py < at ? -7 : 6), stroke: "var(--soft)" }), label] : [label];
    }));
  }

  // The point that a pointer at a place means: the nearest mark, else the nearest dot of a cloud.
  nearest(x, y, reach = NEAR_PX) {
    for (const clouds of [false, true]) {
      let best = null, least = clouds ? Math.min(reach, NEAR_PX) : reach;
      for (const layer of this.layers) {
        if (!layer.stands || Boolean(layer.cloud) !== clouds) continue;
        for (let i = 0; i < layer.px.length; i += 1) {
          const away = Math.hypot(layer.px[i] - x, layer.py[i] - y);
          if (away < least) { least = away; best = { layer, i, away }; }
        }
      }
      if (best) return best;
    }
    return null;
  }

  listen() {
    const { node, band } = this;
    const place = (event) => { const box = node.getBoundingClientRect(); return [event.clientX - box.left - node.clientLeft, event.clientY - box.top - node.clientTop]; };
    let start = null;
    node.addEventListener("pointerdown", (event) => { if (event.isPrimary && event.button === 0) start = place(event); });
    node.addEventListener("pointermove", (event) => {
      const [x, y] = place(event);
      // A finger scrolls the page; only a mouse or a pen draws a frame.
      if (!start || event.pointerType === "touch") { if (!start) this.hover(x, y); return; }
      if (Math.hypot(x - start[0], y - start[1]) < LEAST_DRAG_PX) return;
      this.hideTip();
      if (band.hidden) node.setPointerCapture(event.pointerId);
      band.hidden = false;
      Object.assign(band.style, { left: `${Math.min(x, start[0])}px`, top: `${Math.min(y, start[1])}px`, width: `${Math.abs(x - start[0])}px`, height: `${Math.abs(y - start[1])}px` });
    });
    node.addEventListener("pointerup", (event) => {
      if (!start) return;
      const from = start, to = place(event);
      start = null;
      if (!band.hidden) { band.hidden = true; this.zoomTo(from, to); return; }
      const found = this.nearest(...to, event.pointerType === "touch" ? TOUCH_PX : NEAR_PX);
      const stands = found && entry(found.layer.stands, found.i);
      if (stands) this.chosen?.(stands);
    });
    node.addEventListener("pointercancel", () => { start = null; band.hidden = true; });
    node.addEventListener("pointerleave", () => this.hideTip());
    node.addEventListener("dblclick", () => this.whole());
  }

  hover(x, y) {
    if (!this.box) return;
    const found = this.textAt(x, y);
    if (!found) { this.hideTip(); return; }
    const { tip } = this;
    tip.innerHTML = found.words; // the words were made plain where they were put together
    tip.hidden = false;
    const [width] = this.box.all, own = tip.offsetWidth;
    tip.style.left = `${Math.min(Math.max(found.x + 14 + own > width ? found.x - own - 14 : found.x + 14, 0), Math.max(width - own, 0))}px`;
    tip.style.top = `${Math.max(found.y - tip.offsetHeight / 2, 0)}px`;
  }

  textAt(x, y) {
    let best = null, least = NEAR_PX;
    for (const layer of this.layers) {
      if (!layer.text) continue;
      for (let i = 0; i < layer.px.length; i += 1) {
        const away = Math.hypot(layer.px[i] - x, layer.py[i] - y) + (layer.cloud ? 4 : 0);
        if (away < least) { least = away; best = [layer, i]; }
      }
    }
    const words = best && best[0].text(best[1]);
    return words ? { words, x: best[0].px[best[1]], y: best[0].py[best[1]] } : null;
  }

  hideTip() { this.tip.hidden = true; }

  zoomTo([x1, y1], [x2, y2]) {
    const { left, top, width, height } = this.box;
    const across = [x1, x2].sort((a, b) => a - b).map((x) => this.x.value(Math.min(Math.max((x - left) / width, 0), 1)));
    const up = [y1, y2].sort((a, b) => b - a).map((y) => this.y.value(Math.min(Math.max(1 - (y - top) / height, 0), 1)));
    if (across[0] >= across[1] || up[0] >= up[1]) return;
    this.view = { x: across, y: up };
    this.draw();
  }

  // Nearer about a point of the chart, or farther with a factor above 1.
  zoom(factor, [x, y]) {
    const { left, top, width, height } = this.box;
    const corner = (sx, sy) => [x + (left + sx * width - x) * factor, y + (top + sy * height - y) * factor];
    const [from, to] = [corner(0, 0), corner(1, 1)];
    const ends = (scale, a, b) => [scale.value(a), scale.value(b)];
    this.view = { x: ends(this.x, (from[0] - left) / width, (to[0] - left) / width), y: ends(this.y, 1 - (to[1] - top) / height, 1 - (from[1] - top) / height) };
    this.draw();
  }

  whole() { this.view = null; this.draw(); }
}
