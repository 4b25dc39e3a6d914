//! Outcome of a solve on one grid or mesh.

use super::Pair;
use super::engine::End;
use crate::discrete::kkt::{DiscreteDomain, Judgement, Kkt, has_solution, judge};
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::norms::sum;
use crate::discrete::stop::Stop;
use crate::discrete::verdict::Verdict;
use serde::{Deserialize, Serialize};

/// Outcome of a solve on one grid or mesh: the end of the iteration and the quality of the last pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of a grid of the square; none on a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Number of nodes.
    pub nodes: usize,
    /// Steps of the multiplier done: the iterations of the paper.
    pub iterations: usize,
    /// Number of Gauss-Seidel sweeps.
    pub sweeps: usize,
    /// Reason for the end. The stopping rules see the gradient of M alone; [`Outcome::kkt`] measures the solution.
    pub stop: Stop,
    /// `max_i dM/dy_i` at the end.
    pub gradient_signed: f64,
    /// `max_i |dM/dy_i|` at the end.
    pub gradient_abs: f64,
    /// Last change of the multiplier, the paper's Delta a.
    pub delta_a: f64,
    /// `1/2 <A y, y> - <F, y>`, with the law's term.
    pub energy: f64,
    /// Sum of the load vector.
    pub sum_load: f64,
    /// Residual of the Karush-Kuhn-Tucker conditions, the measure common to all solvers.
    pub kkt: Kkt,
    /// Sum over the boundary nodes of y times the gradient of the energy, with the law's term: zero at the solution.
    pub work: f64,
    /// True if the discrete problem has a solution, see [`has_solution`]; under the paper's law without fixed parts, if the
    /// sum of the load is negative.
    pub has_solution: bool,
}

impl Outcome {
    /// Judges `pair` after the end of an iteration; `gradient` has the largest component of (8), and the largest absolute
    /// value.
    pub(super) fn judge(
        domain: impl DiscreteDomain,
        LawAndLoad { law, load }: LawAndLoad<'_>,
        pair: &Pair,
        end: &End,
        [gradient_signed, gradient_abs]: [f64; 2],
    ) -> Self {
        let Judgement { kkt, energy, work, .. } = judge(domain, law, &pair.y, load);
        let (shape, sum_load) = (domain.shape(), sum(load));
        // Without contact nodes the least multiplier is infinite.
        let finite = [energy, gradient_abs, kkt.natural].iter().all(|value| value.is_finite())
            && kkt.min_lambda > f64::NEG_INFINITY;
        Self {
            cells: shape.cells,
            nodes: shape.nodes,
            iterations: end.iterations,
            sweeps: end.sweeps,
            stop: if finite { end.stop } else { Stop::Diverged },
            gradient_signed,
            gradient_abs,
            delta_a: end.delta_a,
            energy,
            sum_load,
            kkt,
            work,
            has_solution: has_solution(domain, law, load),
        }
    }

    /// Verdict on the vector where the iteration ended.
    pub fn verdict(&self) -> Verdict {
        Verdict::new(self.has_solution, &self.kkt, self.energy, self.work)
    }

    /// Name of the end of the iteration: `stop`, unless the verdict is that there is no solution.
    pub fn end(&self) -> &'static str {
        self.verdict().end(self.stop)
    }
}
