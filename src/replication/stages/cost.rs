//! The pictures of the chapter on accuracy and cost, from results and recorded times to SVG.

use crate::experiments::accuracy::{Findings, Level};
use crate::experiments::law::Law;
use crate::figures::{Axis, Caption, Chart, Curve, Scale, Stroke, charts};
use crate::timing::measure::SOLVERS;
use crate::timing::recorded::{Goal, Reached, Scaling, Timings, arrivals};

type Drawn = Result<String, String>;

/// A curve that owns its data.
struct Line {
    label: String,
    points: Vec<(f64, f64)>,
    stroke: Stroke,
}

/// A doubly logarithmic panel that owns its data.
struct Panel {
    title: String,
    x: &'static str,
    y: &'static str,
    lines: Vec<Line>,
}

fn marked(label: impl Into<String>, points: Vec<(f64, f64)>) -> Line {
    Line { label: label.into(), points, stroke: Stroke::Marked }
}

fn curve(line: &Line) -> Curve<'_> {
    let Line { label, points, stroke } = line;
    Curve { label, points, stroke: *stroke }
}

fn draw(caption: Caption, panels: &[Panel]) -> Drawn {
    let curves: Vec<Vec<Curve>> = panels
        .iter()
        .map(|panel| panel.lines.iter().filter(|line| !line.points.is_empty()).map(curve).collect())
        .collect();
    let axis = |name| Axis { name, scale: Scale::Log, range: None };
    let panels: Vec<_> = panels
        .iter()
        .zip(&curves)
        .map(|(panel, curves)| Chart {
            title: &panel.title,
            x: axis(panel.x),
            y: axis(panel.y),
            curves,
        })
        .collect();
    charts(caption, 2, &panels).map_err(|e| e.to_string())
}

/// A line of slope `power` over the range of the others, all of which it passes by at this `factor`
/// of the one that comes nearest.
fn slope(label: &str, lines: &[Line], power: f64, factor: f64) -> Line {
    let points = || lines.iter().flat_map(|line| &line.points);
    let ends = points().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p.0), b.max(p.0)));
    let scaled = points().map(|(x, y)| y / libm::pow(*x, power));
    let constant = match factor < 1.0 {
        true => factor * scaled.fold(f64::MAX, f64::min),
        false => factor * scaled.fold(0.0, f64::max),
    };
    let at = |x: f64| (x, constant * libm::pow(x, power));
    Line { label: label.into(), points: vec![at(ends.0), at(ends.1)], stroke: Stroke::Reference }
}

/// Errors of the problems with known solutions, one panel per norm.
pub(super) fn accuracy(caption: Caption, found: &Findings) -> Drawn {
    type Norm =
        (&'static str, &'static str, fn(&Level) -> f64, &'static [(&'static str, f64, f64)]);
    let norms: [Norm; 4] = [
        ("v in L2", "error in L2", |level| level.errors.l2, &[("order 2", -2.0, 0.12)]),
        ("v in H1", "error in H1", |level| level.errors.h1, &[("order 1", -1.0, 0.25)]),
        ("v at the nodes", "greatest error", |level| level.errors.max, &[("order 2", -2.0, 0.12)]),
        (
            "multiplier in L2",
            "error in L2 of the boundary",
            |level| level.errors.multiplier_l2,
            &[("order 2", -2.0, 0.3), ("order 1", -1.0, 2.0)],
        ),
    ];
    let panels = norms.map(|(title, y, pick, slopes)| {
        let curve = |level: &Level| (level.cost.cells as f64, pick(level));
        let mut lines: Vec<_> = found
            .problems
            .iter()
            .map(|known| marked(&known.name, known.levels.iter().map(curve).collect()))
            .collect();
        let references: Vec<_> = slopes
            .iter()
            .map(|(label, power, factor)| slope(label, &lines, *power, *factor))
            .collect();
        lines.extend(references);
        Panel { title: title.into(), x: "1/h", y, lines }
    });
    draw(caption, &panels)
}

/// Three methods on one grid, up to the discretisation error on several, and the law of the paper's.
pub(super) fn work(caption: Caption, found: &Findings) -> Drawn {
    let race = &found.race;
    let trace = |column: usize| -> Vec<Line> {
        let of = |run: &crate::experiments::law::Run| {
            let points = run.trace.iter().map(|point| (point[0], point[column])).collect();
            // Hundreds of looks at a saddle-point method would hide their own line.
            let stroke = if run.trace.len() > 40 { Stroke::Line } else { Stroke::Marked };
            Line { label: run.method.clone(), points, stroke }
        };
        race.runs.iter().map(of).collect()
    };
    let mut errors = trace(2);
    errors.push(slope_of_error(&errors, race.discretisation));
    let mut arrivals: Vec<_> = race
        .runs
        .iter()
        .map(|run| marked(&run.method, run.arrivals.iter().map(|a| (a.1, a.3)).collect()))
        .collect();
    arrivals.push(slope("order 1", &arrivals[..1], -1.0, 0.15));
    let finest = |law: &&Law| law.target < 1e-5;
    let mut laws: Vec<_> = found.laws.iter().filter(finest).map(law_line).collect();
    laws.push(slope("order 2", &laws, 2.0, 0.2));
    let panels = [
        Panel {
            title: format!("Residual on the grid 1/{}", race.cells),
            x: "work units",
            y: "relative KKT residual",
            lines: trace(1),
        },
        Panel {
            title: format!("Error on the grid 1/{}", race.cells),
            x: "work units",
            y: "error at the nodes",
            lines: errors,
        },
        Panel {
            title: "To the discretisation error".into(),
            x: "unknowns visited",
            y: "error at the nodes",
            lines: arrivals,
        },
        Panel {
            title: "The law of the paper's method".into(),
            x: "1/h",
            y: "sweeps to a residual of 10\u{207b}\u{2076}",
            lines: laws,
        },
    ];
    draw(caption, &panels)
}

fn law_line(law: &Law) -> Line {
    let f = law.f.trim_start_matches("exact(").trim_end_matches(')');
    let f = if f.contains('=') { "problem 2" } else { f };
    let start = if law.nested { "nested" } else { "from zero" };
    marked(format!("{f}, {start}"), law.sweeps.iter().map(|&(n, s)| (n as f64, s as f64)).collect())
}

/// The level of the discretisation error across the panel.
fn slope_of_error(lines: &[Line], error: f64) -> Line {
    let Line { points, .. } = slope("discretisation error", lines, 0.0, 0.5);
    let points = points.into_iter().map(|(x, _)| (x, error)).collect();
    Line { label: "discretisation error".into(), points, stroke: Stroke::Reference }
}

/// Time per unknown: multigrid for both goals, and every solver to the discretisation error.
///
/// The proximal method would lie upon Uzawa's, and there are no more colours.
pub(super) fn cost(caption: Caption, timings: &Timings) -> Drawn {
    let goals = [
        ("multigrid", Goal::Discretisation, 1),
        ("two threads", Goal::Discretisation, 2),
        ("to the floor", Goal::Floor, 1),
        ("to the floor, two threads", Goal::Floor, 2),
    ];
    let per_unknown = |(cells, seconds): (usize, f64)| {
        let unknowns = ((cells + 1) * (cells + 1)) as f64;
        (unknowns, 1e9 * seconds / unknowns)
    };
    let multigrid = goals.map(|(label, goal, threads)| {
        let wanted = |line: &&Scaling| line.goal == goal && line.threads == threads;
        let lines = timings.multigrid.iter().filter(wanted);
        marked(label, lines.map(|line| per_unknown((line.cells, line.seconds))).collect())
    });
    let problem = timings.solver.last().map(|line| &line.problem);
    let solvers = ["multigrid", "active-set", "arrow-hurwicz", "uzawa"].map(|solver| {
        let mine = |line: &&Reached| line.solver == solver && Some(&line.problem) == problem;
        let mine: Vec<_> = timings.solver.iter().filter(mine).collect();
        marked(solver, arrivals(&mine).map(per_unknown).collect())
    });
    let panel = |title: &str, lines: [Line; 4]| Panel {
        title: title.into(),
        x: "unknowns",
        y: "nanoseconds per unknown",
        lines: lines.into_iter().collect(),
    };
    let mut panels = vec![panel("Multigrid", multigrid)];
    panels.push(panel("To the discretisation error", solvers));
    panels.retain(|panel| panel.lines.iter().any(|line| !line.points.is_empty()));
    draw(caption, &panels)
}

/// Error against time, one panel per problem; of each solver the runs that no other of its own beats.
pub(super) fn race(caption: Caption, timings: &Timings) -> Drawn {
    let mut problems: Vec<&str> = timings.solver.iter().map(|line| &line.problem[..]).collect();
    problems.dedup();
    let panels: Vec<_> = problems
        .into_iter()
        .map(|problem| {
            let front = |solver: &&str| {
                let mine =
                    timings.solver.iter().filter(|l| l.solver == **solver && l.problem == problem);
                let mut points: Vec<_> = mine.map(|line| (line.seconds, line.error)).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut best = f64::INFINITY;
                points.retain(|(_, error)| {
                    *error < best && {
                        best = *error;
                        true
                    }
                });
                marked(*solver, points)
            };
            Panel {
                title: problem.into(),
                x: "seconds",
                y: "error at the nodes",
                lines: SOLVERS.iter().map(front).collect(),
            }
        })
        .collect();
    draw(caption, &panels)
}
