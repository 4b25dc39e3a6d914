//! True solutions on other domains than the square, and finite elements measured against them.

use crate::bounds::Accuracy;
use crate::discrete::contact::ContactArc;
use crate::levels::{Problem, Reserve};
use crate::mesh::AnyMesh;
use crate::problem::law::Law;
use crate::problem::text::known;
use crate::solvers::{Adaption, Settings, Solved, Solver, find, solve};
use crate::spectral::TrueSolution;
use serde::{Deserialize, Serialize};

/// Problem on a built-in domain in the plane.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PlanePlan {
    /// Name of the domain.
    domain: String,
    /// f, as text.
    f: String,
    /// Numbers of refinements of the coarsest mesh, from and to.
    refinements: [usize; 2],
}

impl PlanePlan {
    fn new(domain: &str, f: &str, refinements: [usize; 2]) -> Self {
        Self { domain: domain.into(), f: f.into(), refinements }
    }

    /// Problems of the book.
    pub(super) fn all() -> Vec<Self> {
        vec![
            Self::new("lshape", "else=-1", [2, 6]),
            Self::new("lshape", "rect(0,9,0,9)=5; else=-3", [2, 6]),
            Self::new("disc", "halfplane(1,0.3,-0.1)=4; else=-7", [2, 6]),
            Self::new("annulus", "disc(0.2,0.8,0.15)=30; else=-2", [1, 5]),
        ]
    }
}

/// Table `plane_truths`: the true solution of a problem.
#[derive(Serialize)]
pub(super) struct PlaneTruthRow {
    domain: String,
    f: String,
    /// J(v), with the digits that both ends of its bracket share.
    energy: String,
    /// Width of the bracket of the energy over it.
    bracket: Option<f64>,
    /// Newton steps.
    steps: usize,
    /// Numbers of arcs in contact, and of their ends.
    arcs: usize,
    ends: usize,
    /// Largest |v| in contact, over its size, and the balance of the flux, over the integral of |f|.
    residual: f64,
    balance: f64,
    /// Ends of contact, and the cuts of the functions whose sum the solution is, from and to: as a picture shows them.
    contact: Vec<[f64; 2]>,
    cuts: Vec<[[f64; 2]; 2]>,
}

/// Table `plane`: a problem on one mesh, solved by multigrid to the rounding floor.
#[derive(Serialize)]
pub(super) struct PlaneRow {
    domain: String,
    f: String,
    nodes: usize,
    /// Length of the longest edge.
    h: f64,
    /// Energy of the finite element solution less the true one, over the absolute value of the latter; on a curved
    /// domain, that of a polygon.
    energy: f64,
    /// Guaranteed upper bound of the error in the energy norm over the root of twice that difference of energies, which
    /// is no less than the error; none on a curved domain.
    effectivity: Option<f64>,
    /// True if the true energy lies in the guaranteed bracket; none on a curved domain.
    holds: Option<bool>,
    /// Largest distance between a true end of contact and the nearest computed one; none without ends, or if the
    /// numbers of arcs differ.
    ends: Option<f64>,
}

/// Table `plane_ways`: error of the energy, over it, of one way to solve a problem, by the number of unknowns.
#[derive(Serialize)]
pub(super) struct PlaneWayRow {
    domain: String,
    f: String,
    way: &'static str,
    unknowns: usize,
    error: f64,
}

/// Findings of a problem, for the tables `plane_truths`, `plane` and `plane_ways`.
pub(super) struct PlaneFindings {
    pub truth: PlaneTruthRow,
    pub rows: Vec<PlaneRow>,
    pub ways: Vec<PlaneWayRow>,
}

/// Most nodes of adapted meshes.
const ADAPTED: usize = 20_000;

/// Solves a problem by the spectral solver, then on all meshes; on a domain that is no polygon not on adapted ones.
///
/// # Errors
/// A sentence if it is not solved.
pub(super) fn against_plane(plan: &PlanePlan) -> Result<PlaneFindings, String> {
    let PlanePlan { domain, f, refinements: [from, to] } = plan;
    let in_words = |e: String| format!("{domain}, {f}: {e}");
    let coarsest = AnyMesh::built_in(domain).ok_or_else(|| format!("no domain `{domain}`"))?;
    let on = |times: usize| Problem::on_mesh(&coarsest, times, f, Law::SIGNORINI);
    let problem = on(*from).map_err(|e| in_words(e.to_string()))?;
    let found = find(&problem, &Settings::of(Solver::Spectral), &mut ());
    let solved = Solved::new(problem, found.map_err(|e| in_words(e.to_string()))?);
    let truth = solved.truth().ok_or("the spectral solver finds true solutions")?;
    let mut rows = Vec::new();
    for times in *from..=*to {
        let problem = on(times).map_err(|e| in_words(e.to_string()))?;
        rows.push(PlaneRow::of(plan, &problem, truth).map_err(in_words)?);
    }
    let mut by_way: Vec<(&'static str, usize, f64)> = Vec::new();
    by_way.extend(truth.by_level().into_iter().map(|(n, energy)| ("powers", n, energy)));
    // The finest level is what the others are measured by.
    let (_, _, energy) = by_way.pop().ok_or("a true solution has levels")?;
    by_way
        .extend(rows.iter().map(|row| ("uniform", row.nodes, energy + row.energy * energy.abs())));
    if rows.iter().all(|row| row.holds.is_some())
        && let Some(mesh) = coarsest.plane()
    {
        // No mesh so coarse is so accurate: the number of nodes is what ends the run.
        let goal = Accuracy::Error(f64::EPSILON);
        let law = Law::SIGNORINI;
        let adaption =
            Adaption { coarsest: mesh, f, law, goal, most_nodes: ADAPTED, bisections: 1 };
        let solved = adaption.run(&mut (), &|_| ()).map_err(|e| in_words(e.to_string()))?;
        by_way.extend(solved.ends().iter().map(|end| ("adaptive", end.nodes, end.energy)));
    }
    let ways = by_way.into_iter().map(|(way, unknowns, found)| PlaneWayRow {
        domain: domain.clone(),
        f: f.clone(),
        way,
        unknowns,
        error: ((found - energy) / energy).abs(),
    });
    Ok(PlaneFindings { truth: PlaneTruthRow::of(plan, truth), rows, ways: ways.collect() })
}

impl PlaneTruthRow {
    fn of(PlanePlan { domain, f, .. }: &PlanePlan, truth: &TrueSolution) -> Self {
        let checks = truth.checks;
        let open = truth.contact.iter().filter(|arc| !arc.closed);
        let contact: Vec<_> = open.flat_map(|arc| [arc.from, arc.to]).collect();
        Self {
            domain: domain.clone(),
            f: f.clone(),
            energy: known(truth.energy, truth.bracket.ok(), 16),
            bracket: checks.bracket,
            steps: truth.steps,
            arcs: truth.contact.len(),
            ends: contact.len(),
            residual: checks.residual,
            balance: checks.balance.abs(),
            contact,
            cuts: truth.cuts(),
        }
    }
}

impl PlaneRow {
    fn of(
        PlanePlan { domain, f, .. }: &PlanePlan,
        problem: &Problem,
        truth: &TrueSolution,
    ) -> Result<Self, String> {
        let run = solve(problem, &Settings::of(Solver::Multigrid)).map_err(|e| e.to_string())?;
        let excess = run.judgement.energy - truth.energy;
        let is_polygon = problem.reserves().contains(&Reserve::Polygon);
        let bounds = problem.bounds(&run.y).map_err(|e| e.to_string())?;
        let [low, high] = bounds.energy;
        let contact = problem.arcs(&run.y, &run.judgement).unwrap_or_default();
        Ok(Self {
            domain: domain.clone(),
            f: f.clone(),
            nodes: run.y.len(),
            h: problem.levels().facts().width,
            energy: excess / truth.energy.abs(),
            effectivity: (!is_polygon).then(|| bounds.error[1] / (2.0 * excess).sqrt()),
            holds: (!is_polygon).then_some(low <= truth.energy && truth.energy <= high),
            ends: distance(&truth.contact, &contact),
        })
    }
}

/// Largest distance between ends of arcs, each true arc compared with the nearest found one; none without ends, or if
/// the numbers of arcs differ.
fn distance(truth: &[ContactArc], found: &[ContactArc]) -> Option<f64> {
    if truth.len() != found.len() || truth.iter().chain(found).any(|arc| arc.closed) {
        return None;
    }
    let off = truth.iter().map(|arc| {
        let others =
            found.iter().map(|other| apart(arc.from, other.from).max(apart(arc.to, other.to)));
        others.fold(f64::INFINITY, f64::min)
    });
    off.reduce(f64::max)
}

/// Distance of two points.
fn apart([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    libm::hypot(u - x, v - y)
}
