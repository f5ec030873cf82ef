// Start: listeners first, then the first selection, then the charts, beginning with the front.

function firstSelection() {
  const study = page.studies.findIndex((s) => s.front.length);
  if (study >= 0) {
    const { picks, front } = page.studies[study];
    return [study, (picks[0] ?? { row: front[0] }).row];
  }
  const any = page.studies.findIndex((s) => s.trials.trial.length);
  return any >= 0 ? [any, 0] : [0, null];
}

function redrawAll() { for (const redraw of charts) redraw(); }

function start() {
  startSwitches();
  startAsk();
  startRobot();
  on("selection", showAll);
  startLines();
  startViewer();
  select(...firstSelection(), false);
  startFront();
  describeFront();
  startParallel();
  startSearch();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawAll);
}

// Text and tables are painted first; the charts wait for the next frame.
requestAnimationFrame(() => setTimeout(start));
