// Choosing as pareto/pick.py does it: conditions make the front, and scores are scaled to the front without conditions.

const soundOnes = new Map();

// Rows of a study that may be chosen: feasible, and not failed in their audit.
function soundRows(study) {
  return once(soundOnes, study, () => {
    const card = page.studies[study], out = new Set(card.ill_conditioned);
    return feasibleRows(card).filter((row) => !out.has(row));
  });
}

// Rows of a study's trials in a state.
function rowsIn(study, wanted) {
  study.rows ??= {};
  return (study.rows[wanted] ??= [...study.trials.state].flatMap((letter, row) => (letter === wanted ? [row] : [])));
}

function feasibleRows(study) { return rowsIn(study, "f"); }

// Every end of a range is a condition { name, side: 0 at least or 1 at most, value }.
function conditionList() {
  return Object.entries(state.ranges).flatMap(([name, ends]) => ends.flatMap((value, side) => (value === null ? [] : [{ name, side, value }])));
}

// The page has numbers in single precision; NaN meets nothing.
function meetsOne(value, { side, value: limit }) { return side ? value <= Math.fround(limit) : value >= Math.fround(limit); }

function rowsMeeting(study, rows, list) {
  const { motor } = page.studies[study].trials.columns;
  const tests = list.map((one) => [columnOf(study, one.name), one]);
  return rows.filter((row) => !(motor && state.withoutMotors.has(motor[row])) && tests.every(([column, one]) => meetsOne(column[row], one)));
}

// What follows from the present conditions, kept until they change.
const within = new Map();
on("conditions", () => within.clear());

function keptWithin(key, find) { return once(within, key, find); }

// Rows of all trials of a study that obey the conditions, as a mask.
function masked(study) {
  return keptWithin(`mask ${study}`, () => {
    const { length } = page.studies[study].trials.trial, mask = new Uint8Array(length);
    for (const row of rowsMeeting(study, Array.from({ length }, (_, row) => row), conditionList())) mask[row] = 1;
    return mask;
  });
}

const costLists = new Map();

function costOf(study, name) {
  const sign = -better(name);
  return once(costLists, `${study} ${name}`, () => columnOf(study, name).map((value) => sign * value));
}

// Of rows with costs, one list per objective and less is better, those that no other betters; of equal ones the first.
// A row is met after all that could better it, so that the best second and third costs so far, a flight of stairs, tell.
function notDominated(rows, [a, b, c]) {
  const order = rows.filter((row) => a[row] + b[row] + (c?.[row] ?? 0) === a[row] + b[row] + (c?.[row] ?? 0));
  order.sort((i, j) => a[i] - a[j] || b[i] - b[j] || (c ? c[i] - c[j] : 0) || i - j);
  const seconds = [], thirds = [], kept = [];
  for (const row of order) {
    const third = c ? c[row] : 0;
    let low = 0, high = seconds.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (seconds[middle] <= b[row]) low = middle + 1;
      else high = middle;
    }
    if (low && thirds[low - 1] <= third) continue;
    let end = low;
    while (end < thirds.length && thirds[end] >= third) end += 1;
    seconds.splice(low, end - low, b[row]);
    thirds.splice(low, end - low, third);
    kept.push(row);
  }
  return kept;
}

// Rows of a study's front within the conditions, by its first objective.
function keptFront(study) {
  const { front, objectives } = page.studies[study];
  if (!filtered()) return front;
  return keptWithin(`front ${study}`, () => {
    const mask = masked(study), first = columnOf(study, objectives[0]);
    return notDominated(soundRows(study).filter((row) => mask[row]), objectives.map((name) => costOf(study, name))).sort((i, j) => first[i] - first[j] || i - j);
  });
}

// Some designs of all studies shown as one table: how many, where each stands, and its costs in the page's objectives.
function pooled(rowsOf) {
  const stands = [...state.visible].sort((a, b) => a - b).flatMap((study) => rowsOf(study).map((row) => [study, row]));
  const joined = (valuesOf) => {
    const columns = page.studies.map((_, study) => valuesOf(study)), all = new Float32Array(stands.length);
    stands.forEach(([study, row], i) => { all[i] = columns[study][row]; });
    return all;
  };
  return { size: stands.length, stand: (i) => stands[i], joined, costs: page.objectives.map((name) => joined((study) => costOf(study, name))) };
}

function counted(size) { return Array.from({ length: size }, (_, i) => i); }

// The least and the greatest cost in each objective on the front of all studies shown, without conditions.
function wholeEnds() {
  return keptWithin("ends", () => {
    const { size, costs } = pooled((study) => (page.studies[study].objectives.join() === page.objectives.join() ? page.studies[study].front : soundRows(study)));
    const rows = notDominated(counted(size), costs);
    return costs.map((cost) => extent(rows.map((row) => cost[row])));
  });
}

// Ways to choose, by their keys in the state: "" the best that the conditions leave, "knee", "compromise", and
// "least NAME" and "most NAME" of any measure or variable. Each gives a cost to every design of a table.
function wayOf(key) {
  const [word, name] = key.split(" ");
  if (name) return { words: `the ${word} ${quantity[name].label}`, front: false, cost: ({ joined }) => joined((study) => (word === "least" ? columnOf(study, name) : columnOf(study, name).map((value) => -value))) };
  if (!word) {
    // The first objective that no condition is about, else the second.
    const at = page.objectives.findIndex((objective) => !state.ranges[objective]);
    return { words: superlative(page.objectives[at < 0 ? 1 : at]), front: false, cost: ({ costs }) => costs[at < 0 ? 1 : at] };
  }
  const ends = wholeEnds();
  const loss = (costs, i) => costs.map((cost, k) => (ends[k][1] > ends[k][0] ? (cost[i] - ends[k][0]) / (ends[k][1] - ends[k][0]) : 0));
  const total = word === "knee" ? (losses) => losses.reduce((sum, one) => sum + one, 0) : (losses) => Math.hypot(...losses);
  return { words: word === "knee" ? "the knee" : "the compromise, nearest to the best of every objective", front: true, cost: ({ costs, size }) => counted(size).map((i) => total(loss(costs, i))) };
}

// The design that the conditions and the way to choose ask for, as { design, words, count, onFront }; null without any.
function chosenDesign() { return keptWithin(`chosen ${state.best}`, () => foundDesign(state.best)); }

function foundDesign(key) {
  const table = pooled((study) => { const mask = masked(study); return soundRows(study).filter((row) => mask[row]); });
  if (!table.size) return null;
  const way = wayOf(key), cost = way.cost(table), { costs, size } = table;
  const inside = notDominated(counted(size), costs);
  const ahead = (i, j) => { let gain = cost[j] - cost[i]; for (const one of costs) gain ||= one[j] - one[i]; return gain; };
  let best = -1;
  for (const i of way.front ? inside.sort((i, j) => i - j) : counted(size)) if (!Number.isNaN(cost[i]) && (best < 0 || ahead(i, best) > 0)) best = i;
  if (best < 0) return null;
  const design = table.stand(best), name = key.split(" ")[1];
  return { design, words: name ? `${way.words}, ${shown(name, valueAt(design[0], name, design[1]))},` : way.words, count: size, onFront: inside.length };
}

const DEAR = 1.5, BATTERY = "electrical_energy_j";

// What marks a design that takes half as much again from the battery as the least stored for its height; else "".
// Studies with more variables free are left aside: what they have is no choice in its own study.
function dearWords(study, row) {
  const height = columnOf(study, "height_m")[row], own = columnOf(study, BATTERY)[row];
  const { wider } = page.studies[study];
  let least = Infinity;
  for (const i of state.visible) {
    if (wider.includes(i)) continue;
    const heights = columnOf(i, "height_m"), energies = columnOf(i, BATTERY);
    for (const other of soundRows(i)) if (heights[other] >= height && energies[other] < least) least = energies[other];
  }
  if (!(own > DEAR * least)) return "";
  return `Dear at the battery: it takes ${shown(BATTERY, own)} from it, ${round(own / least, 1)} times the least that is stored for this height${wider.length ? " with these variables free" : ""}, ${shown(BATTERY, least)}.`;
}
