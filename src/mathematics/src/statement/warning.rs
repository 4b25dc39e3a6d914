//! Facts by which an answer is judged: warnings, and the failure of what is not as asked.

use crate::bounds::{Accuracy, NoBound};
use crate::discrete::end::{Stop, Violation};
use crate::problem::law::name_of_force;
use crate::problem::text::{Written, percent, plain};
use crate::saddle::tolerance;
use crate::solvers::{MOST_CELLS, ReachEnd, Solver};

/// Doubt about an answer. Levels are called as [`Problem::name`](crate::levels::Problem::name) calls them; parts of the
/// load, of the integral of |f| and of the solution are of one, not of a hundred.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the sentences name the numbers")]
pub enum Warning {
    /// A fact on the domain, f or a true solution.
    #[error("{0}")]
    Note(String),
    /// The KKT residual is not small.
    #[error("the KKT residual on {level} is {relative:.2} of the load")]
    Rough { level: String, relative: f64 },
    /// The coarsest grid is finer than those for which the stopping rule is made.
    #[error("the coarsest grid is 1/{cells}, and the tolerance is 10^-k on the k-th grid, here {} on the last",
        Written(tolerance(*grids)))]
    FineStart { cells: usize, grids: usize },
    /// The discrete problem has no solution on coarser levels.
    #[error(
        "the load vector sums to a non-negative number on {levels}, where the discrete problem has no solution"
    )]
    NoCoarseSolution { levels: String },
    /// The solver did not reach its goal on coarser levels.
    #[error("the {goal} was not met on {levels}")]
    CutOff { goal: &'static str, levels: String },
    /// The residual that was asked for was not reached.
    #[error("the tolerance {} was not reached: the KKT residual is {} of the load at the {stop}",
        Written(*tolerance), plain(*relative, 3))]
    Tolerance { tolerance: f64, relative: f64, stop: Stop },
    /// Rounding errors leave a large residual of a solution that is sought up to them.
    #[error("rounding errors leave a KKT residual of {} of the load on {level}", plain(*relative, 2))]
    Rounding { level: String, relative: f64 },
    /// The load vector belongs to another f, since values at the nodes miss where f jumps.
    #[error("{}: values at the nodes miss where f jumps", sums(level, *sum_load, *integral))]
    Load { level: String, sum_load: f64, integral: f64 },
    /// The load vector belongs to another f, since the points of the quadrature miss some of it.
    #[error("{}: its points miss some of f", sums(level, *sum_load, *integral))]
    Points { level: String, sum_load: f64, integral: f64 },
    /// The points of the quadrature miss some of f.
    #[error("the quadrature of f on {level} misses {} of the integral of |f|", plain(*missed, 2))]
    Quadrature { level: String, missed: f64 },
    /// The load vector moves jumps of f.
    #[error("{0}")]
    Jumps(String),
    /// The total flux does not balance the load: at the discrete solution their sum is zero up to rounding.
    #[error("the {} {} does not balance the load, {}, so the {} of the solution", name_of_force(*has_contact),
        plain(*force, 5), plain(*load, 5), contact_is_other(*has_contact))]
    Force { has_contact: bool, force: f64, load: f64 },
    /// There is no bound of the error.
    #[error("no bound of the error: {0}")]
    NoBound(NoBound),
    /// The bounds contradict the energy.
    #[error(
        "the energy is further from the true one than the error explains: the load vector is not that of f"
    )]
    Energy,
    /// The bound of the error is large beside the solution.
    #[error("the error may be {}", beside_solution(*relative))]
    Error { relative: f64 },
}

/// Reason why an answer is not what was asked for. Levels are called as in a [`Warning`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the sentences name the numbers")]
pub enum Failure {
    /// Values of the solver are no longer finite.
    #[error("{solver} diverged on {level} after {iterations} iterations")]
    Diverged { solver: Solver, level: String, iterations: usize },
    /// No nodal vector solves the discrete problem on the level.
    #[error("the load vector sums to {} on {level}, where the discrete problem has no solution", signed(*sum_load))]
    NoSolution { level: String, sum_load: f64 },
    /// The solver was cut off.
    #[error("stopped at the {stop} on {level}")]
    CutOff { stop: Stop, level: String },
    /// The solver reached its goal, but the conditions of the solution are violated.
    #[error("the solver stopped as asked on {level}, but {violation}")]
    NotSolved { level: String, violation: Violation },
    /// A solution, on a grid that is too coarse for the accuracy: a finer one does not fit into memory.
    #[error("the {accuracy} takes a grid {}, too fine for memory; 1/{MOST_CELLS} {}", grid(*needed), reaching(*best))]
    TooFine { accuracy: Accuracy, needed: f64, best: f64 },
    /// A solution, without the accuracy: whether the solver reached its goal on the last mesh, integrals of f are by
    /// quadrature, and the spectral solver takes the problem says which remedies there are.
    #[error("the {accuracy} is not reached: {} with {nodes} nodes; {}", accuracy.in_words(*reached), end.in_words())]
    Accuracy {
        accuracy: Accuracy,
        reached: f64,
        nodes: usize,
        end: ReachEnd,
        has_converged: bool,
        by_quadrature: bool,
        takes_spectral: bool,
    },
}

impl Failure {
    /// True if the answer is a solution all the same, with another accuracy than was asked for.
    pub fn is_of_accuracy(&self) -> bool {
        matches!(self, Self::TooFine { .. } | Self::Accuracy { .. })
    }
}

/// Returns a sum with a plus before it if it is positive.
fn signed(sum: f64) -> String {
    let sign = if sum > 0.0 { "+" } else { "" };
    format!("{sign}{}", plain(sum, 4))
}

/// Returns, in words, the sum of a load vector that misses the integral of f.
fn sums(level: &str, sum_load: f64, integral: f64) -> String {
    let [sum_load, integral] = [sum_load, integral].map(signed);
    format!("the load vector sums to {sum_load} on {level}, the integral of f is {integral}")
}

/// Returns, in words, that boundary nodes are in contact that are not so in the solution.
fn contact_is_other(has_contact: bool) -> &'static str {
    if has_contact { "contact set is not that" } else { "nodes that stick are not those" }
}

/// Returns, in words, an error that is so large beside the solution.
fn beside_solution(relative: f64) -> String {
    match relative < 1.0 {
        true => percent(relative, 2) + " of the solution",
        false => "as large as the solution".into(),
    }
}

/// Returns, in words, a grid with about so many cells per side.
fn grid(needed: f64) -> String {
    match needed < 1e6 {
        true => format!("of about 1/{needed:.0}"),
        false => "finer than 1/1000000".into(),
    }
}

/// Returns, in words, a bound that is reached.
fn reaching(best: f64) -> String {
    match best {
        f64::INFINITY => "does not reach half".into(),
        best => format!("reaches about {best:.1e}"),
    }
}
