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
  const context = softly(canvas);
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

// A canvas that is read back as an image, and so is better kept out of the graphics card.
function softly(canvas) { return canvas.getContext("2d", { willReadFrequently: true }); }

const FAINT = 0.3; // marks below it are faint together, however many lie over each other

function paintMarks(context, layer, scale) {
  const { marker, px, py } = layer, faint = new Map(), drawn = new Map(), here = context.getTransform();
  const place = (to, i) => {
    if (Number.isNaN(px[i]) || Number.isNaN(py[i])) return;
    const made = picture(entry(marker.symbol, i) ?? "circle", entry(marker.size, i), tintOf(marker, i), scale), { canvas, reach } = made;
    // One mark exactly over another is drawn once.
    if (!drawn.has(made)) drawn.set(made, new Set());
    const at = Math.round(2 * px[i]) * 65536 + Math.round(2 * py[i]), known = drawn.get(made), size = known.size;
    if (known.add(at).size > size) to.drawImage(canvas, px[i] - reach, py[i] - reach, 2 * reach, 2 * reach);
  };
  for (let i = 0; i < px.length; i += 1) {
    const opacity = entry(marker.opacity ?? 1, i);
    if (opacity < FAINT) {
      if (!faint.has(opacity)) {
        const sheet = softly(make("canvas", { width: context.canvas.width, height: context.canvas.height }));
        sheet.setTransform(here);
        faint.set(opacity, sheet);
      }
      place(faint.get(opacity), i);
    }
  }
  for (const [opacity, sheet] of faint) {
    context.globalAlpha = opacity;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(sheet.canvas, 0, 0);
    context.setTransform(here);
  }
  drawn.clear();
  for (let i = 0; i < px.length; i += 1) {
    const opacity = entry(marker.opacity ?? 1, i);
    context.globalAlpha = opacity;
    if (opacity >= FAINT) place(context, i);
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
function paintCloud(image, layer, scale, left, top) {
  const { width, height, data } = image;
  const { marker, px, py } = layer;
  const one = marker.ramp || Array.isArray(marker.color) ? null : rgbOf(marker.color);
  const none = rgbOf(colour("faint"));
  for (let i = 0; i < px.length; i += 1) {
    const cx = Math.round((px[i] - left) * scale), cy = Math.round((py[i] - top) * scale);
    if (!(cx > -9 && cy > -9 && cx < width + 9 && cy < height + 9)) continue;
    const own = one ?? (marker.ramp ? (Number.isNaN(marker.color[i]) || marker.color[i] === null ? none : rampColour(shadeOf(marker.color[i], ...marker.ramp))) : rgbOf(marker.color[i]));
    const alpha = entry(marker.opacity, i);
    for (const [dx, dy, cover] of disc(0.5 * scale * entry(marker.size, i))) {
      const x = cx + dx, y = cy + dy;
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const k = 4 * (y * width + x), above = alpha * cover, before = data[k + 3] / 255, below = alpha < 0.1 ? Math.max(before - above, 0) : before * (1 - above), all = above + below;
      data[k] = (own[0] * above + data[k] * below) / all;
      data[k + 1] = (own[1] * above + data[k + 1] * below) / all;
      data[k + 2] = (own[2] * above + data[k + 2] * below) / all;
      data[k + 3] = 255 * all;
    }
  }
}
