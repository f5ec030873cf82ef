// What all Plotly charts share: theme, margins, redrawing when the colour scheme changes.

const charts = [];

function axis(title, more = {}) {
  return {
    title: { text: title, standoff: 8 }, gridcolor: colour("grid"), linecolor: colour("line"), zeroline: false,
    tickcolor: colour("line"), color: colour("soft"), automargin: false, ...more,
  };
}

function layout(x, y, more = {}) {
  return {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 58, r: 14, t: 12, b: 48 },
    font: { family: "system-ui, sans-serif", size: 12, color: colour("soft") }, showlegend: false,
    hoverlabel: { bgcolor: colour("card"), bordercolor: colour("faint"), font: { color: colour("ink"), size: 12 }, align: "left" },
    hovermode: "closest", xaxis: x, yaxis: y, uirevision: "keep", ...more,
  };
}

const CONFIG = {
  displaylogo: false, showSendToCloud: false, responsive: true, scrollZoom: false,
  modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
};

// Draws a chart when it comes near the view, and again when the colours change.
function lazily(id, render) {
  const node = byId(id);
  let drawn = false;
  const now = () => { drawn = true; render(node); };
  charts.push(() => { if (drawn) render(node); });
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    now();
  }, { rootMargin: "300px" });
  watcher.observe(node);
  window.addEventListener("beforeprint", () => { if (!drawn) now(); });
}

function describe(node, text) {
  node.setAttribute("role", "img");
  node.setAttribute("aria-label", text);
}
