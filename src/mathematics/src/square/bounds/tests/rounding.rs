//! Sums that are nothing but rounding errors: the bounds are as wide as these may be.

use crate::bounds::Bounds;
use crate::square::bounds::cells::Sums;
use crate::square::bounds::combined;
use crate::square::bounds::walk::Total;

const N: usize = 4096;

/// Bounds of an energy of -100, for a distance in the energy norm from the values of a vector to those that count.
fn of(total: Total, moved: f64) -> Bounds {
    combined(N, &Total { recovered_potential: -100.0, linear_potential: -100.0, ..total }, moved)
        .unwrap()
}

/// A sum of so many numbers as rows have cells errs by half a unit of each partial sum; blocks of rows have five
/// eighths of them.
fn of_sums(size: f64) -> f64 {
    (0.625 * N as f64 + 16.0) * 0.5 * f64::EPSILON * size
}

#[test]
fn sums_of_energies_err() {
    let sums = Sums { recovered: 1e6, linear: 1e6 + 2.0, ..Sums::default() };
    let loads = Total { largest: 1e6, mass: 1.0, ..Total::default() };
    let potentials = Total { largest: 1e6, mass: 1e-9, flow: 1.0, ..Total::default() };
    let gradients = Total { sums, mass: 1e-9, largest: 0.1, ..Total::default() };
    // Half the square of the gradients.
    for (total, size, energy) in
        [(loads, 1e6, -100.0), (potentials, 1e6, -100.0), (gradients, 5e5, 5e5 - 100.0)]
    {
        let (errs, is_above_zero) = (of_sums(size), energy > 0.0);
        let gain = 0.5 * (total.sums.linear - total.sums.recovered);
        let Bounds { energy: [low, high], error: [least, most], recovered, .. } = of(total, 0.0);
        assert!(low <= energy - errs, "{low}");
        assert!(if is_above_zero { high == 0.0 } else { high >= energy + errs }, "{high}");
        assert!(most * most >= 2.0 * (gain + 2.0 * errs), "{most}");
        assert!(least * least <= 2.0 * (gain - 2.0 * errs).max(0.0), "{least}");
        assert!(recovered.unwrap().powi(2) >= 2.0 * errs, "{recovered:?}");
    }
}

#[test]
fn fluxes_err() {
    // Each difference of values errs by half a unit: a residual of two units of one sign on half of the square.
    let largest = 1e9;
    let flux = 2.0 * f64::EPSILON * largest * (N * N) as f64 / 12f64.sqrt();
    let total = Total { largest, mass: 1e-30, ..Total::default() };
    let [low, _] = of(total, 0.0).energy;
    assert!(low <= -100.0 - 0.5 * flux * flux, "{low}");
    // The sum of the reactions errs, and leaves through one side.
    let flow = 1e12;
    let flux = 2.0 * N as f64 * f64::EPSILON * flow / 3f64.sqrt();
    let [low, _] = of(Total { flow, mass: 1e-30, ..Total::default() }, 0.0).energy;
    assert!(low <= -100.0 - 0.5 * flux * flux, "{low}");
}

#[test]
fn distances_of_moved_values_err() {
    let sums = Sums { linear: 200.0, ..Sums::default() };
    let (moved, errs) = (3.0, 3.0 * 2.0 * N as f64 * f64::EPSILON);
    let [least, most] = of(Total { sums, ..Total::default() }, moved).error;
    let error = 200f64.sqrt();
    assert!(least <= error - moved - errs && least > error - moved - 1e-8, "{least}");
    assert!(most >= error + moved + errs && most < error + moved + 1e-8, "{most}");
}
