// What is folded away on the screen is on paper.

const unfolded = [];

function startPrint() {
  window.addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details:not([open])")) {
      details.open = true;
      unfolded.push(details);
    }
    solid.draw();
  });
  window.addEventListener("afterprint", () => { for (const details of unfolded.splice(0)) details.open = false; });
}
