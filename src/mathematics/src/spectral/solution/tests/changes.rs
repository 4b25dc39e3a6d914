//! Problems in which numbers nearly agree: what a tolerance changes of f is in the bracket.

use super::{lshape, pieces, polygon, proved, seen_lshape};
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::side::PlaneSide;
use crate::spectral::source::changes::Changes;
use crate::spectral::source::curves::Jumps;
use crate::spectral::source::jumps::PlaneJumps;
use crate::spectral::source::{RegionBorder, Regions};
use std::f64::consts::PI;

/// The energy of a narrow shape and that of a wide one of the same weight differ by no more than their squares.
#[test]
fn brackets_hold_the_weight_of_shapes_that_are_too_narrow_for_the_solver() {
    let mut free = polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    free.rings[0].sides[0].law = Law::FREE;
    for (domain, narrow, wide) in [
        (
            seen_lshape(),
            "rect(-0.500000000000006,-0.499999999999994,0.2,0.7)=1e5; else=-3",
            "rect(-0.50005,-0.49995,0.2,0.7)=-2.999988; else=-3",
        ),
        (
            seen_lshape(),
            "rect(-0.500000000000006,-0.499999999999994,0.2,0.7)=-1e5; else=-3",
            "rect(-0.50005,-0.49995,0.2,0.7)=-3.000012; else=-3",
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
    /// Position of the family that meets on a side.
    const MEETING: usize = 4;
    let families: [Of; 7] = [
        |by| format!("disc(-0.5,0.5,0.2)=3; disc(-0.1,0.5,{})=-1; else=-3", 0.2 + by),
        |by| format!("disc(-0.5,0.5,{})=3; else=-3", 0.5 + by),
        |by| format!("disc(-0.5,0.5,0.3)=9; disc(-0.5,0.5,{})=4; else=-3", 0.3 - by),
        |by| format!("halfplane(1,0.3,-0.1)=2; halfplane(1,0.3,{})=-4; else=-3", by - 0.1),
        // A meeting on a side, or beside it, at a small angle, and a border beside a side.
        |by| format!("halfplane(1,0,-0.3)=-2; halfplane(0.1,1,{})=-4; else=1", 0.97 - by),
        |by| format!("halfplane(1,0,{})=4; else=-3", by - 1.0),
        |by| {
            let last = 0.4 + by;
            format!(
                "halfplane(1,0.3,0.1)=2; halfplane(0.3,1,0.3)=-1; halfplane(1.3,1.3,{last})=-5; else=-3"
            )
        },
    ];
    for (k, f) in families.into_iter().enumerate() {
        let [low, high] = proved(seen_lshape(), &f(0.0));
        // A meeting so far from a side has no bracket.
        for by in [5e-15, -2e-14, 8e-13, 1e-11].into_iter().filter(|by| k != MEETING || *by < 1e-11)
        {
            let [lower, upper] = proved(seen_lshape(), &f(by));
            // |v| times the jumps times the length of the borders.
            let moved = 10.0 * f64::abs(by);
            assert!(lower <= high + moved && low <= upper + moved, "{}: {lower} {upper}", f(by));
            assert!(upper - lower < 1e-8, "{}: {lower} {upper}", f(by));
        }
    }
}

/// The integral of what changes is bounded wherever numbers count as one: each time by nothing else than this.
#[test]
fn what_a_tolerance_changes_is_bounded() {
    let domain = lshape();
    // The triangle between two borders and a side, or between three borders.
    let (depth, slope) = (5e-14f64, 0.1);
    let beside_side = 0.5 * depth * depth / slope;
    let between_lines = 0.5 * 5e-13f64.powi(2);
    // The part that a line cuts off a disc.
    let cut_off = 4.0 / 3.0 * 4e-13 * (2.0 * 4e-13 * 0.3f64).sqrt();
    for (f, least) in [
        ("disc(-0.5,0.5,1e-12)=3; else=0", 3.0 * PI * 1e-24),
        ("halfplane(1,0.3,-0.1)=3; halfplane(1,0.3,-0.09999999999999)=1; else=0", 2.0 * 0.9e-14),
        ("halfplane(1,0,-0.99999999999995)=3; else=0", 3.0 * 2.0 * 4.9e-14),
        ("disc(-0.5,0.5,0.3)=3; halfplane(1,0,-0.7999999999996)=1; else=0", cut_off),
        ("halfplane(1,0,-0.3)=2; halfplane(0.1,1,0.96999999999995)=1; else=0", beside_side),
        ("halfplane(1,0,-0.5)=2; halfplane(1,3e-14,-0.499999999999973)=1; else=0", 1e-16),
        (
            "halfplane(1,0,-0.5)=1; halfplane(0,1,0.5)=3; halfplane(1,1,5e-13)=-2; else=0",
            between_lines,
        ),
    ] {
        let Changes { mass, field } =
            Jumps::new(&domain, &Regions::all(f.parse().unwrap())).unwrap().changes;
        assert!(mass >= least && mass < 1e-10, "{f}: {mass:e} {least:e}");
        // On the other side of the domain.
        assert!(field >= mass / (2.0 * PI * domain.diameter()), "{f}: {field:e}");
    }
    // More than a share of f that leaves seven digits is refused.
    for (value, is_refused) in [("5e14", false), ("5e18", true), ("5e23", true)] {
        let source = pieces(&format!("disc(-0.41,0.37,1e-12)={value}; else=-3"));
        assert_eq!(PlaneJumps::new(&domain, &source).is_err(), is_refused, "{value}");
    }
    let exact = "disc(-0.5,0.5,0.25)=3; halfplane(1,0,-0.5)=1; else=0".parse().unwrap();
    let exact = Jumps::new(&domain, &Regions::all(exact)).unwrap();
    assert_eq!(exact.changes, Changes::default());
}

/// A border between two values that ends inside of the domain, or does not.
#[test]
fn jumps_that_do_not_add_up_are_refused() {
    let domain = lshape();
    for (to, is_refused) in [(1.0, false), (1.0 - 1e-10, false), (1.0 - 1e-8, true), (0.4, true)] {
        let side = PlaneSide::segment([[-0.5, -1.0], [-0.5, to]], Law::FREE, 0);
        let borders = vec![RegionBorder { side, regions: [Some(0), Some(1)] }];
        let pieces = vec![Source::constant(4.0), Source::constant(-2.0)];
        let refused = Jumps::new(&domain, &Regions { borders, pieces }).err();
        assert_eq!(refused.is_some(), is_refused, "{to}: {refused:?}");
        assert!(refused.is_none_or(|e| matches!(e, PlaneError::Source(_))), "{to}");
    }
}
