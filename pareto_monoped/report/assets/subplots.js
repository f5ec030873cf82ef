// Several small charts with the same look, drawn by plotly as one figure: jumps over time, variables along the front.

const CELL = { left: 46, right: 10, top: 20, bottom: 34 };

// Cells { title, x, y, xTitle, series: [{ x, y, colour, dash, thick, mark, opacity, colours }], lines: [{ y, colour, dash, words }] }
// with marks as shapes "circle" and "diamond". Returns of each cell its frame and functions from values to pixels.
// With the same key as before only the marks are drawn anew.
function subplots(node, cells, { columns = 1, height = 130, key = null }) {
  const width = Math.max(node.clientWidth, 200), across = width / columns, rows = Math.ceil(cells.length / columns), all = rows * height;
  const places = cells.map(({ x, y }, i) => {
    const left = (i % columns) * across + CELL.left, top = Math.floor(i / columns) * height + CELL.top;
    const w = across - CELL.left - CELL.right, h = height - CELL.top - CELL.bottom;
    return { left, top, w, h, toX: (value) => left + (value - x[0]) / (x[1] - x[0] || 1) * w, toY: (value) => top + h - (value - y[0]) / (y[1] - y[0] || 1) * h };
  });
  const layout = { width, height: all, margin: { l: 0, r: 0, t: 0, b: 0, pad: 0 }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { ...FONT, size: 11, color: colour("soft") }, showlegend: false, hovermode: false, dragmode: false, modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("faint"), activecolor: colour("c0") }, shapes: [], annotations: [] };
  const traces = [], own = (k) => (k ? k + 1 : "");
  cells.forEach((cell, k) => {
    const { left, top, w, h, toX, toY } = places[k], [xref, yref] = [`x${own(k)}`, `y${own(k)}`];
    const look = (range, ticksWanted) => ({ range, nticks: ticksWanted, gridcolor: colour("grid"), linecolor: colour("line"), showline: true, mirror: true, zeroline: false, fixedrange: true, tickangle: 0, ticklabeloverflow: "allow", color: colour("soft"), exponentformat: "none" });
    layout[`xaxis${own(k)}`] = { ...look(cell.x, 5), showgrid: false, domain: [left / width, (left + w) / width], anchor: yref };
    layout[`yaxis${own(k)}`] = { ...look(cell.y, 4), domain: [1 - (top + h) / all, 1 - top / all], anchor: xref };
    const words = (x, y, text, anchor, strong) => layout.annotations.push({ xref: "paper", yref: "paper", x: x / width, y: 1 - y / all, xanchor: anchor, yanchor: "bottom", text: plain(text), showarrow: false, borderpad: 0, font: strong ? { color: colour("ink"), weight: 600 } : {} });
    words(left - 42, top - 1, cell.title, "left", true);
    if (cell.xTitle) words(left + w, top + h + 33, cell.xTitle, "right", false);
    for (const { y, colour: tint, dash, width: thick = 1, words: told, below } of cell.lines ?? []) {
      layout.shapes.push({ type: "line", xref, yref, x0: cell.x[0], x1: cell.x[1], y0: y, y1: y, line: { color: tint, width: thick, dash: dash ?? "solid" } });
      if (told) words(left + w - 3, toY(y) + (below ? 14 : 0), told, "right", false);
    }
    for (const one of cell.series) if (!one.mark) traces.push({ x: one.x, y: one.y, xaxis: xref, yaxis: yref, type: "scatter", mode: "lines", hoverinfo: "skip", line: { color: one.colour, width: one.thick ?? 1.6, dash: one.dash ?? "solid" } });
    if (cell.series.every((one) => one.mark)) traces.push({ x: [], y: [], xaxis: xref, yaxis: yref, type: "scatter" });
  });
  const same = key !== null && node.key === key;
  Object.assign(node, { cells, key });
  if (!same) {
    node.config ??= configOf((format) => pictureOf(node, format, "charts", { images: [...node.querySelectorAll(".sheet")].map(imageOf) }), [], false);
    react(node, traces, layout, node.config);
    node.querySelectorAll(".sheet").forEach((sheet) => sheet.remove());
    if (cells.some(({ series }) => series.some((one) => one.mark))) node.append(...places.map(({ left, top, w, h }) => make("canvas", { class: "sheet above", "aria-hidden": "true", style: `left: ${left}px; top: ${top}px; width: ${w}px; height: ${h}px` })));
  }
  node.querySelectorAll(".sheet").forEach((sheet, k) => {
    const { left, top, w, h, toX, toY } = places[k], [context, scale] = cleared(sheet, w, h);
    for (const one of cells[k].series) if (one.mark) paintMarks(context, { px: one.x.map((v) => toX(v) - left), py: one.y.map((v) => (v === null ? NaN : toY(v) - top)), marker: { size: one.size ?? 6, symbol: one.mark, color: one.colours ?? one.colour, opacity: one.opacity ?? 1 } }, scale);
  });
  return places;
}
