//! Times of adaptive and of uniform refinement to a guaranteed error.

use super::median::{MedianTime, time};
use super::{LONGEST, TimingPlan};
use crate::timing::recorded::{AdaptedTime, nodes};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::experiments::adapted::{AdaptedProblem, Way};
use signorini_mathematics::solvers::Adaption;

/// Guaranteed errors, over the norm of the solution, to which adaptive refinement goes.
const GOALS: [f64; 3] = [0.03, 0.01, 0.003];
/// Refinements of the coarsest uniform mesh.
const FIRST: usize = 5;

/// Measures both ways on the L-shape: adaptive refinement to each goal, uniform refinement until it takes longer than
/// that; on meshes with at most the nodes of the finest grid. A time is that from the coarsest mesh to the bounds.
pub(super) fn times(
    plan: &TimingPlan,
    say: &mut impl FnMut(&str),
) -> Result<Vec<AdaptedTime>, String> {
    let (problem, most_nodes) = (AdaptedProblem::lshape(), nodes(plan.finest));
    let mut measured = Vec::new();
    for goal in GOALS.into_iter().take_while(|_| !plan.ended()) {
        say(&format!("adaptive refinement, L-shape, error {goal}"));
        let run = problem.adapted(goal, most_nodes, Adaption::BISECTIONS)?;
        let bounds = run.bounds.last().ok_or("no mesh")?;
        let median = time(plan.repeats, || {
            let _ = problem.adapted(goal, most_nodes, Adaption::BISECTIONS);
        });
        measured.push(line(Way::Adaptive, run.y.len(), bounds, &median));
        // The next run would be the same.
        if bounds.relative() > goal {
            break;
        }
    }
    let longest = measured.iter().fold(0.0f64, |most, line| line.seconds.max(most)).min(LONGEST);
    for refinements in (FIRST..).take_while(|_| !plan.ended()) {
        say(&format!("uniform refinement, L-shape, {refinements} times"));
        let run = problem.uniform_finest(refinements)?;
        let bounds = run.bounds.last().ok_or("no mesh")?;
        if run.y.len() > most_nodes {
            break;
        }
        let median = time(plan.repeats, || {
            let _ = problem.uniform_finest(refinements);
        });
        measured.push(line(Way::Uniform, run.y.len(), bounds, &median));
        if median.seconds > longest {
            break;
        }
    }
    Ok(measured)
}

fn line(way: Way, nodes: usize, bounds: &Bounds, median: &MedianTime) -> AdaptedTime {
    let (error, seconds) = (bounds.relative(), median.seconds);
    AdaptedTime { problem: "L-shape".into(), way, nodes, error, seconds }
}
