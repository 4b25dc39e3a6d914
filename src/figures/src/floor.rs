//! Rectangles below surfaces, with the coordinates of the domain along their sides.

use super::text::{fixed, power_of_ten, short, without_zeros};

/// Places of the marks along a side of the floor, from its middle, over half of the side.
const MARKS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// Least half side of a floor, so that the numbers along it do not meet: longer domains are drawn wider than they are.
const LEAST_HALF: f64 = 0.25;
/// Largest coordinate, in lengths of its side, that is written from the origin on: further away numbers are long, and
/// are those from the first mark on.
const FAR: f64 = 100.0;
/// Largest coordinates that are written without a power of ten.
const PLAIN: std::ops::Range<f64> = 0.1..1e4;

/// Rectangle below a surface, around the origin of the box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor {
    /// Half of each side, at most 1/2.
    pub(super) half: [f64; 2],
    /// Coordinates of the domain at both ends of each side.
    ends: [(f64, f64); 2],
}

impl Floor {
    /// Floor below the bounding box of points.
    pub(super) fn around(points: &[[f64; 2]]) -> Self {
        let ends = [0, 1].map(|d| super::range(points.iter().map(|point| point[d])));
        let sides = ends.map(|(low, high)| high - low);
        let longest = sides[0].max(sides[1]);
        Self { half: sides.map(|side| (0.5 * side / longest).max(LEAST_HALF)), ends }
    }

    /// Returns the place of a point of the domain in the box.
    pub(super) fn inside(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let (low, high) = self.ends[d];
            self.half[d] * (2.0 * (point[d] - low) / (high - low) - 1.0)
        })
    }

    /// Returns the places of the marks along a side.
    pub(super) fn marks(&self, d: usize) -> [f64; 5] {
        MARKS.map(|t| t * self.half[d])
    }

    /// Returns the coordinate from which the numbers along a side are written: zero, or that of the first mark to three
    /// digits of the length of the side.
    fn from(&self, d: usize) -> f64 {
        let (low, high) = self.ends[d];
        let is_far = low.abs().max(high.abs()) > FAR * (high - low);
        if is_far { rounded(low, high - low) } else { 0.0 }
    }

    /// Returns the exponent of the power of ten by which the coordinates are divided before they are written; zero
    /// unless they are long.
    fn power(&self) -> i32 {
        let mut largest = 0.0f64;
        for (d, (low, high)) in self.ends.iter().enumerate() {
            largest = largest.max((low - self.from(d)).abs()).max((high - self.from(d)).abs());
        }
        if PLAIN.contains(&largest) { 0 } else { magnitude(largest) }
    }

    /// Returns what is to be said of the numbers; none if they are the coordinates.
    pub(super) fn note(&self) -> Option<String> {
        let power = self.power();
        let names = [0, 1].map(|d| {
            let (name, from, (low, high)) = (["x", "y"][d], self.from(d), self.ends[d]);
            let decimals = usize::try_from(2 - magnitude(high - low)).unwrap_or(0);
            let sign = if from < 0.0 { '+' } else { '\u{2212}' };
            match from == 0.0 {
                true => name.to_string(),
                false => format!("{name} {sign} {}", without_zeros(&fixed(from.abs(), decimals))),
            }
        });
        let is_plain = power == 0 && [0, 1].iter().all(|&d| self.from(d) == 0.0);
        let over = if power == 0 { String::new() } else { format!(" / {}", power_of_ten(power)) };
        (!is_plain).then(|| names.join(", ") + &over)
    }

    /// Returns the numbers at the first, the middle and the last mark of a side.
    ///
    /// They have three digits of the length of the side: the eye sees no more.
    pub(super) fn numbers(&self, d: usize) -> [String; 3] {
        let unit = libm::exp10(f64::from(self.power()));
        let (low, high) = self.ends[d];
        let [low, high] = [low, high].map(|end| (end - self.from(d)) / unit);
        [low, 0.5 * (low + high), high].map(|value| short(rounded(value, high - low)))
    }
}

/// Returns a coordinate with three digits of a length.
fn rounded(value: f64, length: f64) -> f64 {
    let digit = libm::exp10(f64::from(magnitude(length) - 2));
    (value / digit).round() * digit
}

/// Returns the exponent of the greatest power of ten up to a number.
fn magnitude(number: f64) -> i32 {
    libm::floor(libm::log10(number)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_has_the_coordinates_of_the_bounding_box() {
        let floor = Floor::around(&[[1.0, -3.0], [5.0, -3.0], [2.0, -1.0]]);
        assert_eq!(floor.half, [0.5, 0.25]);
        assert_eq!(floor.inside([5.0, -2.0]), [0.5, 0.0]);
        assert_eq!(floor.numbers(1), ["\u{2212}3", "\u{2212}2", "\u{2212}1"]);
        let long = Floor::around(&[[0.0, 0.0], [100.0, 1.0 / 3.0]]);
        assert_eq!(long.half, [0.5, LEAST_HALF]);
        assert_eq!(long.numbers(1), ["0", "0.167", "0.333"]);
        assert_eq!(Floor::around(&[[-0.5; 2], [0.5; 2]]).numbers(0), ["\u{2212}0.5", "0", "0.5"]);
    }

    #[test]
    fn coordinates_far_from_the_origin_are_numbers_from_the_first_mark_on() {
        let floor = Floor::around(&[[50_331_655.25, -7.0], [50_331_656.25, -6.0]]);
        assert_eq!(floor.numbers(0), ["0", "0.5", "1"]);
        assert_eq!(floor.numbers(1), ["\u{2212}7", "\u{2212}6.5", "\u{2212}6"]);
        assert_eq!(floor.note().unwrap(), "x \u{2212} 50331655.25, y");
        let small = Floor::around(&[[-3.0, 0.0], [-3.0 + 1e-9, 1e-9]]);
        assert_eq!(small.note().unwrap(), "x + 3, y / 10\u{207b}\u{2079}");
        assert_eq!(Floor::around(&[[0.0; 2], [1.0; 2]]).note(), None);
    }

    #[test]
    fn long_coordinates_are_numbers_over_a_power_of_ten() {
        let floor = Floor::around(&[[0.0, 0.0], [1.0, 12345.0]]);
        assert_eq!(floor.power(), 4);
        let floor = Floor::around(&[[-2e-12, 0.0], [2e-12, 1e-12]]);
        assert_eq!(floor.power(), -12);
        assert_eq!(floor.numbers(0), ["\u{2212}2", "0", "2"]);
        assert_eq!(floor.numbers(1), ["0", "0.5", "1"]);
    }
}
