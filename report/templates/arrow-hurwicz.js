// The paper's iteration in JavaScript: the mathematics of the page tables.html, without the page.
//
// With f at the nodes it does the same floating-point operations in the same order as
// src/mathematics/src/saddle, so that counts, and the last bit of every number, are those of the tables.
// Needs right-hand-side.js. Served as it is written: no library, no build step.
"use strict";

const signorini = (() => {
  // Iterations on a grid after which the page gives up: a reader will not wait for the program's limit.
  const CAP = 200000;

  // Nodes of the boundary, anticlockwise from the lower left corner.
  function boundaryNodes(n) {
    return Array.from({ length: 4 * n }, (_, b) => {
      const along = b % n;
      const [i, j] = [[along, 0], [n, along], [n - along, n], [0, n - along]][Math.floor(b / n)];
      return j * (n + 1) + i;
    });
  }

  // One Gauss-Seidel sweep (9)-(11) over all nodes, row by row from the lower left corner.
  function sweep(n, load, r, y, a) {
    const side = n + 1, h = 1 / n;
    const relax = (k, b, diagonal, sum) => {
      const psi = (1 / diagonal) * sum;
      y[k] = psi >= a[b] / r ? psi : (sum + h * a[b]) / (diagonal + h * r);
    };
    for (let j = 0; j <= n; j++) {
      const row = j * side, end = row + n;
      if (j === 0 || j === n) {
        const inward = j === 0 ? side : -side;
        const number = (i) => (j === 0 ? i : 3 * n - i);
        relax(row, number(0), 1, load[row] + 0.5 * y[row + 1] + 0.5 * y[row + inward]);
        for (let k = row + 1; k < end; k++) {
          relax(k, number(k - row), 2, load[k] + 0.5 * y[k + 1] + y[k + inward] + 0.5 * y[k - 1]);
        }
        relax(end, number(n), 1, load[end] + 0.5 * y[end + inward] + 0.5 * y[end - 1]);
      } else {
        relax(row, 4 * n - j, 2, load[row] + y[row + 1] + 0.5 * y[row + side] + 0.5 * y[row - side]);
        for (let k = row + 1; k < end; k++) {
          y[k] = 0.25 * (load[k] + y[k + 1] + y[k + side] + y[k - side] + y[k - 1]);
        }
        relax(end, n + j, 2, load[end] + 0.5 * y[end + side] + 0.5 * y[end - side] + y[end - 1]);
      }
    }
  }

  // The step (12) of the multiplier; returns its largest change, which is not finite if it diverged.
  function dualStep(nodes, r, y, a) {
    let change = 0;
    nodes.forEach((k, b) => {
      const next = a[b] - r * y[k];
      change = Math.max(change, Math.abs((next <= 0 ? 0 : next) - a[b]));
      a[b] = next <= 0 ? 0 : next;
    });
    return change;
  }

  // Largest component of the gradient (8), and largest absolute value.
  function gradient(n, load, r, y, a) {
    const side = n + 1, h = 1 / n;
    let signed = -Infinity, absolute = 0;
    const see = (g) => {
      signed = Math.max(signed, g);
      absolute = Math.max(absolute, Math.abs(g));
    };
    const pull = (k, b) => h * Math.max(a[b] - r * y[k], 0);
    for (let j = 0; j <= n; j++) {
      const row = j * side, end = row + n;
      if (j === 0 || j === n) {
        const inward = j === 0 ? side : -side;
        const number = (k) => (j === 0 ? k - row : 3 * n - (k - row));
        see(y[row] - (load[row] + 0.5 * y[row + 1] + 0.5 * y[row + inward]) - pull(row, number(row)));
        for (let k = row + 1; k < end; k++) {
          const sum = load[k] + 0.5 * y[k + 1] + y[k + inward] + 0.5 * y[k - 1];
          see(2 * y[k] - sum - pull(k, number(k)));
        }
        see(y[end] - (load[end] + 0.5 * y[end + inward] + 0.5 * y[end - 1]) - pull(end, number(end)));
      } else {
        const left = load[row] + y[row + 1] + 0.5 * y[row + side] + 0.5 * y[row - side];
        see(2 * y[row] - left - pull(row, 4 * n - j));
        for (let k = row + 1; k < end; k++) {
          see(4 * y[k] - (load[k] + y[k + 1] + y[k + side] + y[k - side] + y[k - 1]));
        }
        const right = load[end] + 0.5 * y[end + side] + 0.5 * y[end - side] + y[end - 1];
        see(2 * y[end] - right - pull(end, n + j));
      }
    }
    return [signed, absolute];
  }

  // The linear interpolation of a nodal vector to the grid of half the width.
  function prolong(n, coarse, rule) {
    const side = 2 * n + 1, fine = new Float64Array(side * side);
    const at = (i, j) => coarse[j * (n + 1) + i];
    for (let j = 0; j <= n; j++) {
      for (let i = 0; i <= n; i++) {
        const k = 2 * j * side + 2 * i;
        fine[k] = at(i, j);
        if (i < n) fine[k + 1] = 0.5 * (at(i, j) + at(i + 1, j));
        if (j < n) fine[k + side] = 0.5 * (at(i, j) + at(i, j + 1));
        if (i < n && j < n) {
          const rising = at(i, j) + at(i + 1, j + 1), falling = at(i + 1, j) + at(i, j + 1);
          const centre = {
            "bilinear": 0.25 * (rising + falling),
            "rising-diagonal": 0.5 * rising,
            "falling-diagonal": 0.5 * falling,
          };
          fine[k + side + 1] = centre[rule];
        }
      }
    }
    return fine;
  }

  function prolongBoundary(coarse) {
    return Float64Array.from({ length: 2 * coarse.length }, (_, b) => {
      const k = b >> 1;
      return b % 2 === 0 ? coarse[k] : 0.5 * (coarse[k] + coarse[(k + 1) % coarse.length]);
    });
  }

  // One solve over nested grids, an iteration at a time. `levels` says where each grid stands.
  class Run {
    constructor(problem, grids, r, rule) {
      Object.assign(this, { problem, grids, r, rule, f: rightHandSide.parse(problem.f) });
      this.levels = [];
      // Iteration by iteration, over all grids: both residuals.
      this.history = { signed: [], absolute: [] };
      this.enter();
    }

    enter() {
      const n = this.grids[this.levels.length];
      if (this.levels.length === 0) {
        this.y = new Float64Array((n + 1) * (n + 1));
        this.a = new Float64Array(4 * n);
      } else {
        this.y = prolong(n / 2, this.y, this.problem.prolongation);
        this.a = prolongBoundary(this.a);
      }
      this.n = n;
      this.nodes = boundaryNodes(n);
      this.load = rightHandSide.load(n, this.f, this.problem.load, this.problem);
      this.level = { n, iterations: 0, tolerance: Number(`1e-${this.levels.length + 1}`) };
      this.level.sum = this.load.reduce((sum, part) => sum + part, 0);
      this.level.begin = this.history.signed.length;
      this.levels.push(this.level);
    }

    get done() {
      return Boolean(this.level.stop) &&
        (this.levels.length === this.grids.length || this.level.stop === "diverged");
    }

    // One iteration, on the next grid if the one before has met the rule.
    step() {
      if (this.done) return;
      if (this.level.stop) this.enter();
      const level = this.level, { n, load, r, y, a, rule } = this;
      sweep(n, load, r, y, a);
      const delta = dualStep(this.nodes, r, y, a);
      const [signed, absolute] = gradient(n, load, r, y, a);
      level.iterations += 1;
      Object.assign(level, { delta, signed, absolute });
      this.history.signed.push(signed);
      this.history.absolute.push(absolute);
      const residual = rule.startsWith("printed") ? absolute : signed;
      const settled = !rule.endsWith("dual") || delta <= level.tolerance;
      if (!Number.isFinite(delta + absolute)) level.stop = "diverged";
      else if (residual <= level.tolerance && settled) level.stop = "converged";
      else if (level.iterations === CAP) level.stop = "iteration-limit";
    }

    // The largest absolute value of y and of the forces h a.
    largest() {
      const of = (values) => values.reduce((most, v) => Math.max(most, Math.abs(v)), 0);
      return Math.max(of(this.y), (1 / this.n) * of(this.a));
    }

    // The size of rounding errors, as in src/mathematics/src/discrete/kkt.rs.
    rounding() {
      return this.n * Number.EPSILON * this.largest();
    }

    // Contact at the boundary nodes, where the force h a is positive or y is zero, up to rounding errors, as in
    // src/mathematics/src/saddle/mod.rs.
    contact() {
      const { n, nodes, y, a } = this, h = 1 / n, zero = this.rounding();
      return nodes.map((k, b) => h * a[b] > zero || Math.abs(y[k]) <= zero);
    }

    // The sum of the forces h a at the boundary nodes, which a solution has equal to minus the sum of the load.
    force() {
      return this.a.reduce((sum, value) => sum + value, 0) / this.n;
    }

    finish() {
      while (!this.done) this.step();
      return this;
    }
  }

  // Every cell of the published tables, computed here and now.
  function allCells({ problems, grids, r }) {
    return problems.map((problem) => {
      const runs = r.map((value) => new Run(problem, grids, value, "signed").finish());
      return {
        number: problem.number,
        counts: runs.map((run) => run.levels.map((level) => level.iterations)),
        delta_a: runs.map((run) => run.level.delta),
      };
    });
  }

  return { Run, allCells, boundaryNodes };
})();
