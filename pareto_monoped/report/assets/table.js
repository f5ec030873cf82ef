// The table of designs: those of the front or all trials that obey the conditions, sorted, searched and downloaded.
// Only the rows in sight are in the document; the whole, in small, is the plain table that the page was written with.

const ROW_PX = 30; // as in the style sheet
const tab = { list: [], first: -1, frame: byId("rows"), body: byId("rows-body") };

function tableColumns() {
  return state.table.columns ?? [...new Set([...page.goals, ...page.leading, ...page.variables.map((v) => v.name)])].filter((name) => knownNames().includes(name));
}

const STATES = { f: "feasible", i: "infeasible", x: "failed" };

// What the search box looks through: number, study, state and motor.
function wordsOf(study, row) {
  const { trials, label } = page.studies[study];
  return `trial ${trials.trial[row]} ${label} ${STATES[trials.state[row]]} ${motorOf(page.studies[study], row)}`.toLowerCase();
}

// Rows that obey the conditions and the search, sorted; those without a value come last.
function tableRows() {
  const { rows, sort, down, find } = state.table;
  const wanted = find.trim().toLowerCase();
  const list = [...state.visible].sort((a, b) => a - b).flatMap((study) => {
    const own = rows === "front" ? keptFront(study) : page.studies[study].trials.trial.map((_, row) => row);
    return own.filter((row) => inRanges(study, row) && (!wanted || wordsOf(study, row).includes(wanted))).map((row) => [study, row]);
  });
  const columns = page.studies.map((_, i) => columnOf(i, sort));
  const sign = down ? -1 : 1;
  const value = ([study, row]) => columns[study][row];
  const none = (v) => v === null || Number.isNaN(v);
  return list.sort((a, b) => {
    const [u, v] = [value(a), value(b)];
    if (none(u) || none(v)) return none(u) - none(v);
    return sign * (u - v);
  });
}

function drawTable() {
  tab.list = tableRows();
  const columns = tableColumns();
  const { sort, down } = state.table;
  const several = page.studies.length > 1;
  const heads = columns.map((name) => {
    const turn = () => { setTable({ sort: name, down: name === state.table.sort ? !state.table.down : better(name) > 0 }); document.querySelector(`[data-sort="${name}"]`)?.focus(); };
    const button = buttonOf(`${titled(name)}${name === sort ? (down ? " ▼" : " ▲") : ""}`, turn, { "data-sort": name, title: `Sort by ${quantity[name].label}` });
    return make("th", { scope: "col", class: "n", "aria-sort": name === sort ? (down ? "descending" : "ascending") : "none" }, button);
  });
  byId("rows-head").replaceChildren(make("tr", {}, make("th", { scope: "col" }, "keep"), make("th", { scope: "col" }, "trial"), ...(several ? [make("th", { scope: "col" }, "study")] : []), ...(state.table.rows === "all" ? [make("th", { scope: "col" }, "state")] : []), ...heads));
  byId("rows-table").setAttribute("aria-rowcount", tab.list.length + 1);
  const total = [...state.visible].reduce((sum, i) => sum + (state.table.rows === "front" ? keptFront(i).length : page.studies[i].trials.trial.length), 0);
  byId("rows-note").textContent = `${tab.list.length} of ${total} ${state.table.rows === "front" ? `designs of the front${filtered() ? " within the conditions" : ""}` : `trials${filtered() ? " obey the conditions" : ""}`}.`;
  tab.first = -1;
  drawRows();
}

function drawRows() {
  const { frame, body, list } = tab;
  const first = Math.max(Math.floor(frame.scrollTop / ROW_PX) - 5, 0);
  const last = Math.min(first + Math.ceil((frame.clientHeight || 420) / ROW_PX) + 12, list.length);
  if (first === tab.first) return;
  const held = document.activeElement?.closest?.("#rows-body") && document.activeElement.dataset.at;
  tab.first = first;
  const columns = tableColumns();
  const gap = (rows) => (rows > 0 ? [make("tr", { "aria-hidden": "true", class: "gap", style: `height: ${rows * ROW_PX}px` })] : []);
  body.replaceChildren(...gap(first), ...list.slice(first, last).map((one, k) => rowOf(one, first + k, columns)), ...gap(list.length - last));
  if (held) body.querySelector(`[data-at="${held}"]`)?.focus({ preventScroll: true });
  markRows();
}

function rowOf([study, row], at, columns) {
  const { trials, label } = page.studies[study];
  const number = trials.trial[row];
  const box = make("input", { type: "checkbox", "data-at": `k${at}`, "aria-label": `Keep trial ${number}` });
  box.addEventListener("change", () => {
    if (!box.checked) drop(study, row);
    else if (!keep(study, row)) {
      box.checked = false;
      byId("page-note").textContent = byId("rows-note").textContent = `The shortlist has room for ${SHORTLIST_MOST} designs: drop one first.`;
    }
  });
  const button = buttonOf(number, () => select(study, row), { "data-at": `s${at}`, "aria-label": `Select trial ${number}` });
  return make("tr", { "aria-rowindex": at + 2, "data-row": `${study}:${row}` }, make("td", {}, box), make("th", { scope: "row" }, button),
    ...(page.studies.length > 1 ? [make("td", {}, label)] : []), ...(state.table.rows === "all" ? [make("td", {}, STATES[trials.state[row]])] : []),
    ...columns.map((name) => make("td", { class: "n" }, shown(name, valueAt(study, name, row), false))));
}

// The selection and the shortlist in the rows in sight.
function markRows() {
  for (const line of tab.body.querySelectorAll("[data-row]")) {
    const [study, row] = line.dataset.row.split(":").map(Number);
    line.classList.toggle("chosen", study === state.study && row === state.row);
    line.querySelector("input").checked = shortlisted(study, row) >= 0;
  }
}

// A cell of a CSV file; the separator is a comma (RFC 4180). A cell that a spreadsheet would compute is text.
function csvCell(value) {
  const text = /^[=+\-@]/.test(String(value)) && Number.isNaN(Number(value)) ? `'${value}` : String(value);
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function csvText() {
  const columns = tableColumns();
  const lines = tab.list.map(([study, row]) => {
    const { trials, label } = page.studies[study];
    const values = columns.map((name) => { const value = valueAt(study, name, row); return value === null ? "" : Number(value.toPrecision(6)); });
    return [label, trials.trial[row], STATES[trials.state[row]], motorOf(page.studies[study], row), ...values].map(csvCell).join(",");
  });
  return `${[["study", "trial", "state", "motor", ...columns].join(","), ...lines].join("\r\n")}\r\n`;
}

function download() {
  tab.list = tableRows();
  const link = make("a", { download: `${page.title.replace(/[^\w-]+/g, "_").slice(0, 60) || "designs"}.csv`, href: URL.createObjectURL(new Blob([csvText()], { type: "text/csv" })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function startTable() {
  byId("table").classList.add("live");
  const choice = byId("rows-choice"), find = byId("rows-find");
  choice.addEventListener("change", () => setTable({ rows: choice.value }));
  find.addEventListener("input", () => setTable({ find: find.value }));
  byId("rows-csv").addEventListener("click", download);
  const redraw = lazily("rows", drawTable);
  const follow = () => {
    choice.value = state.table.rows;
    if (document.activeElement !== find) find.value = state.table.find;
  };
  for (const name of knownNames()) byId("rows-columns").append(switchOf({ "data-column": name }, "", titled(name), "table", () => tableColumns().includes(name), (shown) => setTable({ columns: knownNames().filter((one) => (one === name ? shown : tableColumns().includes(one))) })));
  startCondition();
  follow();
  tab.frame.addEventListener("scroll", drawRows);
  tab.body.addEventListener("click", (event) => {
    const line = event.target.closest("[data-row]");
    if (line && !event.target.closest("input, button")) select(...line.dataset.row.split(":").map(Number));
  });
  on("table", () => { follow(); redraw(); });
  on("conditions", ({ final }) => { if (final) redraw(); });
  on("selection", markRows);
  on("shortlist", markRows);
}

// A condition on any measure, which the whole page then obeys.
function startCondition() {
  const choice = byId("rows-measure");
  choice.append(...optionsOf(axisNames()));
  choice.closest(".filter").hidden = !choice.value;
  const change = () => {
    const fields = rangeFields(choice.value, (word) => ({ id: `rows-${word}` }));
    byId("rows-range").replaceChildren(...fields.map((field) => make("label", {}, `${field.placeholder} `, field)));
    fillRanges();
  };
  choice.addEventListener("change", change);
  if (choice.value) change();
}
