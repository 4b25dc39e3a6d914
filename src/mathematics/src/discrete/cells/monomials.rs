//! Integrals of monomials below a chord and between a chord and its arc.
//!
//! The monomials are 1, X, Y, XY, X^2, Y^2, X^2 Y and X Y^2, in this order.

/// Half the chord of a circle at a distance from its centre.
pub(super) fn half_chord(radius: f64, distance: f64) -> f64 {
    ((radius - distance) * (radius + distance)).max(0.0).sqrt()
}

/// Integrals of the monomials between the x axis and the chord over [a, b] with heights p and q.
pub(super) fn below_chord(ends: [f64; 2], [p, q]: [f64; 2]) -> [f64; 8] {
    // Exact, as the integrands are of degree 4 in x.
    below(ends, GAUSS_3, |t, _| 0.5 * (p + q) + t * (q - p))
}

/// Integrals of the monomials between the x axis and the upper (`side` = 1) or lower (-1) half of a circle over
/// [a, b]; none if the arc bends too much for few points.
pub(super) fn below_arc(
    [a, b]: [f64; 2],
    centre: [f64; 2],
    radius: f64,
    side: f64,
) -> Option<[f64; 8]> {
    // The height is analytic up to the ends of the circle: with each degree in x its terms fall by half the interval
    // over the distance from there. Five points leave terms of degree ten, six beyond those of a straight line.
    let half = 0.5 * (b - a);
    let to_end = radius - (0.5 * (a + b) - centre[0]).abs();
    (to_end > 50.0 * half).then(|| {
        below([a, b], GAUSS_5, |_, x| centre[1] + side * half_chord(radius, x - centre[0]))
    })
}

/// Integrals of the monomials below a graph over [a, b], whose height is given for t in [-1/2, 1/2] and x there.
#[inline(always)]
fn below<const N: usize>(
    [a, b]: [f64; 2],
    rule: [(f64, f64); N],
    height: impl Fn(f64, f64) -> f64,
) -> [f64; 8] {
    let mut sums = [0.0; 8];
    for (t, weight) in rule {
        let x = 0.5 * (a + b) + t * (b - a);
        let y = height(t, x);
        let (area, square, cube) = (y, y * y / 2.0, y * y * y / 3.0);
        let terms =
            [area, x * area, square, x * square, x * x * area, cube, x * x * square, x * cube];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += (b - a) * weight * term;
        }
    }
    sums
}

/// Integrals of the monomials between a chord and its arc, which lies above (`side` = 1) or below it (-1).
pub(super) fn beside_chord(
    [a, b]: [f64; 2],
    [p, q]: [f64; 2],
    centre: [f64; 2],
    radius: f64,
    side: f64,
) -> [f64; 8] {
    let (dx, dy) = (b - a, q - p);
    let length = (dx * dx + dy * dy).sqrt();
    let middle = [0.5 * (a + b), 0.5 * (p + q)];
    let t = [dx / length, dy / length];
    let n = [-side * t[1], side * t[0]];
    let offset = [middle[0] - centre[0], middle[1] - centre[1]];
    let distance = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
    let Segment { area, w, uu, ww, uuw, www } = Segment::new(0.5 * length, radius, distance);
    // A point is middle + u t + w n; odd powers of u integrate to 0.
    let first = |k: usize| middle[k] * area + n[k] * w;
    let second = |k: usize, l: usize| {
        middle[k] * first(l) + n[k] * (middle[l] * w) + t[k] * t[l] * uu + n[k] * n[l] * ww
    };
    // Integral of the k-th coordinate squared times the l-th one.
    let third = |k: usize, l: usize| {
        let along = 2.0 * t[k] * (middle[k] * uu + n[k] * uuw);
        let across =
            middle[k] * (middle[k] * w + 2.0 * n[k] * ww) + t[k] * t[k] * uuw + n[k] * n[k] * www;
        middle[l] * second(k, k) + t[l] * along + n[l] * across
    };
    [area, first(0), first(1), second(0, 1), second(0, 0), second(1, 1), third(0, 1), third(1, 0)]
}

/// Integrals over the segment between an arc, of half a circle at most, and its chord:
/// of 1, w, u^2, w^2, u^2 w and w^3, with u along the chord from its middle and w away from it.
struct Segment {
    area: f64,
    w: f64,
    uu: f64,
    ww: f64,
    uuw: f64,
    www: f64,
}

impl Segment {
    /// From half the chord, the radius, and the distance between chord and centre.
    fn new(half: f64, radius: f64, distance: f64) -> Self {
        if half < SHALLOW * radius {
            Self::shallow(half, radius)
        } else {
            Self::wide(half, radius, distance)
        }
    }

    /// In closed form, in the angle at the centre.
    fn wide(half: f64, radius: f64, distance: f64) -> Self {
        let angle = libm::atan2(half, distance);
        let (s, c) = libm::sincos(angle);
        let (area, s3, s5) = (angle - s * c, s * s * s, s * s * s * s * s);
        // Moments of the segment of the unit circle about its centre.
        let (v, vv, vvv) =
            (2.0 / 3.0 * s3, (area + 2.0 * s3 * c) / 4.0, 2.0 * (s3 / 3.0 - s5 / 5.0));
        let uu = area / 4.0 - s3 * c / 6.0;
        let [r2, r3, r4, r5] = [2, 3, 4, 5].map(|k| radius.powi(k));
        Self {
            area: r2 * area,
            w: r3 * (v - c * area),
            uu: r4 * uu,
            ww: r4 * (vv - c * (2.0 * v - c * area)),
            uuw: r5 * (2.0 / 15.0 * s5 - c * uu),
            www: r5 * (vvv - c * (3.0 * vv - c * (3.0 * v - c * area))),
        }
    }

    /// By Gauss' rule with eight points, where the closed form would cancel; exact to rounding, because
    /// the height of the arc is analytic in u up to four times the half chord and more.
    fn shallow(half: f64, radius: f64) -> Self {
        let distance = half_chord(radius, half);
        let mut sums = [0.0; 6];
        for (t, weight) in GAUSS_8 {
            let u = t * half;
            let w = (half - u) * (half + u) / (half_chord(radius, u) + distance);
            let (w2, w3, w4) = (w * w / 2.0, w * w * w / 3.0, w * w * w * w / 4.0);
            for (sum, term) in sums.iter_mut().zip([w, w2, u * u * w, w3, u * u * w2, w4]) {
                *sum += 2.0 * half * weight * term;
            }
        }
        let [area, w, uu, ww, uuw, www] = sums;
        Self { area, w, uu, ww, uuw, www }
    }
}

/// Half the chord over the radius, below which a segment is shallow.
const SHALLOW: f64 = 0.25;

/// Nodes and weights of Gauss' rule with three points on [-1/2, 1/2].
const GAUSS_3: [(f64, f64); 3] = [
    (-0.387_298_334_620_741_7, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.387_298_334_620_741_7, 5.0 / 18.0),
];

/// Moments by five points.
const GAUSS_5: [(f64, f64); 5] = [
    (-0.453_089_922_969_332, 0.118_463_442_528_094_54),
    (-0.269_234_655_052_841_55, 0.239_314_335_249_683_23),
    (0.0, 64.0 / 225.0),
    (0.269_234_655_052_841_55, 0.239_314_335_249_683_23),
    (0.453_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Positive nodes and weights of Gauss' rule with eight points on [-1, 1].
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_see_an_arc_as_its_chord_and_its_segment() {
        let mut seen = 0;
        for radius in [26.0, 60.0, 150.0, 2000.0] {
            for k in 1..64 {
                // The arc goes through the middle of the cell, and leaves it at the sides or below and above.
                let (s, c) = libm::sincos(std::f64::consts::PI * f64::from(k) / 64.0);
                let half = 0.5 * (s / c.abs()).min(1.0);
                let (ends, centre) = ([-half, half], [-radius * c, -radius * s]);
                for side in [1.0, -1.0] {
                    let centre = [centre[0], side * centre[1]];
                    let Some(found) = below_arc(ends, centre, radius, side) else { continue };
                    let heights =
                        ends.map(|x| centre[1] + side * half_chord(radius, x - centre[0]));
                    let segment = beside_chord(ends, heights, centre, radius, side);
                    let chord = below_chord(ends, heights);
                    for ((found, chord), segment) in found.into_iter().zip(chord).zip(segment) {
                        let apart = found - (chord + side * segment);
                        assert!(apart.abs() < 4e-16 * radius, "{radius} {k}: {apart:e}");
                    }
                    seen += 1;
                }
            }
        }
        assert!(seen > 250, "{seen}");
    }
}
