// What a walk over a page needs: it runs before the page's own scripts, and tells what the page has, draws and gives away.

const walk = { before: new Map(), drawn: new Map(), said: [], waiting: [], seen: new Set() };

// Every chart counts as in view, so that it follows each change at once.
window.IntersectionObserver = class {
  constructor(listener) { this.listener = listener; }

  observe() { this.listener([{ isIntersecting: true }]); }

  unobserve() {}

  disconnect() {}
};

// A width that has changed is told when the next step is signed.
const resized = [];
window.ResizeObserver = class {
  constructor(listener) { resized.push(listener); }

  observe() {}

  unobserve() {}

  disconnect() {}
};

// What is copied and downloaded.
Object.defineProperty(navigator, "clipboard", { value: { writeText: async (text) => { walk.said.push(`copied ${text.replace(/file:.*\//, "")}`); } } });
const blobs = new Map(), madeUrl = URL.createObjectURL;
URL.createObjectURL = (blob) => {
  const url = madeUrl.call(URL, blob);
  blobs.set(url, blob);
  return url;
};
HTMLAnchorElement.prototype.click = function click() {
  if (!this.download) { this.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true })); return; }
  const blob = this.download.endsWith(".csv") && blobs.get(this.href);
  walk.waiting.push(Promise.resolve(blob ? blob.text() : "a picture").then((text) => walk.said.push(`file ${this.download}\n${text}`)));
};

// What is drawn on canvases: of each kind of call how many there were, and the sums of their numbers.
for (const [of, names] of [[CanvasRenderingContext2D, ["drawImage", "lineTo", "stroke"]], [OffscreenCanvasRenderingContext2D, ["stroke", "fill", "scale"]], [WebGL2RenderingContext, ["uniformMatrix4fv", "drawArrays"]]]) {
  for (const name of names) {
    const own = of.prototype[name];
    of.prototype[name] = function drawing(...given) {
      const look = ["strokeStyle", "fillStyle", "lineWidth", "globalAlpha"].map((key) => this[key] ?? "").join(" ");
      const key = `${name} ${this.canvas.isConnected ?? ""} ${look}`, sums = walk.drawn.get(key) ?? [0];
      sums[0] += 1;
      given.flatMap((one) => (Array.isArray(one) ? one : [one])).forEach((one, k) => { if (typeof one === "number") sums[k + 1] = (sums[k + 1] ?? 0) + one; });
      walk.drawn.set(key, sums);
      return own.apply(this, given);
    };
  }
}

// Numbers to six digits: the last ones are the machine's.
function rounded(text) {
  return text.replace(/-?\d+\.\d+(e[+-]?\d+)?|-?\d+e[+-]?\d+/g, (number) => (Math.abs(number) < 1e-9 ? "0" : String(Number(Number(number).toPrecision(6)))));
}

const LEFT_OUT = "script, style, noscript, canvas.sheet, .modebar-container, .plot-container, .tip[hidden]";

// An element with all that it holds: tags, attributes, words, and what its fields have.
function told(node) {
  if (node.nodeType === Node.TEXT_NODE) return node.data;
  if (node.nodeType !== Node.ELEMENT_NODE || node.matches(LEFT_OUT)) return "";
  const own = [...node.attributes].filter(({ name }) => name !== "style" || !node.matches(".tip, .sheet, .plot, .js-plotly-plot, .heads button")).map(({ name, value }) => `${name}=${value}`);
  for (const key of ["checked", "disabled", "value", "open"]) if (node[key] !== undefined && node[key] !== null && node.tagName !== "LI") own.push(`${key}:${node[key]}`);
  if (node.tagName === "CANVAS") own.length = 0;
  return `<${node.tagName.toLowerCase()} ${own.join(" ")}>${[...node.childNodes].map(told).join("")}`;
}

// A chart's data as the page gives it, with what hovering would show.
function chartOf(node) {
  const { layers = [], chart, data, layout, cells, modes } = node;
  const words = layers.map((layer) => [layer.name, layer.z, layer.text && layer.x.map((_, i) => layer.text(i)), layer.stands, layer.labels, layer.crowd]);
  const given = chart && [chart.given, chart.view, chart.turn, chart.tilt, chart.mode, chart.names, chart.labels?.map((one) => one.text), [...chart.back.children].map(told)];
  return JSON.stringify([words, layers.map(({ marker, line, ends, mode, y2 }) => [marker, line, ends, mode, y2]), given, data, layout, cells, modes],
    (key, value) => (key === "width" && value > 150 ? undefined : value));
}

// The parts of the page: everything that it shows, by name.
function parts() {
  const all = [["address", `${decodeURIComponent(location.hash)} ${document.title}`], ["focus", nameOf(document.activeElement)]];
  for (const node of document.querySelectorAll("header, main section[id]:not(#provenance, #context)")) all.push([node.id || "header", told(node)]);
  document.querySelectorAll(".plot, .js-plotly-plot").forEach((node, i) => all.push([`chart ${node.id || i}`, chartOf(node)]));
  all.push(["canvases", [...walk.drawn].map(([key, sums]) => `${key} ${sums.map((sum) => sum.toPrecision(5)).join(" ")}`).sort().join("\n")]);
  all.push(["given away", walk.said.join("\n")]);
  return all;
}

// What has changed since it was last asked.
walk.record = async () => {
  window.dispatchEvent(new Event("pagehide"));
  for (const listener of resized) listener([]);
  await Promise.all(walk.waiting);
  const now = parts(), changed = now.filter(([name, text]) => text !== (walk.before.get(name) ?? ""));
  walk.before = new Map(now);
  Object.assign(walk, { said: [], waiting: [] });
  walk.drawn.clear();
  walk.before.delete("given away");
  walk.before.delete("canvases");
  for (const name of walk.controls()) walk.seen.add(name);
  return changed.map(([name, text]) => [name, rounded(text)]);
};

// One step between two signatures takes no time.
Object.defineProperty(Event.prototype, "timeStamp", { get: () => performance.now() });

const OWN = ["show", "side", "column", "parallel", "motor", "study", "range", "head", "sort", "ask", "drop"];

// A control by its identity or by what it is for; those that differ in a number alone are one.
function nameOf(node) {
  if (!node || node === document.body) return "";
  const own = OWN.filter((key) => key in node.dataset).map((key) => `${key} ${node.dataset[key]}`).join(" ");
  const words = (node.dataset.title ?? node.getAttribute("aria-label") ?? node.textContent).trim().replace(/-?\d[\d.]*/g, "#").slice(0, 40);
  const place = node.matches(".modebar-btn") ? node.closest(".framed").querySelector(".js-plotly-plot") : node;
  return node.id ? `#${node.id}` : `${place.closest("[id]")?.id ?? "page"} ${own || words}`;
}

function nodes() { return [...document.querySelectorAll("a[href], button, input, select, summary, [tabindex], .modebar-btn")].filter((node) => !node.matches("section, h2, #provenance *, #context *") && node.getAttribute("tabindex") !== "-1"); }

walk.controls = () => nodes().filter((node) => !node.disabled).map(nameOf);

walk.find = (name) => nodes().find((node) => !node.disabled && nameOf(node) === name);

// What kind of use a control is for.
walk.kind = (name) => {
  const node = walk.find(name);
  if (!node) return null;
  if (node.tagName === "SELECT") return ["select", node.options.length, node.selectedIndex];
  if (node.tagName === "INPUT") return [node.type, 0, 0];
  if (node.dataset.head) return ["head", 0, 0];
  return [node.matches("a, button, summary, .modebar-btn") ? "press" : "focus", 0, 0];
};

walk.press = (name) => { walk.find(name).focus(); walk.find(name).dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true })); };

// Moves an axis of the parallel coordinates to the right.
walk.move = (name) => walk.key(walk.find(name), "ArrowRight");

walk.key = (node, key, more = {}) => {
  node.focus();
  node.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }));
};

// Follows a link to another view of this page.
walk.go = (hash) => {
  history.replaceState(null, "", `#${hash}`);
  window.dispatchEvent(new Event("hashchange"));
  return document.getElementById("page-note").textContent;
};

// Where a mark of a layer lies in the window.
walk.mark = (name, i) => {
  const node = document.getElementById("front-chart"), { px, py } = node.layers.find((layer) => layer.name === name), box = node.getBoundingClientRect();
  return [box.left + px[i], box.top + py[i]];
};

// Where an axis of the parallel coordinates lies, and a share of its height.
walk.axis = (name, share) => {
  const box = document.querySelector(`[data-axis=${name}] line`).getBoundingClientRect();
  return [box.left, box.top + share * box.height];
};

walk.set = (name, value) => {
  const node = walk.find(name);
  node.focus();
  if (node.tagName === "SELECT") node.selectedIndex = value;
  else node.value = value;
  const event = node.tagName === "SELECT" || (node.type === "number" && !("ask" in node.dataset)) ? "change" : "input";
  node.dispatchEvent(new Event(event, { bubbles: true }));
};

walk.end = (name) => walk.find(name).end ?? null;

window.walk = walk;
