// The charts of a campaign: what groups of studies need for each level of the first objective, and how they got there.

const hidden = page.sections.map(({ groups, first }) => new Set([...groups.keys()].filter((i) => !first.includes(i))));

// Colours repeat after six groups; dashes then are others. Groups that are shown at first have the first styles.
function groupStyle({ groups, first }, group) {
  const i = [...first, ...[...groups.keys()].filter((k) => !first.includes(k))].indexOf(group);
  return { color: studyColour(i), width: 2.2, dash: ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"][(i + Math.floor(i / 6)) % 6] };
}

function grouped(section, k, x, of, words) {
  return section.groups.flatMap((group, i) => {
    if (hidden[k].has(i)) return [];
    const { median, low, high } = of(group), at = x(group), style = groupStyle(section, i);
    const line = { name: group.label, mode: "lines", x: at, y: median, line: style, text: (n) => (median[n] === null ? "" : words(group, at[n], median[n], low[n], high[n])) };
    return group.studies > 1 ? [{ name: `${group.label}, band`, mode: "area", x: at, y: low, y2: high, fill: style.color }, line] : [line];
  });
}

function drawNeeds(section, k) {
  const [first, second] = section.pair;
  const side = (values) => inUnit(second, values);
  return (node) => {
    const of = ({ attainment: { median, low, high } }) => ({ median: side(median), low: side(low), high: side(high) });
    const number = (value) => (value === null || value === undefined ? "not reached" : round(value, quantity[second].decimals));
    const words = (group, x, median, low, high) => `<b>${plain(group.label)}</b><br>${plain(quantity[first].label)} ${round(x, quantity[first].decimals)} ${plain(quantity[first].unit)}: ${number(median)} ${plain(quantity[second].unit)}${group.studies > 1 ? `<br>band ${number(low)} to ${number(high)}` : ""}`;
    plot(node, grouped(section, k, () => inUnit(first, section.levels), of, words), titled(first), titled(second));
    describe(node, `${quantity[second].label} over ${quantity[first].label}: median and band of ${section.groups.length} groups of studies; the table below has numbers`);
  };
}

function drawGrowth(section, k) {
  return (node) => {
    const words = (group, x, median, low, high) => `<b>${plain(group.label)}</b><br>${x} jumps: ${round(median)} ${plain(section.unit)}${group.studies > 1 ? `<br>band ${round(low)} to ${round(high)}` : ""}`;
    plot(node, grouped(section, k, ({ evaluations }) => evaluations, ({ growth }) => growth, words), "jumps", `hypervolume, ${section.unit}`);
    describe(node, `Hypervolume over jumps: median and band of ${section.groups.length} groups of studies`);
  };
}

function startSection(section, k) {
  const again = [lazily(`attainment-${k}`, drawNeeds(section, k)), lazily(`growth-${k}`, drawGrowth(section, k))];
  if (section.groups.length < 2) return;
  const boxes = section.groups.map((_, i) => make("input", { type: "checkbox", ...(hidden[k].has(i) ? {} : { checked: "" }) }));
  const update = () => {
    boxes.forEach((box, i) => (box.checked ? hidden[k].delete(i) : hidden[k].add(i)));
    for (const redraw of again) redraw();
  };
  for (const box of boxes) box.addEventListener("change", update);
  const forAll = (words, checked) => buttonOf(words, () => {
    for (const box of boxes) box.checked = checked;
    update();
  });
  const labels = section.groups.map((group, i) => make("label", {}, boxes[i], group.label));
  byId(`switches-${k}`).append(...labels, ...(labels.length > section.first.length ? [forAll("All", true), forAll("None", false)] : []));
}

requestAnimationFrame(() => setTimeout(() => {
  page.sections.forEach(startSection);
  for (const medium of ["(prefers-color-scheme: dark)", "print"]) matchMedia(medium).addEventListener("change", redrawAll);
}));
