//! Sums over cells and facets: energies of w and of the flux, and the distance between them.

use super::cells::{Cells, at_nodes, gradient, interval};
use super::excess::excess;
use super::given::missing;
use super::linear::{at_vertices, largest_square, outflows, product};
use crate::bounds::boundary::{Slips, mean_product};
use crate::machine::threads::in_tasks;
use crate::mesh::{
    BoundarySide, Element, Facet, Mesh, MeshLoad, Sides, difference, dot, measure, size, sorted,
};
use crate::problem::law::Law;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Number of cells that are added one after the other; longer sums are halved, so that chains of additions stay short.
const RUN: usize = 64;
/// Numbers whose work takes as long as that on a cell.
const COST: usize = 16;

/// Upper bound of the number of roundings between the data and a sum: within a cell, and along a chain of additions.
const ROUNDINGS: f64 = 256.0;

/// Sums over cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    /// Integral of `|k grad w - sigma|^2 / k`, with the deviation of f, and of `c (w - q)^2`.
    ///
    /// On each cell `c q` is the mean of f less the reaction, which the flux says.
    pub distance: f64,
    /// Integral of `|sigma|^2 / k`, with the deviation of f, and of `c q^2`.
    pub flux: f64,
    /// Square of the energy norm of w: the integral of `k |grad w|^2 + c w^2`.
    pub gradient: f64,
    /// Integral of the means of f times w.
    pub load: f64,
    /// Upper bound of the integral of f less its means, times w.
    pub deviation: f64,
    /// Square of the energy norm of y - w, y the vector that was given.
    pub projection: f64,
    /// Integral of `j(w) + (w - at) sigma.n` over the boundary without free parts; for the paper's law the work of the
    /// reactions.
    pub work: f64,
    /// Integral of `(w - at) sigma.n` there.
    pub through: f64,
    /// Integral of j(w) there.
    pub potential: f64,
    /// Integral of `at sigma.n` there.
    pub of_values: f64,
    /// Integral of the flux of free parts times w over them.
    pub given: f64,
    /// Square of the energy norm of E, by which w is changed where values of laws are formulas; see `excess.rs`.
    pub excess: f64,
    /// Integral of |f|, its means.
    pub mass: f64,
    /// Sum of absolute values inside, of which rounding errors are a small part.
    magnitude: f64,
    /// Sum of absolute values of the law's terms on the boundary.
    boundary_magnitude: f64,
    /// Sum of the absolute values of the fluxes.
    flow: f64,
}

impl Totals {
    fn add(self, other: Self) -> Self {
        Self {
            distance: self.distance + other.distance,
            flux: self.flux + other.flux,
            gradient: self.gradient + other.gradient,
            load: self.load + other.load,
            deviation: self.deviation + other.deviation,
            projection: self.projection + other.projection,
            work: self.work + other.work,
            through: self.through + other.through,
            potential: self.potential + other.potential,
            of_values: self.of_values + other.of_values,
            given: self.given + other.given,
            excess: self.excess + other.excess,
            mass: self.mass + other.mass,
            magnitude: self.magnitude + other.magnitude,
            boundary_magnitude: self.boundary_magnitude + other.boundary_magnitude,
            flow: self.flow + other.flow,
        }
    }

    /// Upper bound of the rounding errors of energies; `largest` is the largest |w|, and |at|, on which a flux does
    /// work that is not balanced to the last digit.
    pub(super) fn rounding(&self, largest: f64) -> f64 {
        let of_law = f64::EPSILON * ROUNDINGS * (self.boundary_magnitude + self.work);
        self.rounding_of_flux(largest) + of_law
    }

    /// Upper bound of the rounding errors of `|sigma|^2`, to which the law's terms contribute nothing; `largest` as in
    /// [`Self::rounding`].
    pub(super) fn rounding_of_flux(&self, largest: f64) -> f64 {
        f64::EPSILON * (ROUNDINGS * self.magnitude + 8.0 * largest * self.flow)
    }
}

/// Functions and fluxes that are summed.
#[derive(Clone, Copy)]
pub(super) struct Summands<'a, const D: usize, const V: usize, const N: usize> {
    pub mesh: &'a Mesh<D, V>,
    pub sides: &'a Sides<V>,
    pub f: &'a MeshLoad,
    /// Nodal vector that was given.
    pub y: &'a [f64],
    /// Nodal vector in K.
    pub w: &'a [f64],
    /// Fluxes through all sides: as [`SideFlux`](super::linear::SideFlux) in the plane, one number for each in space.
    pub flux: &'a [[f64; N]],
}

impl<const D: usize, const V: usize, const N: usize> Summands<'_, D, V, N> {
    /// Sums over all cells and facets, and the square of the guaranteed error in each cell: of the distance, and twice
    /// the work on the facets in contact.
    pub(super) fn totals(&self) -> (Totals, Vec<f64>) {
        let mut squares = vec![0.0; self.mesh.cells().len()];
        let missing = missing(self.mesh, self.sides);
        let runs = in_tasks(squares.par_chunks_mut(RUN).enumerate(), COST * RUN);
        let of_runs = runs.map(|(run, squares)| {
            let mut totals = Totals::default();
            for (cell, square) in (RUN * run..).zip(squares) {
                let of_cell = self.of_cell(cell, missing.get(&(cell as u32)));
                *square = of_cell.distance;
                totals = totals.add(of_cell);
            }
            totals
        });
        let of_runs: Vec<Totals> = of_runs.collect();
        let mut of_facets = Vec::new();
        for (cell, totals) in self.boundary() {
            squares[cell as usize] += 2.0 * totals.work;
            of_facets.push(totals);
        }
        of_facets.extend(self.excess(&missing, &mut squares));
        (halved_sum(&of_runs).add(halved_sum(&of_facets)), squares)
    }

    /// Largest |w|, with the largest value of a law.
    pub(super) fn largest(&self) -> f64 {
        let largest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0f64, f64::max);
        largest(&mut self.w.iter().map(|value| value.abs())) + largest(&mut self.values())
    }

    /// True if the law of a part has a value that is not 0.
    pub(super) fn has_values(&self) -> bool {
        self.values().any(|value| value != 0.0)
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let of_formulas =
            self.mesh.facets().iter().filter(|facet| self.mesh.value(facet.part).is_some());
        let of_formulas = of_formulas.flat_map(|facet| facet.nodes.map(|node| (facet, node)));
        let of_formulas = of_formulas.map(|(facet, node)| self.mesh.law_at(facet, node).at().abs());
        self.mesh.parts().iter().map(|part| part.law.at().abs()).chain(of_formulas)
    }

    /// Terms that the functions E of `excess.rs` add, also to the squares of the errors in the cells.
    fn excess(&self, missing: &BTreeMap<u32, f64>, squares: &mut [f64]) -> Vec<Totals> {
        let mut of_cells: BTreeMap<u32, f64> = BTreeMap::new();
        let mut terms = Vec::new();
        if self.mesh.values.is_empty() {
            return terms;
        }
        for (facet, at) in self.mesh.facets().iter().zip(self.sides.of_facets()) {
            let Some(value) = self.mesh.value(facet.part) else { continue };
            if self.mesh.law(facet).is_free() {
                continue;
            }
            let cells = Cells { mesh: self.mesh, w: self.w, f: &self.f.cells };
            let found = excess(&cells, self.sides, self.flux, (facet, at, value));
            let cell = at.cell as usize;
            let vertices = self.mesh.vertices(&self.mesh.cells()[cell]);
            let deviation = self.f.cells.deviation.as_ref().map_or(0.0, |all| all[cell]);
            let field = poincare(deviation, vertices, self.mesh.k(cell));
            let is_exact = field == 0.0 && !missing.contains_key(&at.cell);
            // Two facets of a cell: the product of their functions is at most that of the norms.
            let norm = found.square.sqrt();
            let before = of_cells.entry(at.cell).or_default();
            let square = found.square + 2.0 * norm * *before;
            *before += norm;
            let distance = match is_exact {
                true => 2.0 * found.with_distance + square,
                false => 2.0 * norm * squares[cell].max(0.0).sqrt() + square,
            };
            squares[cell] += distance;
            terms.push(Totals {
                distance,
                gradient: 2.0 * found.with_gradient + square,
                load: self.f.cells.mean[cell] * found.integral,
                deviation: field * norm,
                of_values: found.of_value,
                excess: square,
                magnitude: distance.abs() + square,
                ..Totals::default()
            });
        }
        terms
    }

    /// Integral of f and of the flux of free parts times w, if f is not constant on cells but on shapes, so that its
    /// load vector is exact.
    pub(super) fn exact_load(&self) -> Option<f64> {
        let is_exact = self.f.cells.deviation.is_some() && self.f.unsettled.is_none();
        // The integral of f times E is known by the means alone.
        let is_exact = is_exact && !self.mesh.has_values_by_formulas();
        is_exact.then(|| halved_product(&self.f.load, self.w))
    }

    /// Ends of the intervals of the laws that the flux through the boundary reaches; finite ends of intervals that are
    /// not bounded count as reached.
    pub(super) fn slips(&self) -> Slips {
        let mut slips = Slips { up: false, down: false };
        for (facet, &BoundarySide { side, .. }) in self.contact() {
            let law = self.mesh.law(facet);
            let part = interval(self.mesh, facet);
            let (flux, is_open) = (self.flux[side as usize], !law.is_bounded());
            slips.up |= law.lo().is_finite() && (is_open || flux.iter().all(|q| *q <= part.least));
            slips.down |= law.hi().is_finite() && (is_open || flux.iter().all(|q| *q >= part.most));
        }
        slips
    }

    /// Facets that are neither free nor fixed, with their sides.
    fn contact(&self) -> impl Iterator<Item = (&Facet<D>, &BoundarySide)> {
        let facets = self.mesh.facets().iter().zip(self.sides.of_facets());
        facets.filter(|(facet, _)| self.mesh.law(facet).may_move())
    }

    fn of_cell(&self, cell: usize, missing: Option<&f64>) -> Totals {
        let nodes = &self.mesh.cells()[cell];
        let vertices = self.mesh.vertices(nodes);
        let element = Element::new(vertices);
        let volume = element.volume;
        let w = at_nodes(nodes, self.w);
        let slope = gradient(&element, w);
        let outflows = outflows(self.sides, cell as u32, nodes, self.flux);
        let sigma = at_vertices(&vertices, volume, &outflows);
        let k = self.mesh.k(cell);
        let inverse = 1.0 / k;
        let mut difference = sigma;
        for value in &mut difference {
            (0..D).for_each(|d| value[d] -= k * slope[d]);
        }
        let mean = self.f.cells.mean[cell];
        let deviation = self.f.cells.deviation.as_ref().map_or(0.0, |all| all[cell]);
        let field = poincare(deviation, vertices, k);
        let longer = field + missing.copied().unwrap_or_default();
        let gradient_square = k * volume * dot(slope, slope);
        let highest = w.iter().fold(0.0f64, |highest, value| highest.max(value.abs()));
        // The square of a sum is at most the sum of the squares times their number.
        let slopes =
            element.gradients.iter().zip(w).map(|(g, v)| dot(*g, *g) * (v - w[0]) * (v - w[0]));
        let steepest = V as f64 * slopes.sum::<f64>();
        let flow = outflows.as_flattened().iter().map(|q| q.abs()).sum::<f64>() / D as f64;
        let [of_distance, of_flux, of_w, of_rounding] = match self.mesh.reaction {
            0.0 => [0.0; 4],
            c => {
                let outflow = outflows.as_flattened().iter().sum::<f64>() / D as f64;
                let q = (mean + outflow / volume) / c;
                let from = w.map(|w| w - q);
                let squares = [mean_product(from, from), q * q, mean_product(w, w)];
                let [of_distance, of_flux, of_w] = squares.map(|mean| c * volume * mean);
                let of_q = q.abs() * (mean.abs() * volume + flow);
                [of_distance, of_flux, of_w, 2.0 * (of_w + of_flux) + of_q]
            }
        };
        Totals {
            distance: longer_square(inverse * product(volume, &difference, &difference), longer)
                + of_distance,
            flux: longer_square(inverse * product(volume, &sigma, &sigma), longer) + of_flux,
            gradient: gradient_square + of_w,
            load: mean * volume * (w.iter().sum::<f64>() / V as f64),
            deviation: if field == 0.0 { 0.0 } else { field * gradient_square.sqrt() },
            projection: self.projection(cell, &element, w),
            mass: mean.abs() * volume,
            magnitude: volume * (k * steepest + mean.abs() * highest)
                + deviation * volume.sqrt() * highest
                + longer_square(inverse * largest_square(&vertices, volume, &outflows), longer)
                + of_rounding,
            flow,
            ..Totals::default()
        }
    }

    /// Square of the energy norm of y - w in a cell.
    fn projection(&self, cell: usize, element: &Element<D, V>, w: [f64; V]) -> f64 {
        let y = at_nodes(&self.mesh.cells()[cell], self.y);
        if y == w {
            return 0.0;
        }
        energy_square(self.mesh, cell, element, difference(y, w))
    }

    /// Integrals over the facets with a law, each with its cell, but over those where v or its flux is 0.
    fn boundary(&self) -> Vec<(u32, Totals)> {
        let mut terms = Vec::new();
        for (facet, &BoundarySide { side, cell }) in
            self.mesh.facets().iter().zip(self.sides.of_facets())
        {
            let law = self.mesh.law(facet);
            if [Law::FREE, Law::FIXED].contains(&law) {
                continue;
            }
            let interval = interval(self.mesh, facet);
            let nodes = sorted(facet.nodes);
            let at = nodes.map(|node| self.mesh.law_at(facet, node).at());
            let w = difference(nodes.map(|node| self.w[node as usize]), at);
            let farthest = at.iter().fold(0.0f64, |farthest, at| farthest.max(at.abs()));
            let highest = w.iter().fold(0.0f64, |highest, value| highest.max(value.abs()));
            let flux = std::array::from_fn(|k| self.flux[side as usize][k.min(N - 1)]);
            let is_formula = self.mesh.value(facet.part).is_some();
            let totals = match law.is_free() {
                true if is_formula => {
                    let measure = measure(self.mesh.corners(facet)) / D as f64;
                    let shares = nodes.map(|node| measure * self.mesh.law_at(facet, node).lo());
                    Totals {
                        given: shares.iter().zip(w).map(|(share, w)| share * w).sum(),
                        magnitude: shares.iter().map(|share| share.abs()).sum::<f64>() * highest,
                        ..Totals::default()
                    }
                }
                true => Totals {
                    given: mean_product(w, flux),
                    magnitude: interval.least.abs() * highest,
                    ..Totals::default()
                },
                false => Totals {
                    work: interval.work_of_facet(w, flux),
                    through: mean_product(w, flux),
                    potential: interval.potential(w, 0.0),
                    // The functions E have the integral for a formula.
                    of_values: match is_formula {
                        true => 0.0,
                        false => law.at() * (flux.iter().sum::<f64>() / D as f64),
                    },
                    boundary_magnitude: 2.0 * interval.ends_in_use(&w) * highest,
                    magnitude: farthest * flux.iter().map(|flux| flux.abs()).sum::<f64>(),
                    ..Totals::default()
                },
            };
            terms.push((cell, totals));
        }
        terms
    }
}

/// Sum with short chains of additions.
fn halved_sum(terms: &[Totals]) -> Totals {
    if terms.len() <= RUN {
        return terms.iter().fold(Totals::default(), |totals, term| totals.add(*term));
    }
    let (one, two) = terms.split_at(terms.len() / 2);
    halved_sum(one).add(halved_sum(two))
}

/// Scalar product with short chains of additions.
fn halved_product(a: &[f64], b: &[f64]) -> f64 {
    if a.len() <= RUN {
        return a.iter().zip(b).map(|(a, b)| a * b).sum();
    }
    let ((a, more_a), (b, more_b)) = (a.split_at(a.len() / 2), b.split_at(a.len() / 2));
    halved_product(a, b) + halved_product(more_a, more_b)
}

/// Square of the energy norm, on a cell, of the linear function with these values at the vertices.
pub(super) fn energy_square<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    cell: usize,
    element: &Element<D, V>,
    values: [f64; V],
) -> f64 {
    let slope = element.gradient(values);
    let square = mesh.k(cell) * element.volume * dot(slope, slope);
    match mesh.reaction {
        0.0 => square,
        c => square + c * element.volume * mean_product(values, values),
    }
}

/// Norm, over the root of k, of a field on a cell whose divergence is the difference of f from its mean there, with
/// this `deviation`: Poincaré's constant on a convex cell is the diameter over pi.
fn poincare<const D: usize, const V: usize>(
    deviation: f64,
    vertices: [[f64; D]; V],
    k: f64,
) -> f64 {
    if deviation == 0.0 { 0.0 } else { deviation * size(vertices) / (PI * k.sqrt()) }
}

/// Square of the sum of a length, given by its square, and another.
fn longer_square(square: f64, more: f64) -> f64 {
    if more == 0.0 { square } else { (square.sqrt() + more).powi(2) }
}
