//! Problems in which numbers nearly agree: what a tolerance changes of f is in the bracket.

use super::{PlaneSource, lshape, pieces, polygon, proved};
use crate::mesh::Condition;
use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::{Arc, Curve};
use crate::spectral::geometry::domain::PlaneError;
use crate::spectral::source::curves::Jumps;

/// The energy of a narrow shape and that of a wide one of the same weight differ by no more than their squares.
#[test]
fn brackets_hold_the_weight_of_shapes_that_are_too_narrow_for_the_solver() {
    let mut free = polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    free.loops[0][0].condition = Condition::Free;
    for (domain, narrow, wide) in [
        (
            lshape(),
            "rect(-0.500000000000006,-0.499999999999994,0.2,0.7)=1e5; else=-3",
            "rect(-0.50005,-0.49995,0.2,0.7)=-2.999988; else=-3",
        ),
        (
            free,
            "halfplane(0,1,-0.99999999999995)=1e5; else=-3",
            "halfplane(0,1,-0.99995)=-2.9999; else=-3",
        ),
    ] {
        let [[lower, upper], [low, high]] = [narrow, wide].map(|f| proved(domain.clone(), f));
        let energy = 0.5 * (low + high);
        assert!(lower < energy && energy < upper, "{narrow}: {lower} {energy} {upper}");
        assert!(upper - lower < -1e-4 * energy, "{narrow}: {lower} {upper}");
        // The solver does not see it.
        assert!((0.5 * (lower + upper) - energy).abs() > high - low, "{narrow}: {energy}");
    }
}

/// Shapes that touch, meet in a point or have one border but for a tolerance, and those moved by it.
#[test]
fn problems_that_differ_by_a_tolerance_have_brackets_that_meet() {
    type Of = fn(f64) -> String;
    let families: [Of; 5] = [
        |by| format!("disc(-0.5,0.5,0.2)=3; disc(-0.1,0.5,{})=-1; else=-3", 0.2 + by),
        |by| format!("disc(-0.5,0.5,{})=3; else=-3", 0.5 + by),
        |by| format!("disc(-0.5,0.5,0.3)=9; disc(-0.5,0.5,{})=4; else=-3", 0.3 - by),
        |by| format!("halfplane(1,0.3,-0.1)=2; halfplane(1,0.3,{})=-4; else=-3", by - 0.1),
        |by| {
            let last = 0.4 + by;
            format!(
                "halfplane(1,0.3,0.1)=2; halfplane(0.3,1,0.3)=-1; halfplane(1.3,1.3,{last})=-5; else=-3"
            )
        },
    ];
    for f in families {
        let [low, high] = proved(lshape(), &f(0.0));
        for by in [5e-15, -2e-14, 8e-13, 1e-11] {
            let [lower, upper] = proved(lshape(), &f(by));
            // |v| times the jumps times the length of the borders.
            let moved = 10.0 * f64::abs(by);
            assert!(lower <= high + moved && low <= upper + moved, "{}: {lower} {upper}", f(by));
            assert!(upper - lower < 1e-8, "{}: {lower} {upper}", f(by));
        }
    }
}

/// A border between two values that ends inside of the domain, or does not.
#[test]
fn jumps_that_do_not_add_up_are_refused() {
    let domain = lshape();
    let curve = Curve::line(Complex::new(-0.5, 0.0), Complex::new(0.0, 1.0));
    for (to, is_refused) in [(1.0, false), (1.0 - 1e-10, false), (1.0 - 1e-8, true), (0.4, true)] {
        let arc = Arc { curve, span: [-1.0, to], ends: [None; 2] };
        let PlaneSource::Pieces(f) = pieces("else=4") else { panic!("pieces") };
        let jumps = Jumps::new(&domain, [&f], [arc], |z| if z.re < -0.5 { 4.0 } else { -2.0 });
        let refused = jumps.err();
        assert_eq!(refused.is_some(), is_refused, "{to}: {refused:?}");
        assert!(refused.is_none_or(|e| matches!(e, PlaneError::Source(_))), "{to}");
    }
}
