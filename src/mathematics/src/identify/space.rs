//! Candidates: f with constant values on quadrants, and decimals as these values.

use super::IdentifyError;
use crate::problem::shape::{QUADRANTS, Shape};
use crate::problem::source::Source;
use std::str::FromStr;

/// Disjoint pieces of the square on each of which f is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    regions: Vec<Shape<2>>,
    /// True if what the regions leave is a piece as well; it is the last one.
    rest: bool,
}

impl Geometry {
    /// The four quadrants: lower left, lower right, upper left, upper right.
    pub fn quadrants() -> Self {
        Self { regions: QUADRANTS.map(|(_, sides)| Shape::Box(sides)).into(), rest: false }
    }

    /// Two pieces, a quadrant and the rest, for each of the quadrants.
    pub fn odd_quadrants() -> [Self; 4] {
        QUADRANTS.map(|(_, sides)| Self { regions: vec![Shape::Box(sides)], rest: true })
    }

    /// The pieces of an f made of quadrants, with a background if they leave any, and its values on them; `None` for
    /// any other f.
    pub fn of_quadrants(f: &Source) -> Option<(Self, Vec<f64>)> {
        let Source::Pieces { background, pieces } = f else { return None };
        let quadrant = |(shape, _): &(Shape<2>, f64)| {
            QUADRANTS.iter().any(|(_, sides)| *shape == Shape::Box(*sides))
        };
        if pieces.is_empty() || !pieces.iter().all(quadrant) {
            return None;
        }
        let (regions, mut values): (Vec<_>, Vec<_>) = pieces.iter().copied().unzip();
        let rest = !Shape::cover(&regions);
        values.extend(rest.then_some(*background));
        Some((Self { regions, rest }, values))
    }

    /// Number of pieces, hence of values.
    pub fn pieces(&self) -> usize {
        self.regions.len() + usize::from(self.rest)
    }

    /// The f that takes these values on the pieces.
    ///
    /// # Panics
    /// If there is not one value per piece.
    pub fn source(&self, values: &[f64]) -> Source {
        assert_eq!(values.len(), self.pieces());
        let background = if self.rest { values[self.regions.len()] } else { 0.0 };
        let pieces = self.regions.iter().copied().zip(values.iter().copied()).collect();
        Source::Pieces { background, pieces }
    }

    /// The f that is 1 on piece `p` and 0 elsewhere.
    pub fn indicator(&self, p: usize) -> Source {
        let mut values = vec![0.0; self.pieces()];
        values[p] = 1.0;
        self.source(&values)
    }
}

/// Decimals that a value of f may take: from the first in equal steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    /// First value, in units of `10^-places`.
    first: i64,
    /// Step, in the same units.
    step: i64,
    points: u64,
    places: u32,
}

/// Decimal places beyond which a lattice is refused: doubles could not tell its points apart.
const MAX_PLACES: u32 = 9;
/// Largest value of a point.
const LARGEST: i64 = 1_000_000_000;
/// Points beyond which a lattice is refused: no search could go through them.
const MAX_POINTS: u64 = 10_000_000;

impl Lattice {
    /// Number of values.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// True if the numbers of a value on a quadrant and one elsewhere are points, with which the integral of f is
    /// negative, as (2) asks.
    pub(super) fn is_candidate(&self, numbers: [u64; 2]) -> bool {
        if numbers.iter().any(|number| *number >= self.points) {
            return false;
        }
        let [on_quadrant, elsewhere] = numbers.map(|number| self.first + number as i64 * self.step);
        on_quadrant + 3 * elsewhere < 0
    }

    /// Values of f on a quadrant and elsewhere, by their numbers: the doubles nearest to the decimals.
    pub(super) fn values(&self, numbers: [u64; 2]) -> [f64; 2] {
        // Powers of ten up to 10^22 are exact: the quotient is rounded once.
        numbers.map(|number| (self.first + number as i64 * self.step) as f64 / self.unit())
    }

    /// Values in the middle of a block of candidates, given the numbers of its first values and how many it has along
    /// each axis; and how far the values of each are from those at most.
    pub(super) fn middle(&self, first: [u64; 2], side: u64) -> ([f64; 2], f64) {
        let (step, half) = (self.step as f64 / self.unit(), 0.5 * (side - 1) as f64);
        let middle = |number: u64| self.first as f64 / self.unit() + step * (number as f64 + half);
        (first.map(middle), step * half)
    }

    fn unit(&self) -> f64 {
        10f64.powi(self.places as i32)
    }
}

/// Reads `MIN:MAX:STEP`.
impl FromStr for Lattice {
    type Err = IdentifyError;

    fn from_str(text: &str) -> Result<Self, IdentifyError> {
        let wrong = || IdentifyError::Values(text.into());
        let parsed: Option<Vec<_>> = text.split(':').map(|part| decimal(part.trim())).collect();
        let parsed = parsed.ok_or_else(wrong)?;
        let places = parsed.iter().map(|&(_, places)| places).max().unwrap_or(0);
        // Small enough for any number of places in 64 bits, and for the sum of four.
        let most = LARGEST * 10i64.pow(places);
        let scaled =
            |&(t, p): &(i64, u32)| t.checked_mul(10i64.pow(places - p)).filter(|t| t.abs() <= most);
        let ticks: Option<Vec<i64>> = parsed.iter().map(scaled).collect();
        let [first, last, step] = ticks.ok_or_else(wrong)?[..] else { return Err(wrong()) };
        if step <= 0 || first > last {
            return Err(wrong());
        }
        let points = ((last - first) / step) as u64 + 1;
        match points > MAX_POINTS {
            true => Err(IdentifyError::LargeLattice(text.into())),
            false => Ok(Self { first, step, points, places }),
        }
    }
}

/// A decimal such as `-1.25` as (-125, 2).
fn decimal(text: &str) -> Option<(i64, u32)> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    let all = format!("{whole}{fraction}");
    let plain = !digits.is_empty() && all.len() <= 15 && all.bytes().all(|b| b.is_ascii_digit());
    let places = fraction.len() as u32;
    if !plain || (whole.is_empty() && digits.len() == 1) || places > MAX_PLACES {
        return None;
    }
    Some((sign * if all.is_empty() { 0 } else { all.parse::<i64>().ok()? }, places))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::square::load::integral;

    #[test]
    fn the_pieces_of_quadrants_are_those_with_an_area() {
        for (text, known) in [
            ("quadrant(ll)=3; else=-1", Some(vec![3.0, -1.0])),
            (
                "quadrant(ll)=1; quadrant(lr)=2; quadrant(ul)=3; else=-1",
                Some(vec![1.0, 2.0, 3.0, -1.0]),
            ),
            (
                "quadrant(ll)=1; quadrant(lr)=2; quadrant(ul)=3; quadrant(ur)=-7",
                Some(vec![1.0, 2.0, 3.0, -7.0]),
            ),
            ("quadrant(ll)=1; disc(0,0,0.1)=2; else=-1", None),
            ("else=-1", None),
        ] {
            let found = Geometry::of_quadrants(&text.parse().unwrap());
            assert_eq!(found.as_ref().map(|(_, values)| values.clone()), known, "{text}");
            if let Some((geometry, values)) = found {
                assert_eq!(geometry.pieces(), values.len(), "{text}");
                for piece in 0..values.len() {
                    assert!(integral(&geometry.indicator(piece)) > 0.2, "{text}");
                }
            }
        }
    }

    #[test]
    fn lattices_are_exact_decimals() {
        let lattice: Lattice = "-1:1:0.25".parse().unwrap();
        assert_eq!(lattice.points(), 9);
        assert_eq!((lattice.values([8, 1]), lattice.is_candidate([8, 1])), ([1.0, -0.75], true));
        assert!(!lattice.is_candidate([7, 3]), "0.75 and -0.25: the integral vanishes");
        assert!(!lattice.is_candidate([9, 0]));
        assert_eq!(lattice.middle([2, 0], 4), ([-0.125, -0.625], 0.375));
        for bad in ["", "1:2", "one", "1e3", "2:1:1", "0:1:0", ".", "1", "0:1:0.0000000001"] {
            assert!(bad.parse::<Lattice>().is_err(), "{bad}");
        }
    }
}
