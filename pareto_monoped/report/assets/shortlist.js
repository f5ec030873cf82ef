// The shortlist: designs that are kept to be compared, with notes, and alternatives to the selected design.

function nameOf(study, row) {
  const { label, trials } = page.studies[study];
  return `trial ${trials.trial[row]}${page.studies.length > 1 ? `, ${label}` : ""}`;
}

function keepButton(study, row, [out, none, hold] = ["Remove from shortlist", "Shortlist is full", "Keep for comparison"]) {
  const kept = shortlisted(study, row) >= 0;
  const full = !kept && state.shortlist.length >= SHORTLIST_MOST;
  // What is heard begins with what is seen.
  const words = kept ? out : full ? none : hold;
  const act = () => (kept ? drop : keep)(study, row);
  return buttonOf(words, act, { class: "hold", "data-kept": `hold ${study} ${row}`, "aria-pressed": kept, disabled: full ? "" : null, "aria-label": `${words}: ${nameOf(study, row)}` });
}

// Makes the content of an element again, and gives the focus back to what stands for the same.
function renewed(box, nodes) {
  const active = box.contains(document.activeElement) && document.activeElement.dataset.kept;
  box.replaceChildren(...nodes);
  if (active) (box.querySelector(`[data-kept="${active}"]`) ?? box.querySelector("button"))?.focus();
}

// The button beside the selected design.
function showKeep() {
  const count = state.shortlist.length, link = count ? [" ", make("a", { href: "#shortlist" }, `${count} on the shortlist`)] : [];
  renewed(byId("keep"), state.row === null ? [] : [keepButton(state.study, state.row), ...link]);
}

// Quite different designs that cost about as much; the page has them for the designs that it points out.
function alternatives() {
  const { picks, trials } = current(), known = picks.filter((p) => p.alternatives.length);
  const pick = known.find((p) => p.row === state.row);
  if (!known.length) return [];
  if (!pick) return [make("p", { class: "small" }, "Alternatives are listed for the designs that this page points out: ", ...known.flatMap((one) => [buttonOf(one.name, () => select(state.study, one.row)), " "]))];
  const rows = pick.alternatives.map((one) => {
    const show = buttonOf(`trial ${trials.trial[one.row]}`, () => select(state.study, one.row), { "aria-label": `Show ${nameOf(state.study, one.row)}` });
    const price = `${one.price > 0 ? "+" : ""}${round(100 * one.price, 1)} %`;
    return make("tr", {}, make("th", { scope: "row" }, show), make("td", { class: "n" }, price), make("td", {}, one.text + (one.audited ? "" : " (not audited)")), make("td", {}, keepButton(state.study, one.row, ["Kept", "Full", "Keep"])));
  });
  const head = make("thead", {}, make("tr", {}, ...["design", "price", "how it differs", "shortlist"].map((words, i) => make("th", { scope: "col", class: i === 1 ? "n" : null }, words))));
  const table = make("table", { class: "alternatives" }, head, make("tbody", {}, ...rows));
  return [small(`Quite different designs that cost about as much as ${nameOf(state.study, state.row)}, the most different first:`), make("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Alternatives" }, table)];
}

// One card per kept design: its name, a note, and a way out.
function showKept() {
  const list = state.shortlist.map(({ study, row, note }, i) => {
    const name = nameOf(study, row);
    const show = buttonOf(name, () => select(study, row), { "aria-label": `Show ${name}`, "data-kept": `show ${study} ${row}` });
    const words = make("input", { type: "text", maxlength: NOTE_MOST, placeholder: "note", value: note, "aria-label": `Note on ${name}`, "data-kept": `note ${study} ${row}` });
    words.addEventListener("input", () => setNote(study, row, words.value));
    const leave = () => { drop(study, row); (byId("kept").querySelector("button") ?? byId("shortlist")).focus(); };
    const out = buttonOf("Remove", leave, { "aria-label": `Remove ${name}`, "data-kept": `out ${study} ${row}` });
    return make("li", {}, make("span", { class: "swatch", style: `background: var(--c${i % 6})` }), show, words, out);
  });
  renewed(byId("kept"), list);
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
  const follow = () => { showKeep(); renewed(byId("alternatives"), alternatives()); };
  on("selection", follow);
  on("shortlist", () => {
    follow();
    // A note that is being typed is on the page already.
    if (!document.activeElement?.dataset.kept?.startsWith("note") || !sameNotes()) showKept();
  });
  showKept();
}

function sameNotes() {
  const fields = [...byId("kept").querySelectorAll("input")];
  return fields.length === state.shortlist.length && fields.every((field, i) => field.dataset.kept === `note ${state.shortlist[i].study} ${state.shortlist[i].row}` && field.value === state.shortlist[i].note);
}
