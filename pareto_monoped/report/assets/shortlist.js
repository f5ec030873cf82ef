// The shortlist: designs that are kept to be compared, with notes, and alternatives to the selected design.

function nameOf(study, row) {
  const { label, trials } = page.studies[study];
  return `trial ${trials.trial[row]}${page.studies.length > 1 ? `, ${label}` : ""}`;
}

function keepButton(study, row) {
  const kept = shortlisted(study, row) >= 0;
  const full = !kept && state.shortlist.length >= SHORTLIST_MOST;
  // What is heard begins with what is seen.
  const words = kept ? "Remove from shortlist" : full ? "Shortlist is full" : "Keep for comparison";
  const button = make("button", { type: "button", "aria-pressed": kept, disabled: full ? "" : null, "aria-label": `${words}: ${nameOf(study, row)}` }, words);
  button.addEventListener("click", () => {
    if (kept) drop(study, row);
    else keep(study, row);
  });
  return button;
}

// The button beside the selected design; the same node stays in place, so that the keyboard does not lose it.
function showKeep() {
  const box = byId("keep");
  const focused = box.contains(document.activeElement);
  box.replaceChildren();
  if (state.row === null) return;
  box.append(keepButton(state.study, state.row));
  const count = state.shortlist.length;
  if (count) box.append(" ", make("a", { href: "#shortlist" }, `${count} on the shortlist`));
  if (focused) box.querySelector("button").focus();
}

// Quite different designs that cost about as much; the page has them for the designs that it points out.
function showAlternatives() {
  const box = byId("alternatives");
  box.replaceChildren();
  const chosen = subject();
  const pick = chosen?.kind === "trial" ? chosen.study.picks.find((p) => p.row === chosen.row && p.alternatives.length) : null;
  if (!pick) {
    const known = current().picks.filter((p) => p.alternatives.length);
    if (!known.length) return;
    box.append(make("p", { class: "small" }, "Alternatives are listed for the designs that this page points out: "));
    for (const one of known) {
      const button = make("button", { type: "button" }, one.name);
      button.addEventListener("click", () => select(state.study, one.row));
      box.lastChild.append(button, " ");
    }
    return;
  }
  box.append(make("p", { class: "small" }, `Quite different designs that cost about as much as ${nameOf(state.study, chosen.row)}, the most different first:`));
  const rows = pick.alternatives.map((one) => {
    const show = make("button", { type: "button", "aria-label": `Show ${nameOf(state.study, one.row)}` }, `trial ${chosen.study.trials.trial[one.row]}`);
    show.addEventListener("click", () => select(state.study, one.row));
    const hold = make("button", { type: "button", class: "hold" });
    const label = () => {
      const kept = shortlisted(state.study, one.row) >= 0;
      hold.textContent = kept ? "Kept" : "Keep";
      hold.setAttribute("aria-pressed", kept);
      hold.setAttribute("aria-label", `${kept ? "Remove" : "Keep"} ${nameOf(state.study, one.row)}`);
      hold.disabled = !kept && state.shortlist.length >= SHORTLIST_MOST;
    };
    hold.addEventListener("click", () => {
      if (shortlisted(state.study, one.row) >= 0) drop(state.study, one.row);
      else keep(state.study, one.row);
    });
    alternativeLabels.push(label);
    label();
    const price = `${one.price > 0 ? "+" : ""}${round(100 * one.price, 1)} %`;
    return make("tr", {}, make("th", { scope: "row" }, show), make("td", { class: "n" }, price), make("td", {}, one.text + (one.audited ? "" : " (not audited)")), make("td", {}, hold));
  });
  const head = make("thead", {}, make("tr", {}, ...["design", "price", "how it differs", "shortlist"].map((words, i) => make("th", { scope: "col", class: i === 1 ? "n" : null }, words))));
  box.append(make("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Alternatives" }, make("table", { class: "alternatives" }, head, make("tbody", {}, ...rows))));
}

let alternativeLabels = [];

function redrawAlternatives() {
  alternativeLabels = [];
  showAlternatives();
}

// One card per kept design: its name, a note, and a way out.
function showKept() {
  const box = byId("kept");
  const active = document.activeElement?.dataset.kept;
  const list = state.shortlist.map(({ study, row, note }, i) => {
    const name = nameOf(study, row);
    const show = make("button", { type: "button", "aria-label": `Show ${name}`, "data-kept": `show ${study} ${row}` }, name);
    show.addEventListener("click", () => select(study, row));
    const words = make("input", { type: "text", maxlength: NOTE_MOST, placeholder: "note", value: note, "aria-label": `Note on ${name}`, "data-kept": `note ${study} ${row}` });
    words.addEventListener("input", () => setNote(study, row, words.value));
    const out = make("button", { type: "button", "aria-label": `Remove ${name}`, "data-kept": `out ${study} ${row}` }, "Remove");
    out.addEventListener("click", () => {
      drop(study, row);
      (byId("kept").querySelector("button") ?? byId("shortlist")).focus();
    });
    return make("li", {}, make("span", { class: "swatch", style: `background: var(--c${i % 6})` }), show, words, out);
  });
  box.replaceChildren(...list);
  if (active) box.querySelector(`[data-kept="${active}"]`)?.focus();
  byId("shortlist-note").textContent = [
    `Keep two to ${SHORTLIST_MOST} designs to see them side by side: their variables, gearboxes, masses, loads, energies and jumps.`,
    "Keep one more design to compare.",
  ][state.shortlist.length] ?? "";
}

// One line that exports every kept design: a loop for each database.
function exportCommand() {
  const loops = page.studies.flatMap((study, index) => {
    const numbers = state.shortlist.filter((one) => one.study === index).map((one) => study.trials.trial[one.row]);
    const several = new Set(state.shortlist.map((one) => one.study)).size > 1;
    const folder = several ? `cad/study_${index + 1}_trial_$n` : "cad/trial_$n";
    return numbers.length ? [`for n in ${numbers.join(" ")}; do pareto-monoped export ${quoted(study.database)} --trial $n -o ${folder} || break; done`] : [];
  });
  return loops.join("; ");
}

function startShortlist() {
  byId("shortlist").setAttribute("tabindex", "-1");
  on("selection", () => { showKeep(); redrawAlternatives(); });
  on("shortlist", () => {
    showKeep();
    for (const label of alternativeLabels) label();
    // A note that is being typed is on the page already.
    if (!document.activeElement?.dataset.kept?.startsWith("note") || !sameNotes()) showKept();
  });
  showKept();
}

function sameNotes() {
  const fields = [...byId("kept").querySelectorAll("input")];
  return fields.length === state.shortlist.length && fields.every((field, i) => field.dataset.kept === `note ${state.shortlist[i].study} ${state.shortlist[i].row}` && field.value === state.shortlist[i].note);
}
