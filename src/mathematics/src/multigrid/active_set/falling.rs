//! Active set method whose energy falls, so that it ends: for matrices that are no M-matrices, as of stretched cells.
//!
//! # Algorithm
//! Nodes at the values of their laws stick; on which side of them the others are says how they slip. Below, zero is the
//! value of the law.
//! 1. Find the vector of least energy with these states. If its values have the signs of the states, go there, and
//!    minimise the energy over one value after the other.
//! 2. Otherwise go a part of the way, with a value of zero at each node whose value would change its sign: the whole
//!    way if that lowers the energy, else half of it and so on, at least to the first change of a sign; if nodes at
//!    zero bar the way, let these stick.
//!
//! # Why it ends
//! The second step makes one more node stick each time, so that the first one follows. There the vector is the best one
//! with its states. The sweep lowers its energy unless it is the solution, since a vector whose energy no single value
//! can lower is the solution: the energy is a differentiable function and one function of each value, all convex. Hence
//! no states are those of two such vectors, and there are finitely many states. States that return show rounding
//! errors.
//!
//! In a component that bears no load one node has to stick: the sweep ends with the constant of least energy.

use super::StateSystem;
use super::states::StateProblem;
use crate::discrete::end::Stop;
use crate::discrete::network::ContactRow;
use crate::problem::law::{BoundaryState, ContactNode, Law};

/// Work of all linear systems at most, in multiplications: a minute or two.
const MOST_WORK: f64 = 1e11;
/// Least and greatest number of linear systems at most, whatever their work: of 1 500 random meshes with aspects up to
/// 1e6 none took a thousand.
const MOST_STEPS: [f64; 2] = [30.0, 4000.0];
/// Sweeps over all values: at the end of a strip of contact each lets a node or more slip.
const SWEEPS: usize = 4;

/// Goes from a vector within the law, which has a value of zero in each component that bears no load, to the solution.
pub(super) fn fall(system: &mut StateSystem<'_>, y: &mut Vec<f64>) -> Stop {
    let problem = system.problem;
    let mut states = problem.states_by_sign(y);
    let mut seen = Vec::new();
    let mut stop = Stop::IterationLimit;
    let [least, greatest] = MOST_STEPS;
    let most_steps = (MOST_WORK / system.direct.step_work()).clamp(least, greatest) as usize;
    for _ in 0..most_steps {
        let mut best = y.clone();
        system.solve(&states, &mut best);
        if !best.iter().all(|value| value.is_finite()) {
            return Stop::Diverged;
        }
        let crossings = problem.crossings(&states, y, &best);
        if crossings.iter().any(|crossing| *crossing <= 1.0) {
            problem.go_towards(&mut states, y, &best, &crossings);
            continue;
        }
        *y = best;
        if problem.next_states(&states, y) == states {
            stop = Stop::Converged;
            break;
        }
        if problem.has_rounding_errors_alone(&states, y) || seen.contains(&states) {
            stop = Stop::RoundingFloor;
            break;
        }
        problem.sweep(y);
        seen.push(std::mem::replace(&mut states, problem.states_by_sign(y)));
    }
    problem.put_into_states(&states, y);
    stop
}

impl StateProblem<'_> {
    /// Part of the way from a vector to another one at which the value of each contact node becomes zero; infinity
    /// where it keeps the sign of its state.
    fn crossings(&self, states: &[BoundaryState], y: &[f64], best: &[f64]) -> Vec<f64> {
        let of_node = |(contact, law): (&ContactNode, &Law)| {
            let at = law.at();
            let (from, to) = (y[contact.node], best[contact.node]);
            let keeps = match states[contact.node] {
                BoundaryState::Sticks => true,
                BoundaryState::SlipsUp => to >= at,
                BoundaryState::SlipsDown => to <= at,
            };
            if keeps { f64::INFINITY } else { (from - at) / (from - to) }
        };
        self.network.contact().iter().zip(self.laws).map(of_node).collect()
    }

    /// Goes a part of the way to a vector, on which the energy falls, and lets the nodes that reach zero stick; see
    /// the second step of the algorithm.
    fn go_towards(
        &self,
        states: &mut [BoundaryState],
        y: &mut [f64],
        best: &[f64],
        crossings: &[f64],
    ) {
        let load = self.load_with(states);
        let mut residual = vec![0.0; y.len()];
        self.network.gradient(y, &load, &mut residual);
        residual.iter_mut().for_each(|value| *value = -*value);
        let later = crossings.iter().copied().filter(|crossing| *crossing > 0.0);
        let first = later.fold(1.0, f64::min);
        let is_barred = crossings.iter().any(|crossing| *crossing <= 0.0);
        let mut part = 1.0;
        let reached = loop {
            let mut step: Vec<f64> =
                y.iter().zip(best).map(|(from, to)| part * (to - from)).collect();
            let contact = self.network.contact().iter().zip(self.laws);
            for ((contact, law), crossing) in contact.zip(crossings) {
                if *crossing <= part {
                    step[contact.node] = law.at() - y[contact.node];
                }
            }
            // Without nodes at zero that bar the way the first part lowers the energy, whatever rounding errors say.
            let is_first = part <= first;
            if self.network.energy(&step, &residual) < 0.0 || (is_first && !is_barred) {
                y.iter_mut().zip(&step).for_each(|(value, step)| *value += step);
                break part;
            }
            if is_first {
                break 0.0;
            }
            part = (0.5 * part).max(first);
        };
        for (contact, crossing) in self.network.contact().iter().zip(crossings) {
            if *crossing <= reached {
                states[contact.node] = BoundaryState::Sticks;
            }
        }
        self.put_at_values(states, y);
    }

    /// Minimises the energy over one value after the other some times, then over the constant of each component without
    /// fixed nodes.
    fn sweep(&self, y: &mut [f64]) {
        for _ in 0..SWEEPS {
            self.network.sweep(self.load, y, |b, ContactRow { sum, diagonal, measure, .. }| {
                self.laws[b].settle(sum, diagonal, measure)
            });
        }
        let needed = self.needed();
        let is_held = self.network.held_components(self.components);
        let mut next = self.all_stick();
        for component in (0..needed.len()).filter(|component| !is_held[*component]) {
            let constant = self.shift(component, needed[component], y, &mut next);
            for (value, of) in y.iter_mut().zip(self.components) {
                if *of as usize == component {
                    *value -= constant;
                }
            }
        }
        // Nodes of components that have not been shifted keep their values.
        next.iter_mut().zip(self.components).for_each(|(state, component)| {
            if is_held[*component as usize] {
                *state = BoundaryState::SlipsUp;
            }
        });
        self.put_at_values(&next, y);
    }
}
