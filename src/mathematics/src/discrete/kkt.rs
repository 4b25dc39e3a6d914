//! One measure for every solver: how far a nodal vector is from the Karush-Kuhn-Tucker conditions.

use crate::discrete::domain::DiscreteDomain;
use crate::discrete::grid::Grid;
use crate::discrete::network::Network;
use crate::discrete::stiffness::residual_row;
use crate::machine::extremes::{max_or_nan, min_or_nan, range};
use crate::machine::simd::Largest;
use crate::problem::law::{BoundaryState, ContactNode};
use serde::{Deserialize, Serialize};

/// Violations of the conditions: `A y = F` inside, and the [law](crate::problem::law::Law) on the boundary; for the
/// paper's law `y >= 0` and `A y - F >= 0`, complementary.
///
/// Computed from `y` and `F` alone: the multiplier of node i is the discrete flux `(A y - F)_i / h`,
/// whatever multiplier a solver carried along.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kkt {
    /// Largest `|A y - F|` over interior nodes, in units of F.
    pub stationarity: f64,
    /// Least y, less the value `at` of the law, on the boundary where the law holds; none where it holds at no node.
    pub min_y: Option<f64>,
    /// Least multiplier there.
    pub min_lambda: Option<f64>,
    /// Largest natural residual of the law over boundary nodes, for the paper's law `|min(y, A y - F)|`.
    pub complementarity: f64,
    /// `max(stationarity, complementarity)`, the natural residual: zero at the solution only.
    pub natural: f64,
    /// `natural` over the largest load, or the size of values where there is none; invariant under scaling of all data.
    pub relative: f64,
}

/// Numbers of boundary nodes by their states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct StateCounts {
    /// Nodes at the value of the law; under the paper's law, in contact.
    pub sticks: usize,
    /// Nodes where v is above it.
    pub slips_up: usize,
    /// Nodes where v is below it.
    pub slips_down: usize,
}

impl StateCounts {
    /// Counts a node in this state.
    pub(crate) fn add(&mut self, state: BoundaryState) {
        match state {
            BoundaryState::Sticks => self.sticks += 1,
            BoundaryState::SlipsUp => self.slips_up += 1,
            BoundaryState::SlipsDown => self.slips_down += 1,
        }
    }

    /// All nodes.
    pub fn all(self) -> usize {
        self.sticks + self.slips_up + self.slips_down
    }
}

/// Judgement of a nodal vector, from it and the load vector alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Residuals of the conditions.
    pub kkt: Kkt,
    /// `1/2 <A y, y> - <F, y>` and the law's term.
    pub energy: f64,
    /// Sum over the boundary nodes of the flux times the values of the laws; none where all of these are zero.
    pub of_values: Option<f64>,
    /// Boundary nodes where the law holds, in the order of a boundary vector.
    pub contact: Vec<ContactNode>,
    /// `A y - F` at these nodes.
    pub flux: Vec<f64>,
    /// Sum over the boundary nodes of y - `at` times the flux, and of the law's term of the energy: zero at the
    /// solution, and elsewhere, if all other conditions hold, a bound of the energy's error.
    pub work: f64,
    /// State of each boundary node, in the order of the flux; rounding errors do not count.
    pub states: Vec<BoundaryState>,
    /// Up to this, values of y and of the flux are [`rounding`] errors.
    pub rounding: f64,
    /// Least and greatest nodal value.
    pub range: [f64; 2],
}

impl Judgement {
    /// Contact at the boundary nodes, in the order of the flux: the nodes that stick. Under the paper's law, where the
    /// flux is no less than `y`, up to rounding errors; both are zero in a corner without load between nodes in
    /// contact.
    pub fn in_contact(&self) -> Vec<bool> {
        self.states.iter().map(|state| *state == BoundaryState::Sticks).collect()
    }

    /// Numbers of boundary nodes by their states.
    pub fn state_counts(&self) -> StateCounts {
        let mut counts = StateCounts::default();
        self.states.iter().for_each(|state| counts.add(*state));
        counts
    }

    /// Total flux through the boundary where the law holds: the sum of the flux over the nodes that stick, and of the
    /// law's over the others.
    pub fn force(&self) -> f64 {
        (0..self.states.len())
            .fold(0.0, |force, place| force + self.flux_at(place).unwrap_or_default())
    }

    /// Flux at the boundary node of this place: that of the vector where it sticks, else the law's; none where no law
    /// moves.
    pub(crate) fn flux_at(&self, place: usize) -> Option<f64> {
        let ContactNode { measure, law, .. } = self.contact.get(place)?;
        Some(match self.states[place] {
            BoundaryState::Sticks => self.flux[place],
            BoundaryState::SlipsUp => measure * law.lo(),
            BoundaryState::SlipsDown => measure * law.hi(),
        })
    }

    /// Length or area of the boundary at the nodes in contact.
    pub fn area_in_contact(&self) -> f64 {
        let nodes = self.contact.iter().zip(self.in_contact());
        nodes.filter(|(_, is_held)| *is_held).fold(0.0, |sum, (node, _)| sum + node.measure)
    }

    /// Length or area of the boundary where the law holds.
    pub fn perimeter(&self) -> f64 {
        self.contact.iter().map(|contact| contact.measure).sum()
    }

    /// The multiplier at the boundary nodes for the nodal vector `y` that was judged: the flux over the measure of the
    /// node, an end of the law's interval where the flux of a solution is that end but for rounding errors.
    pub fn multiplier(&self, y: &[f64]) -> Vec<f64> {
        let of_node = |(&ContactNode { node, measure, law }, flux): (&ContactNode, &f64)| {
            let [above_lo, above_hi] = law.above_ends(*flux, measure);
            let from = y[node] - law.at();
            if above_lo - from <= self.rounding {
                law.lo()
            } else if above_hi - from >= -self.rounding {
                law.hi()
            } else {
                law.project(flux / measure)
            }
        };
        self.contact.iter().zip(&self.flux).map(of_node).collect()
    }
}

/// Size of rounding errors in a solution whose `largest` absolute value, of y and of the flux, this is, on a grid with
/// `cells` cells per side: `cells` units in the last place of it.
///
/// However a solver ends, each row of `A y = F` is left open by about one such unit, with either sign. The inverse
/// `G` of A sums the rows up, independent as they are, to the root of the sum of `G_ij^2`, which is below `cells`: on
/// the square `G` falls like a logarithm, on the cube like `1 / |i - j|`.
pub fn rounding(cells: usize, largest: f64) -> f64 {
    cells as f64 * f64::EPSILON * largest
}

/// Judges the nodal vector `y` for the load vector `load`.
///
/// # Panics
/// If a slice is not a nodal vector of the domain.
pub fn judge<'a>(domain: impl Into<DiscreteDomain<'a>>, y: &[f64], load: &[f64]) -> Judgement {
    let domain = domain.into();
    assert!(y.len() == domain.nodes() && load.len() == y.len());
    let Seen { mut energy, mut of_values, stationarity, flux } = match domain {
        DiscreteDomain::Grid(grid, _) => Seen::on_grid(grid, y, load),
        DiscreteDomain::Network(network) => Seen::on_network(network, y, load),
    };
    let contact = domain.contact().into_owned();
    let (mut min_y, mut min_lambda, mut work) = (None, None, 0.0);
    let least =
        |known: Option<f64>, value| Some(known.map_or(value, |known| min_or_nan(known, value)));
    let mut complementarity = Largest::default();
    for (flux, &ContactNode { node, measure, law }) in flux.iter().zip(&contact) {
        let potential = measure * law.potential(y[node]);
        let from = y[node] - law.at();
        if law.at() != 0.0 {
            *of_values.get_or_insert(0.0) += flux * law.at();
        }
        min_y = least(min_y, from);
        min_lambda = least(min_lambda, flux / measure);
        complementarity.put(law.residual(y[node], *flux, measure));
        energy += potential;
        work += from * flux + potential;
    }
    let mut largest = Largest::default();
    largest.see(1.0, y);
    largest.see(1.0, &flux);
    let rounding = rounding(domain.width(), largest.value());
    let of_node = |(flux, contact): (&f64, &ContactNode)| {
        contact.law.state(y[contact.node], *flux, contact.measure, rounding)
    };
    let states = flux.iter().zip(&contact).map(of_node).collect();
    let [stationarity, complementarity] = [stationarity, complementarity].map(Largest::value);
    let natural = max_or_nan(stationarity, complementarity);
    let relative = if natural == 0.0 { 0.0 } else { natural / domain.unit(load) };
    let kkt = Kkt { stationarity, min_y, min_lambda, complementarity, natural, relative };
    Judgement { kkt, energy, of_values, contact, flux, work, states, rounding, range: range(y) }
}

/// True if the discrete problem with this load vector has a solution: over each connected component, y is given at some
/// nodes, or the flux through the boundary can balance the load.
///
/// # Panics
/// If the load is not a nodal vector of the domain.
pub fn has_solution<'a>(domain: impl Into<DiscreteDomain<'a>>, load: &[f64]) -> bool {
    domain.into().components(load).into_iter().all(|component| component.check(0.0).is_ok())
}

/// Energy and residuals over all rows of the matrix.
struct Seen {
    /// Energy without the law's term.
    energy: f64,
    /// Sum of `A y - F` times the values of the laws where y is given; none where all of these are zero.
    of_values: Option<f64>,
    /// Residuals at the nodes where the law does not hold.
    stationarity: Largest,
    /// `A y - F` at the boundary nodes where it holds.
    flux: Vec<f64>,
}

impl Seen {
    fn on_grid(grid: Grid, y: &[f64], load: &[f64]) -> Self {
        let (n, side) = (grid.cells(), grid.side());
        let (mut gradient, mut flux) = (vec![0.0; side], vec![0.0; grid.boundary_nodes()]);
        let (mut energy, mut stationarity) = (0.0, Largest::default());
        let rows = y.chunks_exact(side).zip(load.chunks_exact(side));
        for (j, (y_row, load_row)) in rows.enumerate() {
            residual_row(grid, j, y, load, &mut gradient);
            let nodes = y_row.iter().zip(&gradient).zip(load_row);
            energy = nodes.fold(energy, |sum, ((y, g), f)| sum + 0.5 * y * (g - f));
            let is_inner = j % n > 0;
            if is_inner {
                stationarity.see(1.0, &gradient[1..n]);
            }
            for i in (0..side).step_by(if is_inner { n } else { 1 }) {
                flux[grid.boundary_index(i, j)] = gradient[i];
            }
        }
        Self { energy, of_values: None, stationarity, flux }
    }

    /// The difference from the value of a fixed node counts as a residual.
    fn on_network(network: &Network, y: &[f64], load: &[f64]) -> Self {
        let (mut gradient, mut stationarity) = (vec![0.0; y.len()], Largest::default());
        network.gradient(y, load, &mut gradient);
        let mut flux = Vec::with_capacity(network.contact().len());
        for contact in network.contact() {
            flux.push(std::mem::take(&mut gradient[contact.node]));
        }
        let mut of_values = None;
        for &ContactNode { node, law, .. } in network.held() {
            if law.at() != 0.0 {
                *of_values.get_or_insert(0.0) += gradient[node] * law.at();
            }
            gradient[node] = y[node] - law.at();
        }
        stationarity.see(1.0, &gradient);
        let energy = network.energy(y, load) + network.potential();
        let of_values = of_values.map(|of_values: f64| of_values + network.potential());
        Self { energy, of_values, stationarity, flux }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::law::Law;

    fn kkt(grid: Grid, y: &[f64], load: &[f64]) -> Kkt {
        judge((grid, Law::SIGNORINI), y, load).kkt
    }

    #[test]
    fn each_violation_is_seen_where_it_is() {
        let grid = Grid::new(2).unwrap();
        let mut load = vec![0.0; 9];
        load[4] = -1.0;
        let mut y = vec![0.0; 9];
        y[4] = -0.25;
        let solved = kkt(grid, &y, &load);
        assert_eq!((solved.natural, solved.min_y, solved.min_lambda), (0.0, Some(0.0), Some(0.0)));
        y[4] = 0.0;
        assert_eq!(kkt(grid, &y, &load).stationarity, 1.0);
        y[4] = -0.25;
        y[1] = -0.5;
        let infeasible = kkt(grid, &y, &load);
        assert_eq!(infeasible.min_y, Some(-0.5));
        assert!(infeasible.complementarity >= 0.5);
        load[3] = 7.0;
        assert!(kkt(grid, &y, &load).min_lambda.unwrap() < -6.0);
    }

    #[test]
    fn nan_is_never_hidden() {
        let grid = Grid::new(2).unwrap();
        for node in [0, 4] {
            let mut y = vec![0.0; 9];
            y[node] = f64::NAN;
            assert!(kkt(grid, &y, &[1.0; 9]).natural.is_nan());
            let mut load = [1.0; 9];
            load[node] = f64::NAN;
            assert!(kkt(grid, &[0.0; 9], &load).natural.is_nan());
        }
    }
}
