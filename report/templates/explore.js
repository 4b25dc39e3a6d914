// The page with the live iteration: controls, pictures, counters. The method is in arrow-hurwicz.js, f in
// right-hand-side.js.
//
// Problems and published numbers are data of the run that built the book, in `.explore-data`.
// Colours are CSS variables, so that the pictures follow the reader's theme.
"use strict";

(() => {
  const root = document.querySelector(".explore");
  const data = JSON.parse(document.querySelector(".explore-data").textContent);
  const find = (selector) => root.querySelector(selector);
  const form = find("form");
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  // Milliseconds of computing between two pictures: enough for speed, short enough to stay responsive.
  const SLICE = 12;

  let run; // the solve that is shown
  let target; // what it runs to: "play", "grid", "end", or nothing
  let frame; // the next picture that the browser is asked for
  let owed = 0; // iterations that playing is behind, with their fraction
  let before = 0; // time of the last picture
  let spent = 0; // milliseconds of iterating since the start
  let azimuth = -37.5; // degrees by which the viewer has walked around the surface

  // ---- What is asked ----------------------------------------------------------------------------

  function asked() {
    const of = data.problems.find((problem) => String(problem.number) === form.problem.value);
    const custom = { ...data.defaults, number: 0, f: form.f.value, table: [], truth: undefined };
    const problem = { ...(of || custom), load: form.load.value };
    const grids = data.grids.filter((n) => n <= Number(form.finest.value));
    const r = Number(form.r.value);
    if (!(r >= 1e-3 && r <= 1e9)) throw wrong(form.r, "r must be a number from 0.001 to 1000000000");
    try {
      return new signorini.Run(problem, grids, r, form.rule.value);
    } catch (error) {
      throw wrong(form.f, error.message);
    }
  }

  // An error that a field of the form is to blame for.
  function wrong(field, message) {
    return Object.assign(new Error(message), { field });
  }

  // The paper's problems come with the load and the rule of its tables, an own f with those of `signorini solve`.
  function choicesOfProblem() {
    const of = data.problems.find((problem) => String(problem.number) === form.problem.value);
    form.load.value = (of || data.defaults).load;
    form.rule.value = of ? "signed" : data.defaults.rule;
  }

  // The address that asks for what the controls say: to come back to, or to send to others.
  function writeAddress() {
    const query = new URLSearchParams(location.search);
    for (const name of ["problem", "f", "r", "load", "rule", "finest"]) query.set(name, form[name].value);
    if (form.problem.value !== "own") query.delete("f");
    query.set("truth", Number(form.truth.checked));
    find(".explore-unknown").hidden = true;
    window.history.replaceState(window.history.state, "", `?${query}${location.hash}`);
  }

  // A link says what to show, not after a #, which the page for printing keeps for places of its own:
  // tables.html?problem=2&r=1&load=exact&rule=printed&finest=32. What a control does not offer changes nothing, and is
  // named.
  function readAddress() {
    const query = new URLSearchParams(location.search);
    if (query.has("f")) form.problem.value = "own";
    const unknown = [];
    for (const name of ["problem", "load", "rule", "finest"]) {
      const wanted = query.get(name);
      const controls = name === "problem" ? form.problem : form[name].options;
      if (wanted !== null && [...controls].some((control) => control.value === wanted)) form[name].value = wanted;
      else if (wanted !== null) unknown.push(`${name}=${wanted}`);
      if (name === "problem") choicesOfProblem();
    }
    form.truth.checked = query.get("truth") !== "0";
    for (const name of ["f", "r"]) if (query.has(name)) form[name].value = query.get(name);
    const said = find(".explore-unknown");
    said.hidden = unknown.length === 0;
    said.textContent = `The address asks for ${unknown.join(", ")}, which this page does not have; ` +
      "the controls say what is shown.";
  }

  // The command that makes the same iterations.
  function command() {
    const { problem, grids, r, rule } = run;
    return `signorini solve --f '${problem.f.trim()}' --h 1/${grids[grids.length - 1]} ` +
      `--solver arrow-hurwicz --load ${problem.load} --r ${r} --stop ${rule}`;
  }

  // Starts over with what the form says; returns whether that can be solved.
  function restart() {
    form.f.parentElement.hidden = form.problem.value !== "own";
    for (const button of root.querySelectorAll("[data-r]")) {
      button.setAttribute("aria-pressed", Number(button.dataset.r) === Number(form.r.value));
    }
    target = undefined;
    spent = 0;
    find(".explore-announced").textContent = "";
    for (const field of [form.f, form.r]) field.removeAttribute("aria-invalid");
    try {
      run = asked();
      find(".explore-command").textContent = command();
    } catch (error) {
      run = undefined;
      find(".explore-status").textContent = `${error.message}.`;
      find(".explore-command").textContent = "";
      announce();
      error.field.setAttribute("aria-invalid", "true");
    }
    for (const part of root.querySelectorAll(".explore-transport [data-do], .explore-shown")) {
      part.toggleAttribute("inert", !run);
    }
    form.truth.disabled = !run || !run.problem.truth;
    return Boolean(run);
  }

  // Iterates while `more` says so; the time goes on the clock.
  function iterate(more) {
    const began = performance.now();
    do run.step(); while (more());
    spent += performance.now() - began;
  }

  // A changed problem is shown solved, from its best side; playing starts it over.
  function changed() {
    if (restart()) go("end");
  }

  const actions = {
    play() {
      if (target === "play") return pause();
      if (run.done) restart();
      go("play");
    },
    step() {
      target = undefined;
      if (run.done) restart();
      iterate(() => false);
      show();
    },
    grid() {
      if (run.done) restart();
      go("grid");
    },
    end: () => go("end"),
    restart() {
      restart();
      show();
    },
    all,
  };

  function pause() {
    target = undefined;
    show();
  }

  function go(where) {
    target = where;
    owed = 1;
    before = performance.now();
    find(".explore-announced").textContent = "";
    cancelAnimationFrame(frame);
    advance(before);
  }

  // Computes for a slice of time, draws, and comes back with the next picture.
  function advance(now) {
    if (!target || !run) return;
    const until = performance.now() + SLICE;
    const playing = target === "play" && !calm.matches;
    if (playing) owed += (Math.max(now - before, 0) / 1000) * 2 ** Number(form.speed.value);
    before = now;
    if (!playing || owed >= 1) {
      iterate(() => {
        owed -= 1;
        // Without motion, playing goes from grid to grid.
        if (run.level.stop && (target === "grid" || (target === "play" && calm.matches))) {
          target = undefined;
        }
        const due = !playing || owed >= 1;
        return target && due && !run.done && performance.now() < until;
      });
    }
    owed = Math.min(owed, 1);
    if (run.done) {
      if (target === "end") azimuth = uphill();
      target = undefined;
    }
    if (!target || !calm.matches) show();
    if (target) frame = requestAnimationFrame(advance);
  }

  function all() {
    const began = performance.now();
    const tables = signorini.allCells(data);
    const milliseconds = Math.max(1, Math.round(performance.now() - began));
    let exact = 0, cells = 0;
    for (const table of tables) {
      const published = data.problems.find((problem) => problem.number === table.number).table;
      table.counts.forEach((row, k) => row.forEach((count, level) => {
        cells += 1;
        exact += Number(count === published[k].counts[level]);
      }));
    }
    const out = find(".explore-all");
    out.textContent = `${exact} of ${cells} counts as published; all tables took ${milliseconds} ms here.`;
    // Numbers as text keep all their digits, whoever reads them.
    out.dataset.tables = JSON.stringify(tables, (_, v) => (typeof v === "number" ? String(v) : v));
  }

  // ---- Counters ---------------------------------------------------------------------------------

  // Two digits and a power of ten, as the tables print them.
  function sci(x) {
    if (x === undefined) return "–";
    if (x === 0 || !Number.isFinite(x)) return String(x);
    const [mantissa, exponent] = x.toExponential(1).replace("-", "−").split("e");
    const raised = [...String(Number(exponent.replace("−", "-")))]
      .map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
    return raised === "⁰" ? mantissa : `${mantissa}·10${raised}`;
  }

  const times = (iterations) => `${iterations} iteration${iterations === 1 ? "" : "s"}`;

  const published = () => run.problem.table.find((row) => row.r === run.r);

  function counters() {
    const row = published();
    const cells = run.grids.map((n, k) => {
      const level = run.levels[k], paper = row && row.counts[k];
      const exact = level && level.stop && level.iterations === paper;
      const current = level === run.level && !run.done ? ' aria-current="step"' : "";
      return {
        head: `<th scope="col"${current}>1/${n}</th>`,
        ours: `<td class="${exact ? "is-exact" : ""}">${level ? level.iterations : ""}</td>`,
        paper: `<td>${row ? paper : "–"}</td>`,
      };
    });
    const line = (key) => cells.map((cell) => cell[key]).join("");
    find(".explore-counts").innerHTML =
      `<thead><tr><th scope="row"><i>h</i></th>${line("head")}</tr></thead>` +
      `<tbody><tr><th scope="row">iterations</th>${line("ours")}</tr>` +
      `<tr><th scope="row">published</th>${line("paper")}</tr></tbody>`;
    const level = run.level;
    for (const key of ["signed", "absolute", "delta", "tolerance"]) {
      find(`[data-value="${key}"]`).textContent = sci(level[key]);
    }
    find('[data-value="spent"]').textContent = `${spent.toFixed(spent < 10 ? 1 : 0)} ms`;
    find('[data-value="force"]').textContent = sci(run.force());
    find('[data-value="balance"]').textContent = sci(-level.sum);
    find(".explore-status").textContent = status(row);
    if (!target) announce();
    find('[data-do="play"]').textContent = target === "play" ? "Pause" : "Play";
  }

  // Repeats the status to screen readers: when the iteration stops or is stopped, not while it runs.
  function announce() {
    const said = find(".explore-announced"), now = find(".explore-status").textContent;
    if (said.textContent !== now) said.textContent = now;
  }

  function status(row) {
    const { n, iterations, stop, delta } = run.level;
    const insoluble = run.levels.filter((level) => level.sum >= 0).map((level) => `1/${level.n}`);
    const warning = insoluble.length === 0 ? "" :
      ` With f at the nodes, the load sums to a non-negative number on ${insoluble.join(", ")}: ` +
      "there the discrete problem has no solution, although the problem itself has one.";
    if (stop === "diverged") return `Diverged on the grid 1/${n}.${warning}`;
    const over = stop === "iteration-limit" ? `The rule is not met on 1/${n} within ` : "";
    if (over) return `${over}${times(iterations)}.${warning}`;
    if (!stop) return `Grid 1/${n}, iteration ${iterations}.${warning}`;
    if (!run.done) return `The rule is met on 1/${n} after ${times(iterations)}.${warning}`;
    if (!row) return `Done: ${times(iterations)} on 1/${n}, Δa = ${sci(delta)}.${warning}`;
    const same = run.levels.filter((level, k) => level.iterations === row.counts[k]).length;
    const paper = n === data.grids[data.grids.length - 1] ? `, published ${sci(row.delta_a)}` : "";
    const whose = run.problem.load === "nodal" ? "" : " (which are for f at the nodes)";
    return `Done: ${same} of ${run.levels.length} counts as published${whose}; ` +
      `Δa = ${sci(delta)}${paper}.${warning}`;
  }

  // ---- Pictures ---------------------------------------------------------------------------------

  function show() {
    if (!run) return;
    counters();
    surface();
    history();
    boundary();
  }

  // The least interval with zero and the values; if these are rounding errors, one as long as the solution is large.
  const span = (values) => {
    let low = 0, high = 0;
    for (const v of values) if (Number.isFinite(v)) [low, high] = [Math.min(low, v), Math.max(high, v)];
    return high - low > run.rounding() ? [low, high] : [low, low + (run.largest() || 1)];
  };

  // Round numbers in [low, high], about `count` of them.
  function ticks(low, high, count) {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const first = Math.ceil(low / step - 1e-9), long = digits > 3 || Math.max(-low, high) >= 1e5;
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => {
      const value = (first + k) * step;
      const label = long ? sci(value).replace(".0", "") : value.toFixed(digits).replace("-", "−");
      return [value, first + k === 0 ? "0" : label];
    });
  }

  const VIRIDIS = [
    0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151,
    0xbddf26, 0xfde725,
  ];

  function viridis(t, light) {
    const place = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1);
    const k = Math.min(Math.floor(place), VIRIDIS.length - 2), s = place - k;
    const channel = (shift) => {
      const [low, high] = [VIRIDIS[k], VIRIDIS[k + 1]].map((c) => (c >> shift) & 255);
      return Math.min(255, Math.round((low + s * (high - low)) * light));
    };
    return `rgb(${channel(16)},${channel(8)},${channel(0)})`;
  }

  // The true solution, if it is known and switched on.
  const shownTruth = () => (form.truth.checked ? run.problem.truth : undefined);

  // The view from above the corner that looks most uphill, as Figure 2 is drawn.
  function uphill() {
    const n = run.n, at = (i, j) => run.y[j * (n + 1) + i];
    const rises = [[0, 0], [n, 0], [n, n], [0, n]].map(([i, j]) => at(n - i, n - j) - at(i, j));
    return -37.5 + 90 * rises.indexOf(Math.max(...rises));
  }

  // The solution as a shaded surface in parallel projection, painted from the far corner to the near.
  function surface() {
    const canvas = find("canvas"), style = getComputedStyle(canvas);
    const width = canvas.clientWidth, height = canvas.clientHeight, ratio = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const [sinA, cosA] = [Math.sin, Math.cos].map((f) => f((azimuth * Math.PI) / 180));
    const [sinE, cosE] = [0.5, Math.sqrt(0.75)]; // seen from 30 degrees above the horizon
    const right = [cosA, sinA, 0], up = [-sinA * sinE, cosA * sinE, cosE];
    const toward = [sinA * cosE, -cosA * cosE, sinE];
    const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    const truth = shownTruth();
    const [low, high] = span(truth ? [...run.y, ...truth.v] : run.y), floor = low - 0.16 * (high - low);
    const unit = Math.min((width - 96) / 1.44, height / 1.44); // with room for labels on both sides
    const point = (x, y, v) => [x, y, 0.66 * ((v - floor) / (high - floor) - 0.5)];
    const place = (p) => [0.5 * width + 11 + unit * dot(p, right), 0.505 * height - unit * dot(p, up)];
    const trace = (points) => {
      pen.beginPath();
      points.forEach((p) => pen.lineTo(...place(p)));
    };
    const stroke = (points, color, thick) => {
      trace(points);
      [pen.strokeStyle, pen.lineWidth, pen.lineCap] = [color, thick, "round"];
      pen.stroke();
    };
    const [fx, fy] = [toward[0] < 0 ? 0.5 : -0.5, toward[1] < 0 ? 0.5 : -0.5]; // the far corner
    const rule = style.getPropertyValue("--explore-rule"), ink = style.color;
    trace([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([x, y]) => point(x, y, floor)));
    pen.fillStyle = style.getPropertyValue("--explore-shade");
    pen.fill();
    // The wall to the left carries the scale of v.
    const left = dot([fx, -fy, 0], right) < dot([-fx, fy, 0], right) ? [fx, -fy] : [-fx, fy];
    const write = (content, [x, y], align, slope = "") => {
      [pen.font, pen.fillStyle, pen.textBaseline, pen.textAlign] = [`${slope} ${style.font}`, ink, "middle", align];
      pen.fillText(content, x, y);
    };
    for (const [v, label] of ticks(low, high, 4)) {
      stroke([point(-fx, fy, v), point(fx, fy, v), point(fx, -fy, v)], rule, v === 0 ? 1.5 : 0.75);
      const [x, y] = place(point(...left, v));
      write(label, [x - 6, y], "right");
    }
    for (const [x, y] of [[-fx, fy], [fx, fy], [fx, -fy]]) {
      stroke([point(x, y, floor), point(x, y, high)], rule, 1);
    }

    // Finer grids are thinned: the eye gains nothing, and drawing must keep up with the iteration.
    const n = run.n, each = Math.max(1, n / 32), count = n / each;
    const node = (i, j) => point(i / count - 0.5, j / count - 0.5, run.y[(j * (n + 1) + i) * each]);
    const value = (i, j) => run.y[(j * (n + 1) + i) * each];
    const touched = run.contact(), contact = new Set(run.nodes.filter((_, b) => touched[b]));
    const touches = ([i, j]) => contact.has((j * (n + 1) + i) * each);
    const mark = (p, q) => {
      if (!touches(p) || !touches(q)) return;
      stroke([node(...p), node(...q)], style.getPropertyValue("--explore-contact"), 2.75);
    };
    const lamp = [0, 1, 2].map((d) => toward[d] + 0.9 * up[d] - 0.8 * right[d]);
    const walk = (k, ascending) => (ascending ? k : count - 1 - k);
    const near = [];
    for (let q = 0; q < count; q++) {
      for (let p = 0; p < count; p++) {
        const i = walk(p, fx < 0), j = walk(q, fy < 0);
        const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        const [s, t, u, w] = corners.map((c) => node(...c));
        const [d, e] = [[u, s], [w, t]].map(([b, a]) => [b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
        const normal =
          [d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]];
        const cosine = dot(normal, lamp) / Math.sqrt(dot(normal, normal) * dot(lamp, lamp));
        const light = (dot(normal, toward) < 0 ? 0.8 : 1) * (0.62 + 0.44 * Math.abs(cosine));
        const mean = corners.reduce((sum, c) => sum + value(...c), 0) / 4;
        trace([s, t, u, w, s]);
        pen.fillStyle = viridis((mean - low) / (high - low), light);
        pen.fill();
        // A thin mesh in the same ink on every theme; it also closes the seams between cells.
        [pen.strokeStyle, pen.lineWidth] = ["rgba(20, 32, 38, 0.55)", 0.5];
        pen.stroke();
        // Contact on the far sides goes in here, where nearer cells can still hide it.
        corners.forEach((c, k) => {
          const to = corners[(k + 1) % 4], axis = c[0] === to[0] ? 0 : 1;
          if (c[axis] !== 0 && c[axis] !== count) return;
          const far = c[axis] / count - 0.5 === [fx, fy][axis];
          if (far) mark(c, to);
          else near.push([c, to]);
        });
      }
    }
    near.forEach(([from, to]) => mark(from, to));
    // The true solution as a net over it: every fourth line.
    const m = truth ? truth.cells : -1;
    const knot = (i, j) => point(i / m - 0.5, j / m - 0.5, truth.v[j * (m + 1) + i]);
    for (let k = 0; k <= m; k += 4) {
      const along = Array.from({ length: m + 1 }, (_, i) => i);
      for (const points of [along.map((i) => knot(i, k)), along.map((j) => knot(k, j))]) {
        stroke(points, style.getPropertyValue("--explore-second"), 1.5);
      }
    }
    // Along the near sides of the floor the scales of x and y, at the top of the wall the name of the height.
    const sides = [["x", (t, d) => point(t, -fy * d, floor)], ["y", (t, d) => point(-fx * d, t, floor)]];
    for (const [name, beside] of sides) {
      const [inner, outer] = [1, 1.06].map((d) => place(beside(0, d)));
      const [dx, dy] = [outer[0] - inner[0], outer[1] - inner[1]];
      const below = Math.abs(dx) < Math.abs(dy), align = below ? "center" : dx > 0 ? "left" : "right";
      const label = (t, content, slope) => {
        const [x, y] = place(beside(t, 1.06));
        write(content, below ? [x, y + 10] : [x + 4 * Math.sign(dx), y], align, slope);
      };
      for (const [t, content] of [[-0.5, "−0.5"], [0, "0"], [0.5, "0.5"]]) {
        stroke([beside(t, 1), beside(t, 1.06)], ink, 1);
        label(t, content);
      }
      label(0.25, name, "italic");
    }
    const [topX, topY] = place(point(...left, high));
    write("v", [topX, topY - 12], "center", "italic");
  }

  // A drawing surface of the width that the page gives it, with text of one size on any screen.
  function chart(name, height, draw) {
    const svg = find(`svg[data-chart="${name}"]`), width = svg.clientWidth;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.setAttribute("height", height);
    svg.innerHTML = draw(width);
  }

  const line = (x0, y0, x1, y1, kind) =>
    `<line class="${kind}" x1="${x0}" y1="${y0}" x2="${x1}" y2="${y1}"/>`;
  const text = (x, y, content, anchor = "middle", kind = "") =>
    `<text class="${kind}" x="${x}" y="${y}" text-anchor="${anchor}">${content}</text>`;
  const path = (points, kind) =>
    `<path class="${kind}" d="M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}"/>`;

  function history() {
    chart("history", 318, (width) => {
      const [left, top, bottom] = [48, 48, 284], end = width - 48;
      const { signed, absolute } = run.history, levels = run.levels;
      const row = published();
      const expected = row ? run.grids.reduce((sum, _, k) => sum + row.counts[k], 0) : 0;
      const most = Math.max(signed.length, expected, 8) * 1.02;
      // A decade below the finest tolerance, where all that is smaller or negative is drawn, up to the largest value.
      const largest = absolute.reduce((top, v) => (Number.isFinite(v) ? Math.max(top, v) : top), 1);
      const lowest = -run.grids.length - 1, highest = Math.ceil(Math.log10(largest));
      const across = (k) => left + (end - left) * (k / most);
      const down = (v) => {
        const power = v > 0 ? Math.min(Math.max(Math.log10(v), lowest), highest) : lowest;
        return bottom - (bottom - top) * ((power - lowest) / (highest - lowest));
      };
      let out = "";
      const every = Math.ceil((highest - lowest) / 12);
      for (let power = lowest; power <= highest; power++) {
        const y = down(10 ** power), name = power === 0 ? "1" : sci(10 ** power).slice(4);
        if ((power - lowest) % every === 0) {
          const label = power === lowest ? `≤${name}` : name;
          out += line(left, y, end, y, "rule") + text(left - 6, y + 4, label, "end");
        }
        const n = run.grids[-power - 1];
        if (n && every === 1) out += text(end + 6, y + 4, `1/${n}`, "start", "muted");
      }
      for (const [k, label] of ticks(0, most, Math.max(3, Math.floor(width / 80)))) {
        out += line(across(k), bottom, across(k), bottom + 4, "axis");
        out += text(across(k), bottom + 16, label);
      }
      out += text((left + end) / 2, bottom + 31, "iterations, all grids");
      // Long histories are thinned to a point per pixel.
      const stride = Math.ceil(signed.length / 1000);
      for (const [values, kind] of [[absolute, "second dashed"], [signed, "first"]]) {
        const points = [];
        values.forEach((v, k) => {
          if (k % stride === 0 || k === values.length - 1) points.push([across(k + 1), down(v)]);
        });
        if (points.length > 0) out += path(points, kind);
      }
      const watched = run.rule.startsWith("printed") ? absolute : signed;
      for (const level of levels) {
        const last = level.begin + level.iterations, y = down(level.tolerance);
        out += line(across(level.begin), y, across(last), y, "bound");
        if (level.stop === "converged") {
          const kind = watched === signed ? "first" : "second";
          out += `<circle class="${kind}" cx="${across(last)}" cy="${down(watched[last - 1])}" r="4"/>`;
        }
      }
      out += line(left, bottom, end, bottom, "axis") + line(left, top, left, bottom, "axis");
      const key = (x, y, kind, name) => {
        out += line(x, y, x + 22, y, kind) + text(x + 28, y + 4, name, "start");
      };
      const keys = Math.min(left, width - 270);
      key(keys, 10, "first", "largest component of the gradient");
      key(keys, 28, "second dashed", "largest absolute value");
      key(keys + 178, 28, "bound", "tolerance");
      return out;
    });
  }

  function boundary() {
    chart("boundary", 326, (width) => {
      const left = 72, end = width - 14, across = (s) => left + (end - left) * (s / 4);
      const { n, nodes, a, y } = run, touched = run.contact();
      let out = "";
      const panel = (top, bottom, name, kind, values, known) => {
        const [low, high] = span([...values, ...known]), pad = 0.08 * (high - low);
        const down = (v) => bottom - ((v - low + pad) / (high - low + 2 * pad)) * (bottom - top);
        for (const [v, label] of ticks(low, high, 3)) {
          out += line(left, down(v), end, down(v), "rule") + text(left - 6, down(v) + 4, label, "end");
        }
        [1, 2, 3].forEach((s) => { out += line(across(s), top, across(s), bottom, "rule"); });
        // Closed: the corner where it ends is the one where it began.
        const along = (all) => [...all, all[0]].map((v, b) => [across((4 * b) / all.length), down(v)]);
        if (known.length > 0) out += path(along(known), "known dashed");
        out += path(along(values), kind);
        out += text(6, (top + bottom) / 2 + 4, name, "middle", "italic");
        out += line(left, top, left, bottom, "axis") + line(left, bottom, end, bottom, "axis");
      };
      const truth = shownTruth();
      const trace = truth ? signorini.boundaryNodes(truth.cells).map((k) => truth.v[k]) : [];
      panel(22, 134, "y", "first", nodes.map((k) => y[k]), trace);
      panel(172, 284, "a", "third", [...a], truth ? truth.a : []);
      // Each node stands for the half cells on both of its sides.
      let bars = "";
      [...touched, touched[0]].forEach((inContact, b) => {
        const [from, to] = [b - 0.5, b + 0.5].map((s) => across(Math.min(Math.max(s / n, 0), 4)));
        if (inContact) bars += `M${from} 153H${to}`;
      });
      out += `<path class="contact" d="${bars}"/>`;
      out += text(left - 6, 157, "contact", "end", "muted small");
      ["bottom", "right", "top", "left"].forEach((side, k) => {
        out += text(across(k + 0.5), 14, side, "middle", "muted");
      });
      [0, 1, 2, 3, 4].forEach((s) => {
        out += line(across(s), 284, across(s), 288, "axis") + text(across(s), 301, s);
      });
      return out + text(across(2), 319, "arc length, anticlockwise");
    });
  }

  // ---- Wiring -----------------------------------------------------------------------------------

  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("change", (event) => {
    if (event.target.name === "problem") choicesOfProblem();
    if (event.target === form.truth) show();
    else if (event.target !== form.speed) changed();
    writeAddress();
  });
  root.addEventListener("click", (event) => {
    const { do: what, r } = event.target.dataset || {};
    if (what) actions[what]();
    if (r) {
      form.r.value = r;
      changed();
      writeAddress();
    }
  });
  // mdBook turns the page on arrow keys and searches on letters; in here they belong to the controls.
  root.addEventListener("keydown", (event) => event.stopPropagation());

  const canvas = find("canvas");
  const turn = (degrees) => {
    azimuth += degrees;
    if (run) surface();
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.key === "ArrowLeft") turn(-7.5);
    if (event.key === "ArrowRight") turn(7.5);
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) turn(-0.5 * event.movementX);
  });

  new ResizeObserver(() => show()).observe(root);
  new MutationObserver(() => show()).observe(document.documentElement, { attributeFilter: ["class"] });

  readAddress();
  root.hidden = false;
  changed();
})();
