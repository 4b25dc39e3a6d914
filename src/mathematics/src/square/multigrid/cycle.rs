//! One cycle through the grids.
//!
//! An F-cycle on grid 5 (finest), with double visits from grid 2 down. Time runs to the right; `o` is a pass over a
//! grid, `x` a direct solution.
//!
//! ```text
//! grid 5  o                               o
//! grid 4    o                           o
//! grid 3      o                       o
//! grid 2        o           o       o
//! grid 1          o   o   o   o   o
//! grid 0            x   x       x
//! ```
//!
//! During the second visit to grid 2, grid 1 is visited once; in a W-cycle it would be visited twice.

use super::pass;
use super::pass::LevelProblem::{self, BoundaryLaw, Correction};
use super::pass::Stage::{self, Correct, Relax, Restrict, StartRed};
use super::rows::Colour::{Black, Red};
use super::rows::{self, boundary_nodes};
use super::springs::set_springs;
use super::stencil::{contact_nodes, energy};
use super::workspace::Multigrid;
use crate::problem::balance::{Balance, ContactValue, place_at_zero};
use crate::problem::law::{BoundaryState, ContactNode, Law};

/// Over-relaxation factor inside, for the colour that the neighbouring transfers do not read or write.
const RELAXATION: f64 = 1.15;
/// Over-relaxation factor of the half-sweeps that begin and end a visit to a correction problem.
const COARSE_RELAXATION: f64 = 1.45;
/// Factor of the corrections to the problem under the law.
///
/// Corrections by a V-cycle are too small by up to a tenth where the wavelength is a few cells of the coarser grid;
/// enlarged by this factor they are too large as often as too small.
pub(super) const OVERCORRECTION: f64 = 1.08;
/// Number of grids from the finest down to the first grid that is visited twice.
pub(super) const DOUBLE_VISITS_BELOW: usize = 3;
/// Ratio of the natural residual to the load at which nested iteration leaves a grid.
const SETTLED: f64 = 1.0;
/// Relative difference of energies that rounding errors may make.
const ENERGY_ROUNDING: f64 = 1e-12;
/// Parts of a correction whose energies are compared.
const SEARCHED_PARTS: [f64; 7] = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.015_625, 0.0];
/// Limit on the number of cycles on one coarse grid of the nested iteration.
const MAX_NESTED_CYCLES: usize = 30;

/// Number of visits to each of the coarsest grids per visit to the next finer one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Visits {
    Single,
    Double,
}

impl Multigrid {
    /// Applies one cycle in the nested iteration, or more if the residual is still large.
    ///
    /// The two sweeps before the first correction have let the contact set settle.
    pub(super) fn settle(&mut self, l: usize) {
        for _ in 0..MAX_NESTED_CYCLES {
            let smooth = Self::smooth_twice(Correct(OVERCORRECTION));
            self.find_correction(l, DOUBLE_VISITS_BELOW);
            let residual = self.pass_under_law(l, &smooth);
            if residual <= SETTLED * self.levels[l].load_scale {
                break;
            }
        }
    }

    /// Solves the problem under the law of the coarsest grid directly.
    pub(super) fn solve_coarsest(&mut self) {
        self.springs.cells = None;
        let work = self.coarsest.solve_under_law(&mut self.levels[0]);
        self.count(work);
    }

    /// Finds the correction for level `l`, whose residual has been restricted, on the next coarser level. This is the
    /// central function of multigrid; with a pass that adds the correction, smooths, and restricts the new residual, it
    /// is one cycle.
    ///
    /// Grids are visited twice from `double_visits_below` grids below `l` on.
    pub(super) fn find_correction(&mut self, l: usize, double_visits_below: usize) {
        let n = self.levels[l].n;
        if !self.is_balanced(l) {
            self.shift_into_contact(l);
        }
        let (coarser, level) = self.levels.split_at_mut(l);
        let in_contact = &level[0].in_contact;
        if self.springs.cells != Some(n) || self.springs.in_contact != *in_contact {
            let work = set_springs(n, in_contact, coarser);
            let factor = self.coarsest.factor(&coarser[0]);
            self.springs.cells = Some(n);
            self.springs.in_contact.clone_from(in_contact);
            self.count(work + factor);
        }
        self.count(boundary_nodes(n) as f64);
        self.correct(l - 1, l.saturating_sub(double_visits_below), Visits::Double);
    }

    /// Part of the correction for level `l` with the least energy: all of it, a half, a quarter, and so on, or nothing.
    ///
    /// The whole correction may enlarge the energy where the states of many nodes change together. A small part never
    /// does, since the correction descends from the present values.
    pub(super) fn search(&mut self, l: usize) -> f64 {
        let before = self.levels[l].values[Black as usize].to_vec();
        let (mut best, mut least) = (0.0, f64::INFINITY);
        for part in SEARCHED_PARTS {
            self.levels[l].values[Black as usize].copy_from_slice(&before);
            self.pass(l, BoundaryLaw, &[Correct(part * OVERCORRECTION), Relax(Red, 1.0)]);
            let energy = energy(&self.levels[l]);
            if least - energy > ENERGY_ROUNDING * energy.abs() {
                (best, least) = (part, energy);
            }
        }
        self.levels[l].values[Black as usize].copy_from_slice(&before);
        let nodes = self.levels[l].nodes as f64;
        self.count(SEARCHED_PARTS.len() as f64 * nodes);
        best
    }

    /// Applies one cycle to the linear problem of level `l`, from zero. If `visits` is `Double`, coarser problems get
    /// two cycles from level `double_visits_from` down.
    ///
    /// Near-constant modes of semicoercive problems need accurate coarse solutions, and on coarse grids these cost
    /// little.
    fn correct(&mut self, l: usize, double_visits_from: usize, visits: Visits) {
        if l == 0 {
            let work = self.coarsest.solve_linear(&mut self.levels[0]);
            self.count(work);
            return;
        }
        self.pass(l, Correction, &[StartRed(COARSE_RELAXATION), Relax(Black, 1.0), Restrict]);
        self.correct(l - 1, double_visits_from, visits);
        if visits == Visits::Double && l <= double_visits_from {
            self.pass(l, Correction, &Self::smooth_twice(Correct(1.0)));
            self.correct(l - 1, double_visits_from, Visits::Single);
        }
        // Corrections after two cycles, or after a direct solution two grids below, are complete, near-constant modes
        // above all, and must not be enlarged on the finest grid. (That this also holds one grid below costs nothing:
        // otherwise 8 cells take 3 % more cycles, 12 and 28 cells 4 to 8 % less, finer grids as many.)
        let factor = if l == double_visits_from + 1 { 1.0 / OVERCORRECTION } else { 1.0 };
        let last = [Correct(factor), Relax(Red, 1.0), Relax(Black, COARSE_RELAXATION)];
        self.pass(l, Correction, &last);
    }

    /// True if nodes stick, and can balance the load together with those that slip.
    fn is_balanced(&self, l: usize) -> bool {
        let level = &self.levels[l];
        if level.limit.is_infinite() {
            return level.in_contact.contains(&true);
        }
        let mut balance = Balance::default();
        let nodes = contact_nodes(level.n, Law::up_to(self.limit));
        for (ContactNode { node, measure, law }, sticks) in nodes.into_iter().zip(&level.in_contact)
        {
            let state = match sticks {
                true => BoundaryState::Sticks,
                false if level.value(node) < 0.0 => BoundaryState::SlipsDown,
                false => BoundaryState::SlipsUp,
            };
            balance.see(state, [0.0, measure * law.hi()]);
        }
        balance.holds(self.needed)
    }

    /// Subtracts the constant of least energy, and puts the node that the constant [sets to zero](place_at_zero) in
    /// contact.
    ///
    /// With an empty contact set the corrections would be unbounded. Since the flux can balance the load, the solution
    /// is zero somewhere on the boundary.
    fn shift_into_contact(&mut self, l: usize) {
        let (level, law) = (&mut self.levels[l], Law::up_to(self.limit));
        let mut nodes = Vec::with_capacity(level.in_contact.len());
        for (number, contact) in contact_nodes(level.n, law).into_iter().enumerate() {
            let (ends, value) = ([0.0, contact.measure * law.hi()], level.value(contact.node));
            nodes.push(ContactValue { number, ends, value, multiplier: 0.0 });
        }
        let place = place_at_zero(&mut nodes, self.needed);
        let ContactValue { number: at, value: zero, .. } = nodes[place];
        rows::for_each(&mut level.values, |value| *value -= zero);
        let (nodes, has_limit) = (level.nodes as f64, level.limit.is_finite());
        self.count(0.25 * nodes);
        if has_limit {
            // Where values have changed their sign, so has the flux: the residual is another one.
            self.pass_under_law(l, &[Relax(Red, 1.0), Relax(Black, 1.0), Restrict]);
        }
        let in_contact = &mut self.levels[l].in_contact;
        in_contact[at] |= !in_contact.contains(&true);
    }

    /// Runs a pass on the problem under the law, whose last stage restricts; returns the natural residual of the red
    /// nodes.
    pub(super) fn pass_under_law(&mut self, l: usize, stages: &[Stage]) -> f64 {
        self.pass(l, BoundaryLaw, stages).expect("the last stage restricts")
    }

    /// Runs a pass on level `l` and counts its work; returns the natural residual, as [`pass::run`].
    fn pass(&mut self, l: usize, problem: LevelProblem, stages: &[Stage]) -> Option<f64> {
        let (coarse, fine) = self.levels.split_at_mut(l);
        let natural = pass::run(&mut fine[0], &mut coarse[l - 1], problem, stages);
        let nodes = self.levels[l].nodes as f64;
        self.count(pass::work(stages) * nodes);
        natural
    }

    /// Stages between two coarse-grid corrections: post-smoothing of one cycle, pre-smoothing of the next.
    pub(super) fn smooth_twice(from_coarser: Stage) -> [Stage; 6] {
        [
            from_coarser,
            Relax(Red, 1.0),
            Relax(Black, RELAXATION),
            Relax(Red, RELAXATION),
            Relax(Black, 1.0),
            Restrict,
        ]
    }
}
