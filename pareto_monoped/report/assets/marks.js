// Marks on a canvas: small pictures that are drawn once and placed often, and clouds of dots written as pixels.

const MARKS = ["circle", "square", "diamond", "triangle-up", "triangle-down", "pentagon"];

// A mark of radius r about the origin.
function outline(context, symbol, r) {
  const corners = (count, turn, radius = () => r) => {
    for (let k = 0; k < count; k += 1) context.lineTo(radius(k) * Math.sin(turn + 2 * Math.PI * k / count), -radius(k) * Math.cos(turn + 2 * Math.PI * k / count));
    context.closePath();
  };
  context.beginPath();
  if (symbol === "square") context.rect(-0.85 * r, -0.85 * r, 1.7 * r, 1.7 * r);
  else if (symbol === "diamond") corners(4, 0, () => 1.15 * r);
  else if (symbol === "triangle-up") corners(3, 0, () => 1.15 * r);
  else if (symbol === "triangle-down") corners(3, Math.PI, () => 1.15 * r);
  else if (symbol === "pentagon") corners(5, 0);
  else if (symbol === "star") corners(10, 0, (k) => (k % 2 ? 0.45 * r : 1.1 * r));
  else if (symbol === "cross") {
    context.moveTo(-r, -r);
    context.lineTo(r, r);
    context.moveTo(-r, r);
    context.lineTo(r, -r);
  } else context.arc(0, 0, r, 0, 2 * Math.PI);
}

const pictures = new Map();

function picture(symbol, size, tint, scale) {
  const key = `${symbol} ${size} ${tint} ${scale}`;
  if (pictures.has(key)) return pictures.get(key);
  const canvas = document.createElement("canvas");
  const reach = Math.ceil(0.62 * size + 2);
  canvas.width = canvas.height = 2 * reach * scale;
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  context.translate(reach, reach);
  const open = symbol.endsWith("-open");
  outline(context, symbol.replace("-open", ""), 0.5 * size);
  Object.assign(context, { fillStyle: tint, strokeStyle: tint, lineWidth: 1.8, lineJoin: "round" });
  if (open || symbol === "cross") context.stroke();
  else context.fill();
  const made = { canvas, reach };
  if (pictures.size > 2000) pictures.clear();
  pictures.set(key, made);
  return made;
}

function entry(list, i) { return Array.isArray(list) || ArrayBuffer.isView(list) ? list[i] : list; }

// The colour of point i: a number on the ramp, or a colour in words.
function tintOf(marker, i) {
  const own = entry(marker.color, i);
  if (!marker.ramp) return own;
  return own === null || Number.isNaN(own) ? colour("faint") : RAMP_TEXT[shadeOf(own, ...marker.ramp)];
}

function paintMarks(context, layer, scale) {
  const { marker, px, py } = layer;
  for (let i = 0; i < px.length; i += 1) {
    if (Number.isNaN(px[i]) || Number.isNaN(py[i])) continue;
    const { canvas, reach } = picture(entry(marker.symbol, i) ?? "circle", entry(marker.size, i), tintOf(marker, i), scale);
    context.globalAlpha = entry(marker.opacity ?? 1, i);
    context.drawImage(canvas, px[i] - reach, py[i] - reach, 2 * reach, 2 * reach);
  }
  context.globalAlpha = 1;
}

const discs = new Map();

// Pixels of a disc with how much of each it covers.
function disc(radius) {
  const key = Math.round(4 * radius);
  if (discs.has(key)) return discs.get(key);
  const reach = Math.ceil(radius + 0.5), list = [];
  for (let y = -reach; y <= reach; y += 1) {
    for (let x = -reach; x <= reach; x += 1) {
      const cover = Math.min(Math.max(radius + 0.5 - Math.hypot(x, y), 0), 1);
      if (cover > 0) list.push([x, y, cover]);
    }
  }
  discs.set(key, list);
  return list;
}

// Dots over each other darken: a crowd shows as one. Tens of thousands take some milliseconds.
function paintCloud(image, layer, scale) {
  const { width, height, data } = image;
  const { marker, px, py } = layer;
  const one = marker.ramp || Array.isArray(marker.color) ? null : rgbOf(marker.color);
  const none = rgbOf(colour("faint"));
  for (let i = 0; i < px.length; i += 1) {
    const cx = Math.round(px[i] * scale), cy = Math.round(py[i] * scale);
    if (!(cx > -9 && cy > -9 && cx < width + 9 && cy < height + 9)) continue;
    const own = one ?? (marker.ramp ? (Number.isNaN(marker.color[i]) || marker.color[i] === null ? none : rampColour(shadeOf(marker.color[i], ...marker.ramp))) : rgbOf(marker.color[i]));
    const alpha = entry(marker.opacity, i);
    for (const [dx, dy, cover] of disc(0.5 * scale * entry(marker.size, i))) {
      const x = cx + dx, y = cy + dy;
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const k = 4 * (y * width + x), above = alpha * cover, below = data[k + 3] / 255 * (1 - above), all = above + below;
      data[k] = (own[0] * above + data[k] * below) / all;
      data[k + 1] = (own[1] * above + data[k + 1] * below) / all;
      data[k + 2] = (own[2] * above + data[k + 2] * below) / all;
      data[k + 3] = 255 * all;
    }
  }
}

const DASHES = { solid: [], dash: [7, 4], dot: [1.5, 3.5], dashdot: [7, 3, 1.5, 3], longdash: [12, 4], longdashdot: [12, 3, 1.5, 3] };

// A line through the points; "hv" goes across first, then up, "vh" the other way round.
function paintLine(context, { px, py, line }) {
  context.beginPath();
  let pen = false;
  for (let i = 0; i < px.length; i += 1) {
    if (Number.isNaN(px[i]) || Number.isNaN(py[i])) { pen = false; continue; }
    if (!pen) context.moveTo(px[i], py[i]);
    else {
      if (line.shape === "hv") context.lineTo(px[i], py[i - 1]);
      if (line.shape === "vh") context.lineTo(px[i - 1], py[i]);
      context.lineTo(px[i], py[i]);
    }
    pen = true;
  }
  Object.assign(context, { strokeStyle: line.color, lineWidth: line.width ?? 1.5, globalAlpha: line.opacity ?? 1, lineJoin: "round" });
  context.setLineDash(DASHES[line.dash ?? "solid"]);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

function paintArea(context, { px, py, py2, fill }) {
  context.beginPath();
  for (let i = 0; i < px.length; i += 1) context.lineTo(px[i], py[i]);
  for (let i = px.length - 1; i >= 0; i -= 1) context.lineTo(px[i], py2[i]);
  Object.assign(context, { fillStyle: fill, globalAlpha: 0.2 });
  context.fill();
  context.globalAlpha = 1;
}

// Bars from the least to the most of a point in x and y, where there are any.
function paintBars(context, { bars, line }) {
  context.beginPath();
  for (const [x1, x2, y1, y2, x, y] of bars) {
    if (x1 !== null) { context.moveTo(x1, y); context.lineTo(x2, y); }
    if (y1 !== null) { context.moveTo(x, y1); context.lineTo(x, y2); }
  }
  Object.assign(context, { strokeStyle: line.color, lineWidth: line.width ?? 1, globalAlpha: line.opacity ?? 0.6 });
  context.stroke();
  context.globalAlpha = 1;
}
