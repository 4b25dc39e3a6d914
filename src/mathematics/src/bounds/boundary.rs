//! Integrals over parts of the boundary with a law, and the shift that brings a flux into the interval of the law.

use crate::problem::law::Law;

/// Part of the boundary: an edge, a facet, or the surroundings of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryPart {
    /// Flux out through the part.
    pub flux: f64,
    /// Length or area.
    pub measure: f64,
    /// Interval of the flux.
    pub law: PartLaw,
}

/// Signs that a function in K may have on the boundary: those under which the law's term of the energy is finite, or
/// some of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slips {
    /// Values above 0, which slip to the lower end of the interval.
    pub up: bool,
    /// Values below 0, which slip to the upper end.
    pub down: bool,
}

impl Slips {
    /// Both signs.
    pub(crate) const ALL: Self = Self { up: true, down: true };

    /// Those signs that a law allows.
    pub(crate) fn and(self, law: Law) -> Self {
        Self { up: self.up && law.lo().is_finite(), down: self.down && law.hi().is_finite() }
    }

    /// Zero in place of a value with a sign that is left out; else the value, also if it is no number.
    pub(crate) fn keep(self, value: f64) -> f64 {
        let is_left_out = (value > 0.0 && !self.up) || (value < 0.0 && !self.down);
        if is_left_out { 0.0 } else { value }
    }
}

/// Signs of the values of a function on a part of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Signs {
    /// None below 0.
    Up,
    /// None above 0.
    Down,
    Both,
}

impl Signs {
    #[inline(always)]
    fn find(values: &[f64]) -> Self {
        if values.iter().all(|value| *value >= 0.0) {
            return Self::Up;
        }
        if values.iter().all(|value| *value <= 0.0) { Self::Down } else { Self::Both }
    }
}

/// Coefficient of the bubble on an edge of the boundary, limited so that the recovery has the sign of the values p and
/// q at the ends: the Bernstein coefficients are p, (p + q - c) / 2 and q. Zero where p and q have different signs.
#[inline(always)]
pub(crate) fn limit_bubble(bubble: f64, ends: [f64; 2]) -> f64 {
    let [p, q] = ends;
    if p == 0.0 && q == 0.0 {
        return 0.0;
    }
    match Signs::find(&ends) {
        Signs::Up => bubble.min(p + q),
        Signs::Down => bubble.max(p + q),
        Signs::Both => 0.0,
    }
}

/// Law over parts of the boundary of one measure: the interval of the flux through a part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartLaw {
    /// Least flux.
    pub least: f64,
    /// Largest flux.
    pub most: f64,
}

impl PartLaw {
    pub(crate) fn new(law: Law, measure: f64) -> Self {
        Self { least: measure * law.lo(), most: measure * law.hi() }
    }

    /// Flux at the end of the interval that v of these signs slips to; 0 if v must not have them.
    fn end(self, signs: Signs) -> f64 {
        let end = if signs == Signs::Down { self.most } else { self.least };
        if end.is_finite() { end } else { 0.0 }
    }

    /// Flux at the end of the interval that v slips to, `from` above the value of the law.
    pub(crate) fn slipping(self, from: f64) -> f64 {
        self.end(Signs::find(&[from]))
    }

    /// Sum of the absolute values of the ends that v with these values slips to; zero where v is.
    pub(crate) fn ends_in_use(self, values: &[f64]) -> f64 {
        let is_up = values.iter().any(|value| *value > 0.0);
        let is_down = values.iter().any(|value| *value < 0.0);
        let up = if is_up { self.end(Signs::Up).abs() } else { 0.0 };
        let down = if is_down { self.end(Signs::Down).abs() } else { 0.0 };
        up + down
    }

    /// Distance of a flux from the nearer end of the interval; negative outside.
    pub(crate) fn room(self, flux: f64) -> f64 {
        (flux - self.least).min(self.most - flux)
    }

    /// Point of the interval next to a flux. A NaN stays one.
    pub(crate) fn clamp(self, flux: f64) -> f64 {
        if flux < self.least {
            self.least
        } else if flux > self.most {
            self.most
        } else {
            flux
        }
    }

    /// Interval with ends that are further inside by `room`, if it is so wide.
    pub(crate) fn within(self, room: f64) -> Self {
        let inside = Self { least: self.least + room, most: self.most - room };
        if inside.least <= inside.most { inside } else { self }
    }

    /// Integral of j(w) over a part, for the linear function with these values at the vertices of the part, less a
    /// bubble.
    pub(crate) fn potential<const N: usize>(self, values: [f64; N], bubble: f64) -> f64 {
        let signs = Signs::find(&values);
        match signs {
            Signs::Up | Signs::Down => -self.end(signs) * (mean(values) - bubble / 6.0),
            Signs::Both => {
                let above = positive_mean(values);
                let below = positive_mean(values.map(|value| -value));
                self.end(Signs::Down) * below - self.end(Signs::Up) * above
            }
        }
    }

    /// Integral of `j(w) + sigma.n w` over an edge of the grid, sigma.n the linear function with `fluxes` at the ends.
    pub(crate) fn work(self, values: [f64; 2], fluxes: [f64; 2], bubble: f64) -> f64 {
        match Signs::find(&values) {
            Signs::Both => flux_work(values, fluxes, bubble) + self.potential(values, bubble),
            signs => flux_work(values, fluxes.map(|flux| flux - self.end(signs)), bubble),
        }
    }

    /// Integral of `j(w) + sigma.n w` over a facet, both linear functions there: `fluxes` has what would leave if the
    /// density were that at the vertex everywhere.
    pub(crate) fn work_of_facet<const N: usize>(self, values: [f64; N], fluxes: [f64; N]) -> f64 {
        match Signs::find(&values) {
            Signs::Both => mean_product(values, fluxes) + self.potential(values, 0.0),
            signs => mean_product(values, fluxes.map(|flux| flux - self.end(signs))),
        }
    }
}

/// Integral of a flux over an edge times the recovery there.
fn flux_work(v: [f64; 2], a: [f64; 2], bubble: f64) -> f64 {
    let linear = a[0] * (2.0 * v[0] + v[1]) + a[1] * (v[0] + 2.0 * v[1]);
    linear / 6.0 - bubble * (a[0] + a[1]) / 12.0
}

/// Mean of the product of two linear functions on an edge or a triangle.
pub(crate) fn mean_product<const N: usize>(one: [f64; N], two: [f64; N]) -> f64 {
    let products: f64 = one.iter().zip(two).map(|(a, b)| a * b).sum();
    let sums = one.iter().sum::<f64>() * two.iter().sum::<f64>();
    (products + sums) / (N * (N + 1)) as f64
}

fn mean<const N: usize>(values: [f64; N]) -> f64 {
    values.iter().sum::<f64>() / N as f64
}

/// Mean of the positive part of the linear function with these values at the vertices of an edge or a triangle.
fn positive_mean<const N: usize>(values: [f64; N]) -> f64 {
    match values.iter().filter(|value| **value > 0.0).count() {
        0 => 0.0,
        1 => single_positive_mean(values),
        count if count == N => mean(values),
        _ => mean(values) + single_positive_mean(values.map(|value| -value)),
    }
}

/// As [`positive_mean`], where all values but one are at most 0: the positive part is that on a smaller simplex.
fn single_positive_mean<const N: usize>(values: [f64; N]) -> f64 {
    let top = values.iter().fold(0.0f64, |top, value| top.max(*value));
    let others = values.iter().filter(|value| **value <= 0.0);
    others.fold(top / N as f64, |product, value| product * (top / (top - value)))
}

/// Shifts the fluxes per length or area by one number, and keeps them in the intervals, so that their sum becomes
/// `sum`. Parts at an end of the interval, where v slips, move only if the others cannot balance the sum.
///
/// The intervals must be bounded. A sum out of reach is missed.
pub(crate) fn shift_to_sum(parts: &mut [BoundaryPart], sum: f64) {
    for with_ends in [false, true] {
        let mut open: Vec<usize> = (0..parts.len()).collect();
        if !with_ends {
            open.retain(|&k| parts[k].law.room(parts[k].flux) > 0.0);
        }
        while !open.is_empty() {
            let missing = sum - parts.iter().map(|part| part.flux).sum::<f64>();
            let shift = missing / open.iter().map(|&k| parts[k].measure).sum::<f64>();
            let before = open.len();
            open.retain(|&k| {
                let part = &mut parts[k];
                let shifted = part.flux + shift * part.measure;
                part.flux = part.law.clamp(shifted);
                shifted == part.flux || shifted.is_nan()
            });
            if open.len() == before {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn laws() -> impl Strategy<Value = Law> {
        (-1.0..0.5f64, 0.01..2.0f64).prop_map(|(lo, width)| Law::new(lo, lo + width).unwrap())
    }

    /// Means over an edge, by the midpoint rule, of j(w) and of the work of a linear flux on w.
    fn by_points(law: Law, [p, q]: [f64; 2], [a, b]: [f64; 2], bubble: f64) -> [f64; 2] {
        const POINTS: usize = 4000;
        let mut sums = [0.0; 2];
        for k in 0..POINTS {
            let t = (k as f64 + 0.5) / POINTS as f64;
            let w = p + t * (q - p) - bubble * t * (1.0 - t);
            sums[0] += law.potential(w);
            sums[1] += law.potential(w) + w * (a + t * (b - a));
        }
        sums.map(|sum| sum / POINTS as f64)
    }

    proptest! {
        #[test]
        fn integrals_over_edges_are_those_of_a_sum_over_points(
            law in laws(), ends in prop::array::uniform2(-1.0..1.0f64), bubble in -1.0..1.0f64,
            fluxes in prop::array::uniform2(-1.0..1.0f64), same in any::<bool>(),
        ) {
            let ends = if same { ends.map(|end| end.abs() * ends[0].signum()) } else { ends };
            let bubble = limit_bubble(bubble, ends);
            let part = PartLaw::new(law, 1.0);
            let [potential, work] = by_points(law, ends, fluxes, bubble);
            prop_assert!((part.potential(ends, bubble) - potential).abs() < 1e-5);
            prop_assert!((part.work(ends, fluxes, bubble) - work).abs() < 1e-5);
            let least = fluxes.map(|flux| law.project(flux));
            prop_assert!(part.work(ends, least, bubble) >= -1e-15);
            let [_, work] = by_points(law, ends, fluxes, 0.0);
            prop_assert!((part.work_of_facet(ends, fluxes) - work).abs() < 1e-5);
        }

        #[test]
        fn a_triangle_has_the_integral_of_its_pieces(values in prop::array::uniform3(-1.0..1.0f64)) {
            // Each of many small triangles, with its values at the centre.
            const SIDE: usize = 200;
            let (mut sum, mut count) = (0.0, 0.0);
            for i in 0..SIDE {
                for j in 0..SIDE - i {
                    for centre in [1.0 / 3.0, 2.0 / 3.0] {
                        let at = [i as f64 + centre, j as f64 + centre].map(|x| x / SIDE as f64);
                        if at[0] + at[1] < 1.0 {
                            let last = 1.0 - at[0] - at[1];
                            let value = at[0] * values[0] + at[1] * values[1] + last * values[2];
                            sum += value.max(0.0);
                            count += 1.0;
                        }
                    }
                }
            }
            prop_assert!((positive_mean(values) - sum / count).abs() < 1e-4);
        }

        #[test]
        fn a_shift_reaches_the_sum_within_the_interval(
            law in laws(), fluxes in prop::collection::vec((-1.0..1.0f64, 0.1..2.0f64), 1..20),
            fraction in 0.001..0.999f64,
        ) {
            let mut parts = Vec::new();
            for (flux, measure) in fluxes {
                let part = PartLaw::new(law, measure);
                parts.push(BoundaryPart { flux: measure * law.project(flux), measure, law: part });
            }
            let perimeter: f64 = parts.iter().map(|part| part.measure).sum();
            let sum = perimeter * (law.lo() + fraction * (law.hi() - law.lo()));
            shift_to_sum(&mut parts, sum);
            prop_assert!((parts.iter().map(|part| part.flux).sum::<f64>() - sum).abs() < 1e-13);
            for part in parts {
                prop_assert!(part.law.room(part.flux) >= 0.0);
            }
        }
    }
}
