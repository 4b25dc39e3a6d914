//! Families of candidate f: geometries of constant pieces, and decimals as their values.

use super::IdentifyError;
use crate::discrete::load::integral;
use crate::problem::shape::{QUADRANTS, Shape};
use crate::problem::source::Source;
use serde::{Deserialize, Serialize};

/// A family of right-hand sides with two values, one on a region and one on the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Space {
    /// The region is a quadrant, any of the four.
    OddQuadrant,
    /// The region is a rectangle with corners on the lines of the grid 1/4.
    Rectangles,
}

/// Lines of the grid 1/4.
const LINES: [f64; 5] = [-0.5, -0.25, 0.0, 0.25, 0.5];

impl Space {
    /// The geometries of the family.
    pub fn geometries(self) -> Vec<Geometry> {
        match self {
            Self::OddQuadrant => QUADRANTS
                .map(|(_, sides)| Geometry { regions: vec![Shape::Box(sides)], rest: true })
                .into(),
            Self::Rectangles => rectangles(),
        }
    }
}

/// Every rectangle with corners on [`LINES`] but the whole square.
fn rectangles() -> Vec<Geometry> {
    let mut spans = Vec::new();
    for (k, &from) in LINES.iter().enumerate() {
        spans.extend(LINES[k + 1..].iter().map(|&to| [from, to]));
    }
    let whole = [LINES[0], LINES[LINES.len() - 1]];
    let mut all = Vec::new();
    for &x in &spans {
        for &y in spans.iter().filter(|&&y| [x, y] != [whole; 2]) {
            all.push(Geometry { regions: vec![Shape::Box([x, y])], rest: true });
        }
    }
    all
}

/// Disjoint pieces of the square on each of which f is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    regions: Vec<Shape<2>>,
    /// Whether what the regions leave is a piece as well; it is the last one.
    rest: bool,
}

impl Geometry {
    /// The four quadrants: lower left, lower right, upper left, upper right.
    pub fn quadrants() -> Self {
        Self { regions: QUADRANTS.map(|(_, sides)| Shape::Box(sides)).into(), rest: false }
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

    /// Areas of the pieces.
    pub fn areas(&self) -> Vec<f64> {
        (0..self.pieces()).map(|p| integral(&self.indicator(p))).collect()
    }
}

/// Decimals with a fixed number of places that a value of f may take, in increasing order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lattice {
    ticks: Vec<i64>,
    places: u32,
}

/// Decimal places beyond which a lattice is refused: doubles could not tell its points apart.
const MAX_PLACES: u32 = 9;
/// Largest value of a point.
const LARGEST: i64 = 1_000_000_000;
/// Points beyond which a lattice is refused: no search could go through them.
const MAX_POINTS: i64 = 10_000_000;

impl Lattice {
    /// Reads `MIN:MAX:STEP` or a comma-separated list of decimals.
    fn parse(text: &str) -> Result<Self, IdentifyError> {
        let wrong = || IdentifyError::Values(text.into());
        let decimals = |parts: std::str::Split<'_, char>| -> Result<Vec<(i64, u32)>, _> {
            parts.map(|part| decimal(part.trim()).ok_or_else(wrong)).collect()
        };
        let range = text.contains(':');
        let parsed = decimals(text.split(if range { ':' } else { ',' }))?;
        let places = parsed.iter().map(|&(_, places)| places).max().unwrap_or(0);
        // Small enough for any number of places in 64 bits, and for the difference of two.
        let most = LARGEST * 10i64.pow(places);
        let scaled =
            |&(t, p): &(i64, u32)| t.checked_mul(10i64.pow(places - p)).filter(|t| t.abs() <= most);
        let mut ticks: Vec<i64> =
            parsed.iter().map(scaled).collect::<Option<_>>().ok_or_else(wrong)?;
        if range {
            let [min, max, step] = ticks[..] else { return Err(wrong()) };
            if step <= 0 || min > max {
                return Err(IdentifyError::EmptyLattice(text.into()));
            }
            let steps = (max - min) / step;
            if steps >= MAX_POINTS {
                return Err(IdentifyError::LargeLattice(text.into()));
            }
            ticks = (0..=steps).map(|k| min + k * step).collect();
        }
        ticks.sort_unstable();
        ticks.dedup();
        Ok(Self { ticks, places })
    }

    /// Reads one lattice for all values, or several separated by `;`, one per value.
    ///
    /// # Errors
    /// [`IdentifyError::Values`] or [`IdentifyError::EmptyLattice`] quoting the faulty part.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, IdentifyError> {
        text.split(';').map(|part| Self::parse(part.trim())).collect()
    }

    /// This lattice with its points written to `places` decimal places, not fewer than now.
    pub(super) fn refined(&self, places: u32) -> Self {
        let factor = 10i64.pow(places - self.places);
        Self { ticks: self.ticks.iter().map(|t| t * factor).collect(), places }
    }

    /// Decimal places of the points.
    pub fn places(&self) -> u32 {
        self.places
    }

    /// The points, in units of `10^-places`.
    pub fn ticks(&self) -> &[i64] {
        &self.ticks
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

/// One right-hand side: a geometry of its space, and exact decimals as values.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Candidate {
    /// Index into the geometries of the evaluator, such as [`Space::geometries`].
    pub geometry: usize,
    /// The values, in units of `10^-places`, one per piece.
    pub ticks: Vec<i64>,
    /// Decimal places of `ticks`.
    pub places: u32,
}

/// The doubles nearest to decimals, given in units of `10^-places`.
pub(super) fn decimals(ticks: &[i64], places: u32) -> impl Iterator<Item = f64> {
    // Powers of ten up to 10^22 are exact: the quotient is rounded once.
    let unit = 10f64.powi(places as i32);
    ticks.iter().map(move |&tick| tick as f64 / unit)
}

impl Candidate {
    /// The values of f, one per piece: the doubles nearest to the decimals.
    pub fn values(&self) -> Vec<f64> {
        decimals(&self.ticks, self.places).collect()
    }

    /// Complexity of f: number of distinct values, and their decimal places.
    pub fn complexity(&self) -> u32 {
        let mut ticks = self.ticks.clone();
        ticks.sort_unstable();
        ticks.dedup();
        let places = |t: i64| {
            let zeros = (0..self.places).take_while(|&k| t % 10i64.pow(k + 1) == 0).count();
            self.places - zeros as u32
        };
        ticks.iter().map(|&t| 1 + places(t)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_every_geometry_fill_the_square() {
        let families = [Space::OddQuadrant, Space::Rectangles].map(Space::geometries);
        for geometry in families.into_iter().flatten().chain([Geometry::quadrants()]) {
            let whole: f64 = geometry.areas().iter().sum();
            assert!((whole - 1.0).abs() < 1e-12, "{geometry:?}: {whole}");
        }
        assert_eq!(Space::Rectangles.geometries().len(), 99);
    }

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
                let areas = geometry.areas();
                assert!(
                    areas.len() == values.len() && areas.iter().all(|&area| area > 0.2),
                    "{text}"
                );
            }
        }
    }

    #[test]
    fn lattices_are_exact_decimals() {
        let range = Lattice::parse_all("-1:1:0.25").unwrap();
        assert_eq!(range[0].ticks(), [-100, -75, -50, -25, 0, 25, 50, 75, 100]);
        let list = Lattice::parse_all("-6, 2,1.990; 3").unwrap();
        assert_eq!((list[0].ticks(), list[0].places()), (&[-600, 199, 200][..], 2));
        assert_eq!((list[1].ticks(), list[1].places()), (&[3][..], 0));
        for bad in ["", "1:2", "one", "1e3", "2:1:1", "0:1:0", ".", "1.0000000001"] {
            assert!(Lattice::parse_all(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn short_decimals_and_few_values_are_simple() {
        let f = |ticks: &[i64]| {
            Candidate { geometry: 0, ticks: ticks.to_vec(), places: 2 }.complexity()
        };
        assert_eq!(f(&[-600, 200, 200, 200]), 2);
        assert_eq!(f(&[-600, 200, 199, 200]), 5);
        assert_eq!(f(&[315, -85, -105, -110]), 11);
    }
}
