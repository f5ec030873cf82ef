// Marks on a canvas: small pictures that are drawn once and placed often.

const MARKS = ["circle", "square", "diamond", "triangle-up", "triangle-down", "pentagon"];

// Outlines of marks about the origin, for a size of ten.
const OUTLINES = {
  circle: "M-5 0A5 5 0 1 0 5 0A5 5 0 1 0 -5 0Z",
  square: "M-4.25 -4.25H4.25V4.25H-4.25Z",
  diamond: "M0 -5.75L5.75 0L0 5.75L-5.75 0Z",
  "triangle-up": "M0 -5.75L4.98 2.88H-4.98Z",
  "triangle-down": "M0 5.75L4.98 -2.88H-4.98Z",
  "triangle-left": "M-5.75 0L2.88 -4.98V4.98Z",
  pentagon: "M0 -5L4.76 -1.55L2.94 4.05H-2.94L-4.76 -1.55Z",
  star: "M0 -5.5L1.32 -1.82L5.23 -1.7L2.14 .7L3.23 4.45L0 2.25L-3.23 4.45L-2.14 .7L-5.23 -1.7L-1.32 -1.82Z",
  cross: "M-5 -5L5 5M-5 5L5 -5",
};

// Of a mark its outline, and whether it is drawn as a line.
function outline(symbol) { return [OUTLINES[symbol.replace("-open", "")], symbol.endsWith("-open") || symbol === "cross"]; }

// A small mark in SVG, as the canvas draws it.
function markOf(symbol, x, y, tint) {
  const [d, open] = outline(symbol);
  return draw("path", { d, transform: `translate(${x} ${y}) scale(.8)`, fill: open ? "none" : tint, stroke: open ? tint : "none", "stroke-width": 2 });
}

const pictures = new Map();

function picture(symbol, size, tint, scale) {
  const key = `${symbol} ${size} ${tint} ${scale}`;
  if (pictures.has(key)) return pictures.get(key);
  const reach = Math.ceil((0.62 * size + 2) * scale), canvas = new OffscreenCanvas(2 * reach, 2 * reach);
  const context = softly(canvas);
  context.translate(reach, reach);
  context.scale(scale * size / 10, scale * size / 10);
  const [d, open] = outline(symbol);
  Object.assign(context, { fillStyle: tint, strokeStyle: tint, lineWidth: 18 / size, lineJoin: "round" });
  context[open ? "stroke" : "fill"](new Path2D(d));
  if (pictures.size > 2000) pictures.clear();
  const made = { image: canvas.transferToImageBitmap(), reach, id: pictures.size + 1 }; // a bitmap is placed faster than a canvas
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

// A canvas of this size on the page, empty, with its context and its pixels per pixel of the page.
function cleared(canvas, width, height) {
  const scale = paperScale() ?? (window.devicePixelRatio || 1);
  Object.assign(canvas, { width: Math.round(width * scale), height: Math.round(height * scale) });
  return [softly(canvas), scale];
}

// A canvas over the frame of the axes as an image in a picture of plotly's.
function imageOf(canvas, k = 0) {
  const own = k ? k + 1 : "";
  return { source: canvas.toDataURL(), xref: `x${own} domain`, yref: `y${own} domain`, x: 0, y: 1, sizex: 1, sizey: 1, sizing: "stretch", layer: "above" };
}

const FAINT = 0.3; // marks below it are faint together, however many lie over each other

const EDGE_PX = 16; // marks whose middle is this far outside are still in sight

// One mark over another, on the same pixel, is drawn once; of the dots of a cloud one on every two by two pixels.
function paintMarks(context, { marker, px, py, cloud }, scale) {
  const { width, height } = context.canvas, here = context.getTransform(), grid = cloud ? 2 : 1, snapped = cloud ? Math.round : (at) => at;
  const wide = Math.ceil((width + 2 * EDGE_PX) / grid) + 1, all = wide * (Math.ceil((height + 2 * EDGE_PX) / grid) + 1);
  const pictureOf = (i) => picture(entry(marker.symbol, i) ?? "circle", entry(marker.size, i), tintOf(marker, i), scale);
  const one = marker.ramp || [marker.symbol, marker.size, marker.color].some(Array.isArray) || !px.length ? null : pictureOf(0);
  const faint = new Map(), strong = { to: context, seen: new Uint16Array(all) };
  const place = ({ to, seen }, i) => {
    const x = scale * px[i] + here.e, y = scale * py[i] + here.f;
    if (!(x > -EDGE_PX && x < width + EDGE_PX && y > -EDGE_PX && y < height + EDGE_PX)) return;
    const { image, reach, id } = one ?? pictureOf(i), at = Math.round((y + EDGE_PX) / grid) * wide + Math.round((x + EDGE_PX) / grid);
    if (seen[at] === id) return;
    seen[at] = id;
    to.drawImage(image, snapped(x) - reach, snapped(y) - reach);
  };
  for (let i = 0; i < px.length; i += 1) {
    const opacity = entry(marker.opacity ?? 1, i);
    if (opacity >= FAINT) continue;
    if (!faint.has(opacity)) faint.set(opacity, { to: softly(make("canvas", { width, height })), seen: new Uint16Array(all) });
    place(faint.get(opacity), i);
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  for (const [opacity, { to }] of faint) {
    context.globalAlpha = opacity;
    context.drawImage(to.canvas, 0, 0);
  }
  for (let i = 0; i < px.length; i += 1) {
    const opacity = entry(marker.opacity ?? 1, i);
    context.globalAlpha = opacity;
    if (opacity >= FAINT) place(strong, i);
  }
  context.globalAlpha = 1;
  context.setTransform(here);
}
