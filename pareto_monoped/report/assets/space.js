// A chart that can also be seen in three dimensions: x to the right, y upward, a third measure into the depth.

const TURN_PER_PX = 0.5; // degrees

class SpaceChart extends Chart {
  constructor(node, options) {
    super(node, options);
    this.turn = -35;
    this.tilt = 22;
    this.space = null;
  }

  measure() {
    super.measure();
    if (this.space) this.z = scaleOf(this.space.range, this.space.kind);
  }

  // Place on the canvas of shares of the three axes, seen from far away.
  project(sx, sy, sz) {
    const { left, top, width, height } = this.box;
    const rad = Math.PI / 180, turn = this.turn * rad, tilt = this.tilt * rad;
    const x = sx - 0.5, y = sz - 0.5, z = sy - 0.5;
    const across = x * Math.cos(turn) + y * Math.sin(turn), depth = -x * Math.sin(turn) + y * Math.cos(turn);
    const up = z * Math.cos(tilt) + depth * Math.sin(tilt);
    return [left + width / 2 + across * width * 0.62, top + height / 2 - 12 - up * height * 0.62];
  }

  place(layer) {
    if (!this.space || !layer.z) { super.place(layer); return; }
    layer.px = new Float32Array(layer.x.length);
    layer.py = new Float32Array(layer.x.length);
    const inside = (share) => share >= 0 && share <= 1;
    for (let i = 0; i < layer.x.length; i += 1) {
      const shares = [this.x.share(layer.x[i]), this.y.share(layer.y[i]), this.z.share(layer.z[i])];
      [layer.px[i], layer.py[i]] = shares.every(inside) ? this.project(...shares) : [NaN, NaN];
    }
  }

  at(x, y, z = null) {
    return this.space ? this.project(this.x.share(x), this.y.share(y), this.z.share(z)) : super.at(x, y);
  }

  drawAxes() {
    if (!this.space) { super.drawAxes(); return; }
    const line = (a, b, kind = "gridline") => {
      const [[x1, y1], [x2, y2]] = [this.project(...a), this.project(...b)];
      return draw("line", { x1, y1, x2, y2, class: kind });
    };
    const parts = [];
    for (const [a, b] of [[0, 0], [0, 1], [1, 0], [1, 1]]) parts.push(line([0, a, b], [1, a, b]), line([a, 0, b], [a, 1, b]), line([a, b, 0], [a, b, 1]));
    const edges = [
      [this.x, this.given.x.title, this.outermost((b, s) => [s, 0, b], 1), [0, 16]],
      [this.y, this.given.y.title, this.outermost((b, s, c) => [b, s, c], 0, -1), [-8, 4]],
      [this.z, this.space.title, this.outermost((b, s) => [b, 0, s], 1), [0, 16]],
    ];
    for (const [scale, title, place, [dx, dy]] of edges) {
      const anchor = dx < 0 ? "end" : "middle";
      parts.push(line(place(0), place(1), "frame"));
      for (const value of scale.ticks(4)) {
        const share = scale.share(value);
        if (share < 0 || share > 1) continue;
        const [x, y] = this.project(...place(share));
        parts.push(text(x + dx, y + dy, tickText(value), anchor));
      }
      const [x, y] = this.project(...place(0.5));
      const label = dx < 0 ? text(x - 40, y, title, "middle", "title halo") : text(x, y + 42, title, "middle", "title halo");
      if (dx < 0) label.setAttribute("transform", `rotate(-90 ${x - 40} ${y})`);
      parts.push(label);
    }
    this.back.replaceChildren(...parts);
  }

  // Of parallel edges of the box, the one that lies farthest down (coordinate 1) or to the left (0, with -1).
  outermost(edge, coordinate, sign = 1) {
    const all = [[0, 0], [0, 1], [1, 0], [1, 1]].map(([b, c]) => (s) => edge(b, s, c));
    const far = (place) => sign * this.project(...place(0.5))[coordinate];
    return all.reduce((best, next) => (far(next) > far(best) ? next : best));
  }

  // Dragging turns the view.
  dragged(from, to) {
    if (!this.space) return;
    this.tilt = Math.min(Math.max(this.tilt + (to[1] - from[1]) * 0.25, 0), 80);
    this.turnTo(this.turn + (to[0] - from[0]) * TURN_PER_PX);
  }

  turnTo(degrees) {
    this.turn = Math.min(Math.max(degrees, -90), 90);
    byId("turn").value = this.turn;
    this.draw();
  }
}
