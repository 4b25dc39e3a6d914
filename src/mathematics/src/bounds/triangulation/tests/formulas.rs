//! Values of laws by formulas: bounds beside integrals of the function that they are about, by its definition.

use super::*;
use crate::mesh::{AnyMesh, PlaneMesh, dot, measure, mesh_load, square_with_sides};
use crate::problem::formula::Formula;
use crate::problem::source::Source;
use std::f64::consts::PI;

/// Square of eight cells with values by formulas at the bottom, an obstacle with a flux, and on a fixed side; sides
/// beside them that have none have a given flux.
fn square_with_formulas([fixed, value]: [&str; 2]) -> PlaneMesh {
    let mut mesh = AnyMesh::from(square_with_sides(2));
    let laws =
        [("bottom", Law::above(0.0, -0.5)), ("left", Law::free(0.3)), ("right", Law::free(0.2))];
    for (part, law) in laws {
        if part != fixed {
            mesh.set_law(part, law.unwrap()).unwrap();
        }
    }
    mesh.set_value("bottom", "x - x^2").unwrap();
    mesh.set_law(fixed, Law::FIXED).unwrap();
    mesh.set_value(fixed, value).unwrap();
    mesh.plane().unwrap().clone()
}

/// Function w + E on a cell with the corners, w there, and the formulas on sides, each by the opposite corner.
struct OnCell<'a> {
    corners: [[f64; 2]; 3],
    w: [f64; 3],
    values: Vec<(usize, &'a Formula)>,
}

impl OnCell<'_> {
    /// w + E at a point by the definition of E: `t e(q)` on the ray from the opposite corner through q.
    fn at(&self, x: [f64; 2]) -> f64 {
        let element = Element::new(self.corners);
        let shares: [f64; 3] = std::array::from_fn(|k| {
            1.0 + dot(element.gradients[k], [0, 1].map(|d| x[d] - self.corners[k][d]))
        });
        let mut sum: f64 = shares.iter().zip(self.w).map(|(share, w)| share * w).sum();
        for &(top, value) in &self.values {
            let t = 1.0 - shares[top];
            if t.abs() < 1e-9 {
                continue;
            }
            let [from, to] = [1, 2].map(|step| self.corners[(top + step) % 3]);
            let s = shares[(top + 2) % 3] / t;
            let q = [0, 1].map(|d| from[d] + s * (to[d] - from[d]));
            sum += t * (value.at(&q) - (1.0 - s) * value.at(&from) - s * value.at(&to));
        }
        sum
    }

    /// Integrals of the function, of the square of its gradient, and of the square of that of E.
    fn integrals(&self) -> [f64; 3] {
        const POINTS: usize = 60;
        const STEP: f64 = 1e-5;
        let element = Element::new(self.corners);
        let slope = element.gradient(self.w);
        let first = self.values.first().map_or(0, |(top, _)| *top);
        let [top, from, to] = [0, 1, 2].map(|step| self.corners[(first + step) % 3]);
        let simpson = |k: usize| match k {
            0 | POINTS => 1.0 / (3 * POINTS) as f64,
            _ => [2.0, 4.0][k % 2] / (3 * POINTS) as f64,
        };
        let mut sums = [0.0; 3];
        for (i, j) in (0..=POINTS).flat_map(|i| (1..=POINTS).map(move |j| (i, j))) {
            let [s, t] = [i, j].map(|k| k as f64 / POINTS as f64);
            let x = [0, 1].map(|d| top[d] + t * (from[d] + s * (to[d] - from[d]) - top[d]));
            let gradient = [[STEP, 0.0], [0.0, STEP]].map(|step| {
                let [less, more] =
                    [-1.0, 1.0].map(|sign| self.at([0, 1].map(|d| x[d] + sign * step[d])));
                (more - less) / (2.0 * STEP)
            });
            let weight = 2.0 * element.volume * t * simpson(i) * simpson(j);
            let of_e = [gradient[0] - slope[0], gradient[1] - slope[1]];
            let terms = [self.at(x), dot(gradient, gradient), dot(of_e, of_e)];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        }
        sums
    }
}

/// Ends of the energy and the bound of the error for a vector and f, beside the energy of w + E, with what the
/// deviation of f adds to it, and the norm of the gradient of E.
fn bounds_and_integrals(mesh: &PlaneMesh, f: &str) -> ([f64; 2], f64, f64, f64) {
    let (network, sides) = (assemble(mesh), Sides::new(mesh));
    // Above the obstacle by other distances at the nodes, and any values inside.
    let mut w: Vec<f64> = (0..mesh.points().len()).map(|k| ((7 * k) % 5) as f64 - 2.0).collect();
    for of in network.boundary() {
        let above = if of.law.is_fixed() { 0.0 } else { 0.1 * (of.node % 3) as f64 };
        w[of.node] = of.law.at() + above;
    }
    let f: Source = f.parse().unwrap();
    let f = mesh_load(mesh, &[f][..]).unwrap();
    let (mut energy, mut of_e) = (0.0, 0.0);
    for (number, nodes) in mesh.cells().iter().enumerate() {
        let mut values = Vec::new();
        for (facet, at) in mesh.facets().iter().zip(sides.of_facets()) {
            let value = mesh.value(facet.part).filter(|_| at.cell as usize == number);
            values.extend(value.map(|value| (sides.slot(at.cell, at.side), value)));
        }
        let corners = nodes.map(|node| mesh.points()[node as usize]);
        let on_cell = OnCell { corners, w: nodes.map(|node| w[node as usize]), values };
        let [integral, square, excess] = on_cell.integrals();
        energy += 0.5 * square - f.cells.mean[number] * integral;
        of_e += excess;
        if let Some(deviations) = &f.cells.deviation {
            let slope = Element::new(corners).gradient(on_cell.w);
            let norms = (volume(corners) * dot(slope, slope)).sqrt() + excess.sqrt();
            energy += deviations[number] * size(corners) / PI * norms;
        }
    }
    for facet in mesh.facets() {
        let law = mesh.law(facet);
        let flux = if law.lo().is_finite() { law.lo() } else { 0.0 };
        let [one, two] = facet.nodes.map(|node| w[node as usize] - mesh.law_at(facet, node).at());
        energy -= flux * measure(mesh.corners(facet)) * (one + two) / 2.0;
    }
    let problem = BoundedProblem { mesh, sides: &sides, network: &network, f: &f };
    let (found, _) = problem.bounds_through(&w, &w, &OnceLock::new()).unwrap();
    let bounds = found.unwrap().bounds;
    (bounds.energy, bounds.error[1], energy, of_e.sqrt())
}

#[test]
fn the_upper_end_is_the_energy_with_the_values_of_the_formulas() {
    let mesh = square_with_formulas(["top", "1 + 2*x^2 + 0.1*x"]);
    let nearly_constant = ["formula(50 + 1e-9*x)", "formula(1e-9*x - 50)"];
    for f in ["else=50", "formula(50 + 400*x*y)"].into_iter().chain(nearly_constant) {
        let ([low, high], error, energy, of_e) = bounds_and_integrals(&mesh, f);
        assert!((high - energy).abs() < 1e-6 * energy.abs(), "{f}: {high} {energy}");
        // Both ends are as far apart as the identity says; where f is not constant, no farther.
        let apart = 0.5 * (error - of_e).powi(2);
        let allowed = 1e-6 * apart;
        if f == "else=50" {
            assert!((high - low - apart).abs() < allowed, "{low} {high} {apart}");
        } else if nearly_constant.contains(&f) {
            assert!(high - low < apart + allowed, "{f}: {low} {high} {apart}");
        }
    }
}

#[test]
fn the_upper_end_is_above_the_energy_where_a_cell_has_two_sides_with_formulas() {
    for value in ["0.5 - y^2", "y^2"] {
        let mesh = square_with_formulas(["right", value]);
        let ([_, high], _, energy, _) = bounds_and_integrals(&mesh, "else=1");
        assert!(high >= energy - 1e-6, "{value}: {high} {energy}");
    }
}
