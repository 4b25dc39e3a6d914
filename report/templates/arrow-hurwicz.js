// The paper's iteration in JavaScript: the mathematics of the page explore.html, without the page.
//
// The same floating-point operations in the same order as src/saddle, so that counts, and the last
// bit of every number, are those of the tables. Served as it is written: no library, no build step.
"use strict";

const signorini = (() => {
  // A jump of f closer to a node than this counts as through it, as in src/source.rs.
  const STEP_OFF = 1e-9;
  // The page gives up after so many iterations on a grid: a reader will not wait for the run's cap.
  const CAP = 200000;

  // f in the notation of scenes, as a function of (x, y); the last region that holds a point wins.
  function parseSource(text) {
    const number = (t) => {
      if (t.trim() === "" || !Number.isFinite(Number(t))) throw new Error(`“${t.trim()}” is no number`);
      return Number(t);
    };
    const shapes = {
      rect: [4, ([x0, x1, y0, y1]) => (x, y) => x0 <= x && x <= x1 && y0 <= y && y <= y1],
      halfplane: [3, ([a, b, c]) => (x, y) => a * x + b * y <= c],
      disc: [3, ([cx, cy, radius]) => (x, y) =>
        (x - cx) * (x - cx) + (y - cy) * (y - cy) <= radius * radius],
    };
    const region = (item) => {
      const match = /^(\w+)\s*\(([^)]*)\)$/.exec(item);
      const quadrant = match && match[1] === "quadrant" && /^[lu][lr]$/.test(match[2].trim());
      if (quadrant) {
        const [upper, right] = [match[2].trim()[0] === "u", match[2].trim()[1] === "r"];
        return (x, y) => (right ? -x : x) <= 0 && (upper ? -y : y) <= 0;
      }
      const shape = match && shapes[match[1]];
      const args = match && match[2].split(",");
      if (!shape || args.length !== shape[0]) throw new Error(`cannot read “${item}”`);
      return shape[1](args.map(number));
    };
    const pieces = [];
    let background;
    for (const item of text.split(/[;\n]/).map((t) => t.trim()).filter((t) => t)) {
      const [left, value] = item.split("=");
      if (value === undefined) throw new Error(`“${item}” lacks “=value”`);
      if (left.trim() === "else") background = number(value);
      else pieces.unshift([region(left.trim()), number(value)]);
    }
    // Four quadrants may do without; a point that nothing covers is then on none of their borders.
    if (background === undefined && !/ll.*lr.*ul.*ur/.test(text)) {
      throw new Error("say what f is elsewhere: “else=value”");
    }
    return (x, y) => {
      const piece = pieces.find(([holds]) => holds(x, y));
      return piece ? piece[1] : background || 0;
    };
  }

  // The load vector (6) by the nodal rule; `tie` is the side from which f is taken on a jump.
  function loadVector(n, f, { load, tie, diagonal }) {
    if (load !== "nodal") throw new Error("this page knows the nodal load rule only");
    const h = 1 / n, values = new Float64Array((n + 1) * (n + 1));
    const [dy, dx] = tie.split("-").map((side) => (/lower|left/.test(side) ? -STEP_OFF : STEP_OFF));
    const moved = (t, d) => (Math.abs(t + d) <= 0.5 ? t + d : t - d);
    const corner = (i, j) => {
      if (diagonal === "") return 0.25;
      // A diagonal gives the corners it ends in two triangles, the others one.
      return (diagonal === "rising") === (i === j) ? 1 / 3 : 1 / 6;
    };
    for (let j = 0; j <= n; j++) {
      for (let i = 0; i <= n; i++) {
        const [onSide, onEnd] = [i === 0 || i === n, j === 0 || j === n];
        const weight = onSide && onEnd ? corner(i, j) : onSide || onEnd ? 0.5 : 1;
        const at = f(moved(i / n - 0.5, dx), moved(j / n - 0.5, dy));
        values[j * (n + 1) + i] = weight * h * h * at;
      }
    }
    return values;
  }

  // Nodes of the boundary, counter-clockwise from the lower left corner.
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
        relax(row, number(0), 1, 0.5 * (y[row + 1] + y[row + inward]) + load[row]);
        for (let k = row + 1; k < end; k++) {
          relax(k, number(k - row), 2, 0.5 * (y[k - 1] + y[k + 1]) + y[k + inward] + load[k]);
        }
        relax(end, number(n), 1, 0.5 * (y[end - 1] + y[end + inward]) + load[end]);
      } else {
        relax(row, 4 * n - j, 2, 0.5 * (y[row - side] + y[row + side]) + y[row + 1] + load[row]);
        for (let k = row + 1; k < end; k++) {
          y[k] = 0.25 * (((y[k - side] + y[k + side]) + (y[k + 1] + load[k])) + y[k - 1]);
        }
        relax(end, n + j, 2, 0.5 * (y[end - side] + y[end + side]) + y[end - 1] + load[end]);
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
        see(y[row] - 0.5 * (y[row + 1] + y[row + inward]) - load[row] - pull(row, number(row)));
        for (let k = row + 1; k < end; k++) {
          const along = 0.5 * (y[k - 1] + y[k + 1]);
          see(2 * y[k] - along - y[k + inward] - load[k] - pull(k, number(k)));
        }
        see(y[end] - 0.5 * (y[end - 1] + y[end + inward]) - load[end] - pull(end, number(end)));
      } else {
        const along = (k) => 0.5 * (y[k - side] + y[k + side]);
        see(2 * y[row] - along(row) - y[row + 1] - load[row] - pull(row, 4 * n - j));
        for (let k = row + 1; k < end; k++) {
          see(4 * y[k] - (y[k - side] + y[k + side]) - (y[k - 1] + y[k + 1]) - load[k]);
        }
        see(2 * y[end] - along(end) - y[end - 1] - load[end] - pull(end, n + j));
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
      Object.assign(this, { problem, grids, r, rule, f: parseSource(problem.f) });
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
      this.load = loadVector(n, this.f, this.problem);
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
