// Right-hand sides f in JavaScript: the notation of scenes, and the load vectors (6) made from it.
//
// Reads what src/mathematics/src/problem/source.rs reads, and refuses what it refuses, with the same words; the texts in
// tests/suite/grammar.txt hold both to that. Served as it is written: no library, no build step.
"use strict";

const rightHandSide = (() => {
  // The distance by which a sample steps off a jump of f, as in source.rs.
  const STEP_OFF = 1e-9;
  // The largest coordinate of a centre, and radius, as in src/mathematics/src/problem/shape.rs.
  const VAST = 1e3;
  // Sizes of f that the program computes with, as in shape.rs.
  const [LEAST, GREATEST] = [1e-130, 1e130];
  // What rounding may leave of an integral that is zero, as in src/replication/scene.rs.
  const ROUNDING = 1e-12;
  // Points of Gauss' rule between two ordinates at which a section of f has a kink.
  const POINTS = 12;
  // A right-hand side, for messages.
  const EXAMPLE = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1";

  // ---- Texts ------------------------------------------------------------------------------------

  // The white space that Rust trims, which is not quite what JavaScript trims.
  const trim = (text) => text.replace(/^\p{White_Space}+|\p{White_Space}+$/gu, "");

  function splitOnce(text, separator) {
    const at = text.indexOf(separator);
    return at < 0 ? undefined : [text.slice(0, at), text.slice(at + separator.length)];
  }

  function decimal(text) {
    const digits = trim(text);
    return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(digits) ? Number(digits) : NaN;
  }

  // Reads a finite number, or a fraction of two such as -1/3.
  function number(text) {
    const parts = splitOnce(text, "/") || [text, "1"], [above, below] = parts.map(decimal);
    if (Number.isFinite(above) && Number.isFinite(below) && Number.isFinite(above / below)) return above / below;
    const remedy = "give a decimal such as -1.5, or a fraction such as -1/3";
    throw new Error(`\`${trim(text)}\` in f is not a finite number; ${remedy}`);
  }

  // A number as the program writes it.
  const written = (value) => String(value).replace("e+", "e");

  function numbers(text, count, name, want, example) {
    const values = text.split(",").map(number);
    if (values.length !== count) throw new Error(`\`${name}\` takes ${want}, e.g. ${example}`);
    return values;
  }

  // A quarter of the plane: lower or upper, left or right.
  function quadrant(name) {
    const half = (negative) => (negative ? [-Infinity, 0] : [0, Infinity]);
    if (!["ll", "lr", "ul", "ur"].includes(name)) {
      throw new Error("`quadrant` takes one of ll, lr, ul, ur, e.g. quadrant(ll)");
    }
    return { kind: "rect", name, x: half(name[1] === "l"), y: half(name[0] === "l") };
  }

  // The region that a text names; undefined if it is not of the form name(arguments).
  function region(text) {
    const [name, rest] = splitOnce(text, "(") || [];
    if (rest === undefined || !rest.endsWith(")")) return undefined;
    const inner = rest.slice(0, -1);
    switch (trim(name)) {
      case "rect": {
        const [x0, x1, y0, y1] = numbers(inner, 4, "rect", "x0,x1,y0,y1", "rect(-0.25,0.25,-0.25,0.25)");
        return { kind: "rect", x: [x0, x1], y: [y0, y1] };
      }
      case "halfplane": {
        const [a, b, c] = numbers(inner, 3, "halfplane", "a,b,c of a x + b y <= c", "halfplane(1,1,0)");
        return { kind: "halfplane", a, b, c };
      }
      case "disc": {
        const [x, y, radius] = numbers(inner, 3, "disc", "x,y,radius", "disc(0,0,0.25)");
        return { kind: "disc", x, y, radius };
      }
      case "quadrant":
        return quadrant(trim(inner));
      default:
        return undefined;
    }
  }

  function isEmpty({ kind, x, y, a, b, radius }) {
    if (kind === "rect") return x[0] >= x[1] || y[0] >= y[1];
    return kind === "disc" ? radius <= 0 : a === 0 && b === 0;
  }

  // The half-plane with coefficients whose products with coordinates are normal numbers, as in shape.rs.
  function plain({ a, b, c }) {
    const largest = Math.max(Math.abs(a), Math.abs(b));
    const steps = largest < 1e-150 ? [2 ** 600, 2 ** 474] : largest > 1e150 ? [2 ** -450, 2 ** -450] : [1, 1];
    return [a, b, c].map((s) => s * steps[0] * steps[1]);
  }

  // f from its text: constant pieces in painting order over a background. The last that covers a point wins.
  function parse(text) {
    const whole = trim(text);
    if (whole.startsWith("exact(") && whole.endsWith(")")) {
      throw new Error("this page has no f of known solutions; signorini solve --f has");
    }
    if (whole.startsWith("formula(")) {
      throw new Error("this page has no f by a formula; signorini solve --f has");
    }
    const pieces = [];
    let background;
    for (const item of text.split(/[;\n]/).map(trim).filter((item) => item)) {
      const cannotRead = new Error(`cannot read \`${item}\` in f; write a constant as 'else=-1', an expression as ` +
        `'formula(3*x - 1)', and regions as '${EXAMPLE}'`);
      const sides = splitOnce(item, "=");
      if (!sides) throw cannotRead;
      const [left, value] = [trim(sides[0]), number(sides[1])];
      if (left === "else") {
        if (background !== undefined) throw cannotRead;
        background = value;
        continue;
      }
      const shape = region(left);
      if (!shape) throw cannotRead;
      if (isEmpty(shape)) {
        const remedy = "order its bounds, and give a size or a normal that is not zero";
        throw new Error(`\`${left}\` in f is no region; ${remedy}`);
      }
      if (shape.kind === "disc" && [shape.x, shape.y, shape.radius].some((s) => Math.abs(s) > VAST)) {
        const most = `the centre and the radius of what is round are at most ${VAST}`;
        throw new Error(`\`${left}\` in f: ${most}; write a straight border as a half-plane or half-space`);
      }
      pieces.push({ shape, value });
    }
    const covered = ["ll", "lr", "ul", "ur"].every((name) => pieces.some(({ shape }) => shape.name === name));
    if (background === undefined && !covered) {
      const missing = `\`${whole.replace(/\p{White_Space}+/gu, " ")}\` in f stands without \`else=value\``;
      throw new Error(`${missing} for where no piece is; write e.g. '${EXAMPLE}'`);
    }
    const source = { pieces, background: background || 0 };
    checkIntegral(source);
    return source;
  }

  // What the program asks of f: sizes that it computes with, and condition (2): a solution exists if the integral of f
  // is negative, by more than rounding.
  function checkIntegral(source) {
    const values = [source.background, ...source.pieces.map(({ value }) => value)];
    const largest = values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    if (largest > 0 && !(largest >= LEAST && largest < GREATEST)) throw outOfScale("the largest value of |f|", largest);
    const integral = ({ pieces, background }, change) => integrated(4, {
      pieces: pieces.map(({ shape, value }) => ({ shape, value: change(value) })),
      background: change(background),
    }, "bilinear").reduce((sum, part) => sum + part, 0);
    const [ofF, ofSize] = [integral(source, (v) => v), integral(source, Math.abs)];
    if (ofSize > 0 && !(ofSize >= LEAST && ofSize < GREATEST)) throw outOfScale("the integral of |f|", ofSize);
    if (ofF < -ROUNDING * ofSize) return;
    const shown = Math.abs(ofF) <= ROUNDING * ofSize ? "0" : shortened(ofF);
    throw new Error(`the integral of f is ${shown}, but the flux through the boundary can only balance a negative one; lower f somewhere`);
  }

  // Four digits, without an exponent from 1e-3 to 1e5.
  function shortened(number) {
    const scientific = number.toExponential(3);
    const exponent = Number(scientific.split("e")[1]);
    if (exponent < -3 || exponent > 4) return written(scientific);
    return number.toFixed(Math.max(3 - exponent, 0));
  }

  function outOfScale(what, size) {
    return new Error(`${what} is ${written(size)}, outside ${written(LEAST)} to ${written(GREATEST)}; scale f`);
  }

  // ---- Values -----------------------------------------------------------------------------------

  function contains(shape, x, y) {
    const { kind } = shape;
    if (kind === "rect") {
      return shape.x[0] <= x && x <= shape.x[1] && shape.y[0] <= y && y <= shape.y[1];
    }
    if (kind === "halfplane") {
      const [a, b, c] = plain(shape);
      return a * x + b * y <= c;
    }
    const [dx, dy] = [x - shape.x, y - shape.y];
    return dx * dx + dy * dy <= shape.radius * shape.radius;
  }

  function at({ pieces, background }, x, y) {
    for (let k = pieces.length - 1; k >= 0; k--) {
      if (contains(pieces[k].shape, x, y)) return pieces[k].value;
    }
    return background;
  }

  // ---- Load vectors -----------------------------------------------------------------------------

  // True if a node belongs to a half-plane or disc: on the border, if the step with these signs leads into it; where
  // the step is along the border, if its horizontal part does. As in src/mathematics/src/problem/side.rs.
  function tied(shape, node, signs) {
    let gradient, value;
    if (shape.kind === "halfplane") {
      const [a, b, c] = plain(shape);
      [gradient, value] = [[a, b], a * node[0] + b * node[1] - c];
    } else {
      const [x, y] = [node[0] - shape.x, node[1] - shape.y];
      [gradient, value] = [[x, y], 0.5 * (x * x + y * y - shape.radius * shape.radius)];
    }
    const size = Math.abs(gradient[0]) + Math.abs(gradient[1]);
    if (Math.abs(value) > STEP_OFF * size) return value < 0;
    const steps = [0, 1].map((axis) => gradient[axis] * signs[axis]), both = steps[0] + steps[1];
    const change = Math.abs(both) > 1e-9 * size ? both : steps[0];
    const isInside = [0, 1].some((axis) => [-1, 1].some((step) => {
      return node[axis] * step < 0.5 && gradient[axis] * step * change > 0;
    }));
    return isInside === change < 0;
  }

  // f at the nodes times the integrals of the hats; `tie` is the side from which f is taken on a jump.
  function nodal(n, source, { tie, diagonal }) {
    const h = 1 / n, values = new Float64Array((n + 1) * (n + 1));
    const [dy, dx] = tie.split("-").map((side) => (/lower|left/.test(side) ? -STEP_OFF : STEP_OFF));
    const moved = (t, d) => (Math.abs(t + d) <= 0.5 ? t + d : t - d);
    const signs = [Math.sign(dx), Math.sign(dy)];
    const painted = ({ background, pieces }, x, y) => {
      for (let k = pieces.length - 1; k >= 0; k--) {
        const { shape, value } = pieces[k];
        const held = shape.kind === "rect" ? contains(shape, moved(x, dx), moved(y, dy)) : tied(shape, [x, y], signs);
        if (held) return value;
      }
      return background;
    };
    const corner = (i, j) => {
      if (diagonal === "") return 0.25;
      // A diagonal gives the corners it ends in two triangles, the others one.
      return (diagonal === "rising") === (i === j) ? 1 / 3 : 1 / 6;
    };
    for (let j = 0; j <= n; j++) {
      for (let i = 0; i <= n; i++) {
        const [onSide, onEnd] = [i === 0 || i === n, j === 0 || j === n];
        const weight = onSide && onEnd ? corner(i, j) : onSide || onEnd ? 0.5 : 1;
        const f = painted(source, i / n - 0.5, j / n - 0.5);
        values[j * (n + 1) + i] = weight * h * h * f;
      }
    }
    return values;
  }

  // The lines and circles that bound a region.
  function borders(shape) {
    const { kind, x, y, radius } = shape;
    if (kind === "disc") return [{ x, y, radius }];
    if (kind === "halfplane") {
      const [a, b, c] = plain(shape);
      return [{ a, b, c }];
    }
    const sides = [...x.map((c) => ({ a: 1, b: 0, c })), ...y.map((c) => ({ a: 0, b: 1, c }))];
    return sides.filter(({ c }) => Number.isFinite(c));
  }

  // The ordinates at which two lines or circles cross.
  function crossings(p, q) {
    if (p.radius && q.radius) {
      const [a, b] = [2 * (q.x - p.x), 2 * (q.y - p.y)];
      const power = ({ x, y, radius }) => x * x + y * y - radius * radius;
      return a === 0 && b === 0 ? [] : crossings({ a, b, c: power(q) - power(p) }, p);
    }
    if (p.radius) return crossings(q, p);
    if (q.radius) {
      const norm = Math.hypot(p.a, p.b), [a, b] = [p.a / norm, p.b / norm];
      const away = p.c / norm - a * q.x - b * q.y;
      const half = Math.sqrt(q.radius * q.radius - away * away);
      return [q.y + away * b - half * a, q.y + away * b + half * a];
    }
    return [(p.a * q.c - q.a * p.c) / (p.a * q.b - q.a * p.b)];
  }

  // Ordinates halving their distance to the lowest and highest point of a circle, where sections have roots:
  // an interval between two others is then no longer than its distance to the root.
  function towardPoles({ y, radius }) {
    const distances = Array.from({ length: 44 }, (_, k) => radius * (1 - (k < 43 ? 2 ** -k : 0)));
    return distances.flatMap((distance) => [y - distance, y + distance]);
  }

  // The ordinates between which integrals over rows of cells are smooth, but for roots at their ends:
  // those of grid lines, of borders, and of all places where a border crosses a border, a grid line or a diagonal.
  function ordinates(n, pieces) {
    const h = 1 / n, found = [];
    const lines = [];
    for (let k = 0; k <= n; k++) lines.push({ a: 1, b: 0, c: k * h - 0.5 });
    for (let k = 1 - n; k < n; k++) lines.push({ a: 1, b: -1, c: k * h });
    const curves = pieces.flatMap(({ shape }) => borders(shape));
    curves.forEach((curve, k) => {
      if (curve.radius) found.push(...towardPoles(curve));
      else if (curve.a === 0) found.push(curve.c / curve.b);
      for (const other of [...lines, ...curves.slice(0, k)]) found.push(...crossings(other, curve));
    });
    for (let k = 0; k <= n; k++) found.push(k * h - 0.5);
    return Float64Array.from(found.filter((y) => Math.abs(y) <= 0.5)).sort();
  }

  // Points and weights of Gauss' rule on [0, 1], under y = 3 s^2 - 2 s^3, which makes roots at both ends smooth.
  const GAUSS = Array.from({ length: POINTS }, (_, k) => {
    let x = Math.cos((Math.PI * (k + 0.75)) / (POINTS + 0.5)), slope = 1;
    for (let newton = 0; newton < 8; newton++) {
      let [before, value] = [1, x];
      for (let m = 2; m <= POINTS; m++) {
        [before, value] = [value, ((2 * m - 1) * x * value - (m - 1) * before) / m];
      }
      slope = (POINTS * (x * value - before)) / (x * x - 1);
      x -= value / slope;
    }
    const s = 0.5 * (1 + x), weight = 1 / ((1 - x * x) * slope * slope);
    return { at: s * s * (3 - 2 * s), weight: weight * 6 * s * (1 - s) };
  });

  // Least and greatest x of a region at an ordinate; undefined if it is not there.
  function section(shape, y) {
    if (shape.kind === "rect") {
      return shape.y[0] <= y && y <= shape.y[1] ? shape.x : undefined;
    }
    if (shape.kind === "disc") {
      const away = Math.abs(y - shape.y);
      const half = Math.sqrt((shape.radius - away) * (shape.radius + away));
      return away <= shape.radius ? [shape.x - half, shape.x + half] : undefined;
    }
    const [a, b, c] = plain(shape), room = c - b * y;
    if (a === 0) return room >= 0 ? [-Infinity, Infinity] : undefined;
    return a > 0 ? [-Infinity, room / a] : [room / a, Infinity];
  }

  // The integrals of f times hats, to rounding: "exact" has those that are linear on triangles, cut by rising
  // diagonals, "bilinear" those that are bilinear on squares. Exact along x, by Gauss' rule along y.
  function integrated(n, source, rule) {
    const h = 1 / n, side = n + 1, values = new Float64Array(side * side);
    // One piece of a row of cells, from a to b in the unit of the cell, at height t in it.
    const add = (k, a, b, t, f) => {
      const m0 = f * (b - a), m1 = 0.5 * f * (b - a) * (b + a);
      if (rule === "bilinear") {
        values[k] += (1 - t) * (m0 - m1);
        values[k + 1] += (1 - t) * m1;
        values[k + side] += t * (m0 - m1);
        values[k + side + 1] += t * m1;
      } else if (a + b < 2 * t) {
        values[k] += (1 - t) * m0;
        values[k + side] += t * m0 - m1;
        values[k + side + 1] += m1;
      } else {
        values[k] += m0 - m1;
        values[k + 1] += m1 - t * m0;
        values[k + side + 1] += t * m0;
      }
    };
    const { pieces, background } = source;
    const row = (y, j, t, weight) => {
      const sections = pieces.map(({ shape }) => section(shape, y));
      const inside = sections.flat().filter((x) => x !== undefined && Math.abs(x) < 0.5);
      const cuts = [-0.5, ...inside, 0.5].sort((a, b) => a - b);
      for (let k = 1; k < cuts.length; k++) {
        const [from, to] = [cuts[k - 1], cuts[k]], middle = 0.5 * (from + to);
        let last = pieces.length - 1;
        while (last >= 0 && !(sections[last] && sections[last][0] <= middle && middle <= sections[last][1])) last -= 1;
        const f = weight * h * (last < 0 ? background : pieces[last].value);
        for (let i = Math.floor((from + 0.5) * n); i < n && i / n - 0.5 < to; i++) {
          const a = Math.max(0, (from + 0.5) * n - i), b = Math.min(1, (to + 0.5) * n - i);
          const split = rule === "exact" ? Math.min(Math.max(t, a), b) : b;
          if (split > a) add(j * side + i, a, split, t, f);
          if (b > split) add(j * side + i, split, b, t, f);
        }
      }
    };
    const ys = ordinates(n, pieces);
    for (let k = 1; k < ys.length; k++) {
      const [from, length] = [ys[k - 1], ys[k] - ys[k - 1]];
      if (length === 0) continue;
      const j = Math.min(n - 1, Math.floor((from + 0.5 * length + 0.5) * n));
      for (const { at: s, weight } of GAUSS) {
        const y = from + length * s;
        row(y, j, (y + 0.5) * n - j, length * weight);
      }
    }
    return values;
  }

  // The load vector of f on the grid 1/n; `rule` is "nodal", "exact" or "bilinear".
  function load(n, source, rule, choices) {
    return rule === "nodal" ? nodal(n, source, choices) : integrated(n, source, rule);
  }

  return { parse, load };
})();
