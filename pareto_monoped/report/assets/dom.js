// Small helpers: elements, numbers, colours. Text from a study becomes textContent, never markup.

const SVG = "http://www.w3.org/2000/svg";
// The page's content: numbers of columns and jumps, as many bytes as the text begins with, then JSON that has their places.
const [numbers, letters] = byId("payload").textContent.split(" ");
const content = await inflated(bytesOf(letters));
const page = JSON.parse(new TextDecoder().decode(new Uint8Array(content, Number(numbers))));
const { gravity_m_per_s2: GRAVITY, base_start_height_m: START_HEIGHT } = page.constants;
// How each measure and variable is shown, by its name; asking for one that Python does not know is an error.
const quantity = new Proxy(Object.fromEntries(page.quantities.map((q) => [q.name, q])), {
  get(all, name) {
    if (typeof name === "string" && !Object.hasOwn(all, name)) throw new Error(`unknown measure or variable: ${name}`);
    return all[name];
  },
});
const [FIRST, SECOND] = page.objectives;
const PAPERS_OWN = FIRST === "height_m" && SECOND === "energy_j";

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64); // of newer browsers
  const letters = atob(base64), bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

function inflated(bytes) { return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer(); }

// What a map has under a key; it is found when it is first asked for.
function once(map, key, find) {
  if (!map.has(key)) map.set(key, find());
  return map.get(key);
}

// Lets the browser paint and listen between two long steps.
function nextTask() { return new Promise((done) => setTimeout(done)); }

function byId(id) { return document.getElementById(id); }

function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined) node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}

// A button, and what a click on it does.
function buttonOf(words, act, attributes = {}) {
  const node = make("button", { type: "button", ...attributes }, words);
  node.addEventListener("click", act);
  return node;
}

function small(words) { return make("p", { class: "small" }, words); }

function draw(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function text(x, y, content, anchor = "start", kind = "") {
  const node = draw("text", { x, y, "text-anchor": anchor, class: kind });
  node.textContent = content;
  return node;
}

const tints = new Map();

// A colour of the style sheet; kept until the scheme changes, because asking for it makes the browser lay out the page.
function colour(name) { return once(tints, name, () => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim()); }

function studyColour(index) { return colour(`c${index % 6}`); }

// A number of a known quantity with its unit, as the page shows it.
function shown(name, value, withUnit = true) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const q = quantity[name];
  const text = (value * q.scale).toFixed(q.decimals);
  return withUnit && q.unit !== "1" ? `${text} ${q.unit}` : text;
}

// A measure with its unit, as the title of an axis.
function titled(name) {
  const { label, unit } = quantity[name];
  return unit === "1" || unit === ": 1" ? label : `${label}, ${unit}`;
}

// The named measures of a design in words: "0.800 m on 15.36 J", or each with its label.
function told(names, valueOf) {
  if (names.length === 2 && names[0] === "height_m" && names[1] === "energy_j") return `${shown("height_m", valueOf("height_m"))} on ${shown("energy_j", valueOf("energy_j"))}`;
  return names.map((name) => `${quantity[name].label} ${shown(name, valueOf(name))}`).join(", ");
}

function round(value, digits = 3) { return Number(value).toFixed(digits); }

// Text for the few places that show tags: escaping < removes those of the text itself.
function plain(text) { return String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;"); }

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || value === undefined || Number.isNaN(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : [0, 1];
}

function ticks(low, high, count = 5) {
  const raw = (high - low) / Math.max(count, 1) || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].find((s) => s * power >= raw * 0.999) * power;
  const result = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) result.push(k * step);
  return result;
}

function tickText(value) { return String(Number(value.toPrecision(6))); }
