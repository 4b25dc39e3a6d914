// The slider over the tolerance on the page of the stopping rule: iterations of both rules on the finest grid, from
// where the published counts end on the coarser ones. The method is in arrow-hurwicz.js.
"use strict";

(() => {
  const MOST = 4000; // iterations on the finest grid
  const root = document.querySelector(".tolerance");
  const { grids, r, problems } = JSON.parse(document.querySelector(".tolerance-data").textContent);
  const [problem, slider] = [root.querySelector("select"), root.querySelector("input")];
  const histories = new Map();

  // Both measures, iteration by iteration on the finest grid.
  function history(number) {
    if (!histories.has(number)) {
      const run = new signorini.Run(problems.find((one) => one.number === number), grids, r, "signed");
      while (run.levels.length < grids.length) run.step();
      const start = run.history.signed.length - 1;
      Object.assign(run, { rule: "printed" }).level.tolerance = 0;
      for (let k = 0; k < MOST && !run.level.stop; k += 1) run.step();
      const [signed, absolute] = [run.history.signed.slice(start), run.history.absolute.slice(start)];
      histories.set(number, { signed, absolute });
    }
    return histories.get(number);
  }

  function show() {
    const tolerance = 10 ** Number(slider.value);
    const { signed, absolute } = history(Number(problem.value));
    const count = (values) => values.findIndex((value) => value <= tolerance) + 1;
    const words = (iterations) => iterations || `more than ${MOST}`;
    const [first, second] = [count(signed), count(absolute)];
    const over = first ? (absolute[first - 1] / tolerance).toPrecision(2) : 0;
    slider.setAttribute("aria-valuetext", tolerance.toExponential(1));
    root.querySelector("output").textContent = `Tolerance ${tolerance.toExponential(1)}: ` +
      `${words(first)} iterations by the signed rule, ${words(second)} by the printed one.` +
      (over ? ` Where the signed rule stops, the largest absolute value is ${over} times the tolerance.` : "");
  }

  for (const control of [problem, slider]) control.addEventListener("input", show);
  root.hidden = false;
  show();
})();
