//! Bounds of moduli against the largest values at many points of discs.

use super::*;
use crate::spectral::functions::Power;
use crate::spectral::geometry::panels::Spot;
use crate::spectral::proof::bench::solved;

/// Points on the border of a disc, and on a circle of half its size or just outside of what it leaves out.
fn inside(disc: Disc) -> Vec<Complex> {
    let inner = if disc.inner > 0.0 { disc.inner } else { 0.5 * disc.radius };
    let radii = [disc.radius, inner];
    let ways = (0..180).map(|k| Complex::unit(TAU * f64::from(k) / 180.0));
    ways.flat_map(|way| radii.map(|radius| disc.centre + way.scaled(radius))).collect()
}

/// Largest moduli of a sum of functions, and of its derivative.
fn largest(functions: &Functions, coefficients: &[Complex], points: &[Complex]) -> Moduli {
    let spots: Vec<Spot> = points.iter().map(|&z| Spot::inside(z)).collect();
    let sums = functions.sums(coefficients, &spots, true);
    let [value, slope] = sums.map(|own| own.iter().fold(0.0f64, |most, z| most.max(z.norm())));
    Moduli { value, slope }
}

#[test]
fn polynomials_are_bounded_between_the_points_of_the_circle() {
    for n in [1, 4, 7, 30] {
        // The polynomials are powers of z.
        let arnoldi: Vec<Vec<Complex>> = (0..n)
            .map(|k| {
                let mut column = vec![Complex::default(); k + 2];
                column[k + 1] = Complex::new(1.0, 0.0);
                column
            })
            .collect();
        let disc = Disc { centre: Complex::default(), radius: 1.0, inner: 0.0 };
        // (z^n + i) / 2 has the modulus of a cosine, which is no point's largest.
        let mut own = vec![Complex::default(); n + 1];
        (own[0], own[n]) = (Complex::new(0.0, 0.5), Complex::new(0.5, 0.0));
        let Moduli { value, slope } = of_polynomial(&arnoldi, &own, &[disc])[0];
        assert!((1.0..1.5).contains(&value), "{n}: {value}");
        assert!((0.5..0.8).contains(&(slope / n as f64)), "{n}: {slope}");
    }
}

#[test]
fn functions_of_corners_and_holes_are_bounded_on_discs() {
    let (one, i) = (Complex::new(1.0, 0.0), Complex::new(0.6, -0.8));
    let family = |powers: Vec<Power>, lengths: Vec<f64>| Functions {
        families: vec![Family {
            point: Complex::default(),
            split: None,
            inwards: one,
            lengths,
            powers,
        }],
        ..Functions::default()
    };
    let hole = |powers| Functions {
        holes: vec![Hole { middle: Complex::default(), radius: 0.4, powers }],
        ..Functions::default()
    };
    let mut all = Vec::new();
    for power in [0.5, 2.0 / 3.0, 1.0, 1.5, 2.0, 3.5] {
        all.push((family(vec![Power::plain(power)], vec![0.7]), vec![i], 0.0));
    }
    for power in [0.0, 1.0, 2.0] {
        all.push((family(vec![Power::with_log(power)], vec![0.3]), vec![i], 0.0));
    }
    all.push((
        family(vec![Power::plain(0.5), Power::plain(1.0)], vec![0.2, 0.9]),
        vec![i, one, one, i],
        0.0,
    ));
    for powers in [1, 3, 9] {
        let mut own = vec![Complex::default(); powers];
        own[powers - 1] = i;
        all.push((hole(powers), own, 0.0));
    }
    all.push((hole(0), Vec::new(), 0.7));
    let away = [(0.5, 0.3), (0.5, 0.45), (1.0, 0.2), (3.0, 1.5)];
    let discs =
        away.map(|(x, radius)| Disc { centre: Complex::unit(0.3).scaled(x), radius, inner: 0.0 });
    for (functions, coefficients, log) in all {
        for disc in discs {
            let bound = match (&functions.families[..], &functions.holes[..]) {
                ([family], _) => family.moduli(disc, &coefficients),
                (_, [hole]) => hole.moduli(disc, &coefficients, log),
                _ => panic!("one of both"),
            };
            // A constant before the logarithms of holes.
            let mut own = coefficients.clone();
            own.push(Complex::default());
            own.extend(functions.holes.iter().map(|_| Complex::new(log, 0.0)));
            let most = largest(&functions, &own, &inside(disc));
            let name = format!("{functions:?} {disc:?} {bound:?} {most:?}");
            assert!(bound.value >= most.value && bound.slope >= most.slope, "{name}");
            let is_log = log != 0.0 || functions.families.iter().any(|own| own.powers[0].log);
            let factor = if is_log { 200.0 } else { 12.0 };
            let is_near = disc.centre.norm() < 2.5 * disc.radius;
            assert!(is_near || bound.value < factor * most.value, "{name}");
            assert!(is_near || bound.slope < factor * most.slope, "{name}");
        }
    }
    // Round the point itself: powers of the distance are all that is.
    let disc = Disc { centre: Complex::default(), radius: 0.2, inner: 0.01 };
    let half = family(vec![Power::plain(0.5)], vec![0.7]);
    let Moduli { value, slope } = half.families[0].moduli(disc, &[one]);
    let most = largest(&half, &[one, Complex::default()], &inside(disc));
    let least = 1.0 - 1e-12;
    assert!(
        value >= least * most.value && slope >= most.slope && slope < 3.0 * most.slope,
        "{value} {slope} {most:?}"
    );
    // A tip in the disc.
    let disc = Disc { centre: Complex::new(-0.7, 0.0), radius: 0.1, inner: 0.0 };
    assert!(half.families[0].moduli(disc, &[one]).value.is_infinite());
}

#[test]
fn a_logarithm_counts_with_the_turns_it_makes_on_the_way() {
    // Continued along a circle round the point, log u grows by i times the angle.
    for (inner, turns) in [(0.0, 2.0 * PI), (0.01, 4.0 * PI)] {
        let disc = Disc { centre: Complex::new(1.0, 0.0), radius: 0.5, inner };
        let hole = Hole { middle: Complex::default(), radius: 0.4, powers: 0 };
        assert!(hole.moduli(disc, &[], 1.0).value >= turns);
        let family = Family {
            point: Complex::default(),
            split: None,
            inwards: Complex::new(1.0, 0.0),
            lengths: vec![0.3],
            powers: vec![Power::with_log(1.0)],
        };
        let bound = family.moduli(disc, &[Complex::new(1.0, 0.0)]);
        // |u| is more than 0.6 there, and so are u log u and its derivative times 2.
        assert!(bound.value >= 0.6 * turns && bound.slope >= 0.1 * turns, "{bound:?}");
    }
}

#[test]
fn psi_is_bounded_on_discs() {
    for name in [
        "crossings on a disc",
        "disc in a disc",
        "disc beside the middle",
        "small disc",
        "disc in contact",
    ] {
        let own = solved(name);
        let psi = &own.setup.jumps.psi;
        let centres = (0..12).map(|k| Complex::unit(0.3 + 0.5 * f64::from(k)).scaled(0.95));
        let centres = centres.chain([Complex::new(0.05, 0.02)]);
        for centre in centres {
            let room = room_of_psi(psi, centre, false);
            let vertices = &own.setup.jumps.singular;
            let nearest =
                vertices.iter().map(|&z| (z - centre).norm()).fold(f64::INFINITY, f64::min);
            // Inside of a circle up to it.
            assert!(room <= nearest.max(0.25), "{name}: {centre:?} {room} {nearest}");
            let disc = Disc { centre, radius: (0.8 * room).min(0.5), inner: 0.0 };
            let bound = of_psi(psi, disc);
            // Points on this side of all jumps, whose f is that of the middle.
            let here = psi.source(centre);
            let points: Vec<Complex> =
                inside(disc).into_iter().filter(|&z| (psi.source(z) - here).abs() < 1e-6).collect();
            assert!(points.len() > 60, "{name}: {centre:?}");
            let slope = psi.gradients(&points).iter().fold(0.0f64, |most, g| most.max(g.norm()));
            let value = points.iter().fold(0.0f64, |most, &z| most.max(psi.value(z).abs()));
            assert!(
                bound.value >= value && bound.slope >= slope,
                "{name}: {disc:?} {bound:?} {value} {slope}"
            );
            let own = psi.gradients(&[centre])[0].norm();
            assert!(bound.slope < 2000.0 * (own + slope + 1.0), "{name}: {disc:?} {bound:?}");
        }
    }
}

#[test]
fn each_jump_is_bounded_by_itself() {
    use crate::spectral::geometry::curve::{Arc, Curve};
    use crate::spectral::source::potential::Potential;
    let origin = Complex::default();
    let tangent = Complex::new(1.0, 0.0);
    for curvature in [0.0, 0.8, 4.0] {
        let curve = Curve { origin, tangent, curvature };
        let span = [-0.3, 0.35];
        let vertices: Vec<Complex> = span.iter().map(|&s| curve.at(s)).collect();
        let mut potential = Potential { vertices, ..Potential::default() };
        potential.add(Arc { curve, span, ends: [Some(0), Some(1)] }, 2.0 * TAU);
        let jump = potential.jumps[0].clone();
        // The middle of the circle lies in the last ones.
        let round = 1.0 / curvature.max(0.5);
        for (x, y, radius) in [
            (0.0, -1.0, 0.6),
            (2.0, -0.5, 1.2),
            (0.2, 0.12, 0.1),
            (0.05, -0.1, 0.05),
            (-1.0, -1.0, 0.3),
            (0.1 * round, 0.9 * round, 0.4 * round),
            (0.0, round, 0.6 * round),
        ] {
            let centre = Complex::new(x, y);
            let disc = Disc { centre, radius, inner: 0.0 };
            let bound = jump.modulus(disc, &potential.vertices);
            if !bound.is_finite() {
                continue;
            }
            // Points on the side of the centre, where psi is continued.
            let side = curve.distance(centre).signum();
            let points = inside(disc).into_iter().filter(|&z| curve.distance(z).signum() == side);
            let points: Vec<Complex> = points.collect();
            let gradients = potential.gradients(&points);
            let most = gradients.iter().fold(0.0f64, |most, g| most.max(g.norm()));
            assert!(bound >= most, "{curvature} {disc:?}: {bound} {most}");
        }
    }
}
