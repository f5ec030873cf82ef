// What is folded away on the screen is on paper.

const unfolded = [];

window.addEventListener("beforeprint", () => {
  unfolded.push(...document.querySelectorAll("details:not([open])"));
  for (const details of unfolded) details.open = true;
  solid.draw();
});
window.addEventListener("afterprint", () => { for (const details of unfolded.splice(0)) details.open = false; });
