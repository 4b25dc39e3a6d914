//! One cycle through the grids, and the nested iteration that leads to the finest.

use super::hierarchy::{Geometry, Multigrid};
use super::layout::{boundary_nodes, rows_per_slab};
use super::pass::Problem::{Correction, Obstacle};
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict, StartRed};
use super::pass::{self, Problem, Stage};
use super::rows;
use super::rows::Colour::{Black, Red};
use super::stencil::for_each_boundary_node;

/// Nested iteration stays on a grid until the natural residual is below this part of the load.
const SETTLED: f64 = 1.0;
/// Cycles on one coarse grid of the nested iteration at most.
const MAX_NESTED_CYCLES: usize = 30;

impl<G: Geometry> Multigrid<G> {
    /// Solves on all grids but the finest, each started from the one below.
    ///
    /// Two sweeps before the first correction let the contact set settle.
    pub(super) fn nested_iteration(&mut self) {
        self.solve_coarsest();
        for l in 1..self.levels.len() - 1 {
            self.pass(l, Obstacle, &Self::smooth_twice(Interpolate));
            for _ in 0..MAX_NESTED_CYCLES {
                let smooth = Self::smooth_twice(Correct(G::OVERCORRECTION));
                let kkt = self.cycle(l, &smooth, G::TWICE_BELOW);
                if kkt <= SETTLED * self.levels[l].load_scale {
                    break;
                }
            }
        }
    }

    pub(super) fn solve_coarsest(&mut self) {
        self.contact.0 = 0;
        let work = self.coarsest.solve_obstacle(&mut self.levels[0]);
        self.count(work);
    }

    /// One cycle on the obstacle problem of level `l`, whose residual has been restricted; grids see two from
    /// `twice_below` grids below on. `smooth` brings the correction and ends by restricting the residual again.
    /// Returns the natural residual.
    pub(super) fn cycle(&mut self, l: usize, smooth: &[Stage], twice_below: usize) -> f64 {
        let level = &mut self.levels[l];
        let n = level.n;
        if !level.in_contact.contains(&true) {
            self.lower_into_contact(l);
        }
        let (coarser, level) = self.levels.split_at_mut(l);
        let in_contact = &level[0].in_contact;
        if self.contact.0 != n || self.contact.1 != *in_contact {
            let work = G::set_springs(n, in_contact, coarser);
            let factor = self.coarsest.factor(&coarser[0]);
            self.contact.0 = n;
            self.contact.1.clone_from(in_contact);
            self.count(work + factor);
        }
        self.count(boundary_nodes::<G>(n) as f64);
        self.correct(l - 1, l.saturating_sub(twice_below), true);
        self.pass(l, Obstacle, smooth)
    }

    /// One cycle on the linear problem of level `l`, from zero; from level `twice_from` down, and while
    /// `twice`, the coarser problem gets two.
    ///
    /// Near-constant modes of semicoercive problems need accurate coarse solves, and there they cost little.
    fn correct(&mut self, l: usize, twice_from: usize, twice: bool) {
        if l == 0 {
            let work = self.coarsest.solve_linear(&mut self.levels[0]);
            self.count(work);
            return;
        }
        let relaxation = G::COARSE_RELAXATION;
        self.pass(l, Correction, &[StartRed(relaxation), Relax(Black, 1.0), Restrict]);
        self.correct(l - 1, twice_from, twice);
        if twice && l <= twice_from {
            self.pass(l, Correction, &Self::smooth_twice(Correct(1.0)));
            self.correct(l - 1, twice_from, G::W_CYCLE);
        }
        // What comes from two cycles or, two grids below, a direct solution, near-constant modes above all, is
        // complete, and must not grow on the finest grid. (That it does one grid below costs nothing: without,
        // 8 cells take 3 % more cycles, 12 and 28 cells 4 to 8 % less, finer grids the same.)
        let factor = if l == twice_from + 1 { 1.0 / G::OVERCORRECTION } else { 1.0 };
        let last = [Correct(factor), Relax(Red, 1.0), Relax(Black, relaxation)];
        self.pass(l, Correction, &last);
    }

    /// Subtracts a constant such that one boundary node touches zero, and puts that one in contact.
    ///
    /// With an empty contact set the corrections would be unbounded; the sum of the load being
    /// negative, the solution does touch somewhere.
    fn lower_into_contact(&mut self, l: usize) {
        let level = &mut self.levels[l];
        let (mut lowest, mut at) = (f64::INFINITY, 0);
        let n = level.n;
        for_each_boundary_node::<G>(n, |number, [i, r, s]| {
            let value = level.value((s * rows_per_slab::<G>(n) + r) * (n + 1) + i);
            if value < lowest {
                (lowest, at) = (value, number);
            }
        });
        rows::for_each(&mut level.values, |value| *value -= lowest);
        level.in_contact[at] = true;
        let nodes = level.nodes as f64;
        self.count(0.25 * nodes);
        self.move_bytes(16.0 * nodes);
    }

    pub(super) fn pass(&mut self, l: usize, problem: Problem, stages: &[Stage]) -> f64 {
        let (coarse, fine) = self.levels.split_at_mut(l);
        let natural = pass::run::<G>(&mut fine[0], &mut coarse[l - 1], problem, stages);
        let nodes = self.levels[l].nodes as f64;
        self.count(pass::work(stages) * nodes);
        self.move_bytes(pass::traffic::<G>(stages) * nodes);
        natural
    }

    /// Between two coarse-grid corrections: post-smoothing of one cycle, pre-smoothing of the next.
    pub(super) fn smooth_twice(from_coarser: Stage) -> [Stage; 6] {
        [
            from_coarser,
            Relax(Red, 1.0),
            Relax(Black, G::RELAXATION),
            Relax(Red, G::RELAXATION),
            Relax(Black, 1.0),
            Restrict,
        ]
    }
}
