// Start: the state in the address first, then what listens to it, then the first selection and the charts.

function start() {
  startLink();
  startSwitches();
  startAsk();
  startRobot();
  on("selection", showAll);
  startLines();
  startViewer();
  startShortlist();
  startComparison();
  tell("selection", { byUser: false, other: false });
  startFront();
  describeFront();
  startParallel();
  startTable();
  startSearch();
  for (const medium of ["(prefers-color-scheme: dark)", "print"]) matchMedia(medium).addEventListener("change", redrawAll);
}

// Text and tables are painted first; the charts wait for the next frame.
requestAnimationFrame(() => setTimeout(start));
