//! Small shapes that are moved, and whose borders are.

use super::*;
use crate::problem::law::Law;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::problem::PlaneProblem;
use crate::spectral::proof::bench::known::{circle, pieces};

/// Jumps of two small shapes on the unit disc, under the first of which the middle of the second may move.
fn setup(radius: f64, [x, y]: [f64; 2]) -> Setup {
    let f = format!("disc(0.5,0.1,1e-4)=-1e8; disc({x},{y},{radius})=-2e8; else=-1");
    let domain = PlaneDomain::new(vec![circle(1.0, Law::SIGNORINI, true)]).unwrap();
    Setup::new(&PlaneProblem { domain, source: pieces(&f) }).unwrap()
}

/// Integral of f v along the jumps of the second shape, by psi alone.
fn work(setup: &Setup) -> f64 {
    let mut sum = BoundedEnergy::default();
    let group = &setup.jumps.groups[2];
    assert_eq!(setup.jumps.groups.len(), 3);
    sum.add_edge(setup, group, &group.edges[0]);
    -2.0 * sum.energy
}

#[test]
fn a_shape_that_is_moved_changes_the_energy_by_no_more_than_is_said() {
    let (radius, step) = (1e-4, 1e-9);
    let [before, after] = [0.0, step].map(|step| work(&setup(radius, [0.501 + step, 0.1])));
    let mut sum = BoundedEnergy::default();
    let own = setup(radius, [0.501, 0.1]);
    sum.add_moved(&own, &own.jumps.groups[2]);
    // The integral of f v is twice the energy of two shapes with each other.
    let change = 0.5 * (after - before).abs();
    let said = sum.error / ROUNDING * step;
    assert!(change <= said && said < 10.0 * change, "{change} {said}");
    // And v without psi has a gradient of at most twice its size over the distance from the boundary.
    let mut more = BoundedEnergy { most_g: 0.25, ..BoundedEnergy::default() };
    more.add_moved(&own, &own.jumps.groups[2]);
    let rest = 0.5 / own.domain.distance(Complex::new(0.501, 0.1));
    let weight = 1.999_999_99 * std::f64::consts::PI;
    assert!(more.error - sum.error >= 0.999 * ROUNDING * weight * rest, "{}", more.error);
}

#[test]
fn a_border_that_is_off_changes_the_energy_by_no_more_than_is_said() {
    let own = setup(1e-4, [-0.4, 0.3]);
    let mut sums = [0.0, 1e-9].map(|off| {
        let mut own = setup(1e-4, [-0.4, 0.3]);
        let group = &mut own.jumps.groups[2];
        group.off = off;
        let mut sum = BoundedEnergy { most_g: 0.25, ..BoundedEnergy::default() };
        sum.add_edge(&own, &own.jumps.groups[2], &own.jumps.groups[2].edges[0]);
        sum.error
    });
    sums[1] -= sums[0];
    let psi = own.jumps.psi.value(Complex::new(-0.4 + 1e-4, 0.3)).abs();
    let length = std::f64::consts::TAU * 1e-4;
    let exact = 1.999_999_99e8 * length * 1e-9 * (psi + 0.25);
    assert!((sums[1] / exact - 1.0).abs() < 1e-3, "{} {exact}", sums[1]);
}
