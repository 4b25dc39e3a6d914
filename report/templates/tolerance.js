// The slider over the tolerance on the page of the stopping rule: iterations of both rules on the finest grid, from
// where the published counts end on the coarser ones. The method is in arrow-hurwicz.js.
"use strict";

(() => {
  const MOST = 12000; // iterations on the finest grid
  const SLICE = 12; // milliseconds of iterating between two pictures
  const root = document.querySelector(".tolerance");
  const { grids, r, problems } = JSON.parse(document.querySelector(".tolerance-data").textContent);
  const [problem, slider] = [root.querySelector("select"), root.querySelector("input")];
  const histories = new Map();

  // Both measures, iteration by iteration on the finest grid, as far as they are known.
  function history(number) {
    if (!histories.has(number)) {
      const run = new signorini.Run(problems.find((one) => one.number === number), grids, r, "signed");
      while (run.levels.length < grids.length) run.step();
      const start = run.history.signed.length - 1;
      Object.assign(run, { rule: "printed" }).level.tolerance = 0;
      const known = { start, signed: run.history.signed, absolute: run.history.absolute };
      histories.set(number, known);
      extend(run, known);
    }
    return histories.get(number);
  }

  // Goes on, and shows what is known, until there are enough iterations.
  function extend(run, known) {
    const end = performance.now() + SLICE;
    while (known.signed.length - known.start < MOST && !run.level.stop && performance.now() < end) run.step();
    if (known.signed.length - known.start < MOST && !run.level.stop) requestAnimationFrame(() => extend(run, known));
    show();
  }

  function show() {
    const tolerance = 10 ** Number(slider.value);
    const { start, signed, absolute } = history(Number(problem.value));
    const all = signed.length - start;
    const count = (values) => values.findIndex((value, k) => k >= start && value <= tolerance) + 1 - start;
    const words = (iterations) => iterations > 0 ? iterations : `more than ${all}`;
    const [first, second] = [count(signed), count(absolute)];
    const over = first > 0 ? (absolute[start + first - 1] / tolerance).toPrecision(2) : "";
    slider.setAttribute("aria-valuetext", tolerance.toExponential(1));
    root.querySelector("output").textContent = `Tolerance ${tolerance.toExponential(1)}: ` +
      `${words(first)} iterations by the signed rule, ${words(second)} by the printed one.` +
      (over && ` Where the signed rule stops, the largest absolute value is ${over} times the tolerance.`);
  }

  for (const control of [problem, slider]) control.addEventListener("input", show);
  root.hidden = false;
  show();
})();
