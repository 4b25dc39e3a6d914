//! Rounding errors: those of energies are at most what is added for them, and a flux that they put out of the law is
//! refused.

use super::{TestProblem, check_law, constant_on_cells, noise, square};
use crate::bounds::triangulation::cells::Cells;
use crate::bounds::triangulation::linear::SideFlux;
use crate::bounds::triangulation::sums::{Summands, Totals};
use crate::bounds::triangulation::{NoBound, equilibrated};
use crate::mesh::Sides;
use crate::problem::law::Law;
use std::sync::OnceLock;

/// A number with few digits, so that three times it has no rounding error.
fn short(value: f64) -> f64 {
    const UNIT: f64 = (1u64 << 40) as f64;
    (value * UNIT).trunc() / UNIT
}

/// Sums of a vector in K and a flux, and the largest value of the vector.
fn totals(problem: &TestProblem<2, 3>, flux: &[SideFlux<2>]) -> (Totals, f64) {
    let TestProblem { mesh, f, y, .. } = problem;
    let sides = Sides::new(mesh);
    let (totals, _) = Summands { mesh, sides: &sides, f, y, w: y, flux }.totals();
    let largest = y.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    (totals, largest)
}

/// A flux for the vector of a problem, with few digits.
fn short_flux(problem: &TestProblem<2, 3>) -> Vec<SideFlux<2>> {
    let (sides, TestProblem { mesh, network, f, y, .. }) = (Sides::new(&problem.mesh), problem);
    let cells = Cells { mesh, w: y, f: &f.cells };
    let flux = equilibrated(&cells, &sides, network, &OnceLock::new()).unwrap();
    flux.into_iter().map(|flux| flux.map(short)).collect()
}

/// Checks the energies of data against those of three times the data, which are nine times as large: their rounding
/// errors are others.
fn check_thrice(problem: &TestProblem<2, 3>, end: f64, flux: &[SideFlux<2>]) {
    let thrice = |value: &f64| 3.0 * value;
    let mut large = problem.clone().under(Law::friction(3.0 * end).unwrap());
    large.f = constant_on_cells(&large.mesh, large.f.cells.mean.iter().map(thrice).collect());
    large.y = large.y.iter().map(thrice).collect();
    let large_flux: Vec<_> = flux.iter().map(|flux| flux.map(|value| 3.0 * value)).collect();
    let (one, largest) = totals(problem, flux);
    let (nine, largest_of_nine) = totals(&large, &large_flux);
    let error_of_flux = 0.5 * (9.0 * one.flux - nine.flux).abs();
    let of_flux = 9.0 * one.rounding_of_flux(largest) + nine.rounding_of_flux(largest_of_nine);
    assert!(error_of_flux <= of_flux, "{error_of_flux} {of_flux}");
    let energy = |totals: &Totals| 0.5 * totals.gradient - totals.load + totals.potential;
    let error = (9.0 * energy(&one) - energy(&nine)).abs();
    let all = 9.0 * one.rounding(largest) + nine.rounding(largest_of_nine);
    assert!(error <= all, "{error} {all}");
}

#[test]
fn rounding_errors_of_energies_are_at_most_what_is_added_for_them() {
    for k in 1..=10 {
        let value = short(f64::from(k) / 7.0);
        let law = Law::friction(value).unwrap();
        let f = |i, j| if i + j < 2 { 2.0 * value } else { -value };
        let mut problem = square(3, f).under(law);
        // Zero: all is the flux.
        check_thrice(&problem, value, &short_flux(&problem));
        let count = problem.y.len();
        problem.y = noise(count, 7.0 + value).into_iter().map(short).collect();
        check_thrice(&problem, value, &short_flux(&problem));
        // A constant without f and flux: all is the law.
        let mut level = square(3, |_, _| 0.0).under(Law::friction(short(0.3)).unwrap());
        level.y = vec![value; count];
        check_thrice(&level, short(0.3), &vec![[0.0; 2]; Sides::new(&level.mesh).len()]);
    }
}

#[test]
fn a_flux_that_rounding_puts_out_of_the_law_is_refused() {
    let mut refused = 0;
    for k in 1..=20 {
        let mut problem = square(4, |_, _| 0.0);
        let mut mean = noise(problem.mesh.cells().len(), f64::from(k));
        mean.iter_mut().for_each(|f| *f *= 1e6);
        let last = mean.len() - 1;
        // All cells have one area.
        mean[last] = -mean[..last].iter().sum::<f64>() - 1e-9;
        problem.f = constant_on_cells(&problem.mesh, mean);
        let TestProblem { mesh, network, f, y, .. } = &problem;
        let (sides, cells) = (Sides::new(mesh), Cells { mesh, w: y, f: &f.cells });
        match equilibrated(&cells, &sides, network, &OnceLock::new()) {
            Ok(flux) => check_law(&cells, &sides, &flux),
            // Or the sum itself is positive by rounding.
            Err(error) => refused += usize::from(error == NoBound::NotBalanced),
        }
    }
    assert!(refused > 0, "{refused}");
}
