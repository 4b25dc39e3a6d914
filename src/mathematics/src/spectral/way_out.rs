//! Ways outside of a domain, along which jumps of f are led away from its boundary.

use super::domain::{PlaneDomain, PlaneSide};
use crate::problem::complex::Complex;
use std::f64::consts::TAU;

/// Way outside of a domain.
pub(super) struct WayOut {
    /// Points at which it bends; without a ray, the last is its end.
    pub bends: Vec<Complex>,
    /// Direction from the last of them, or the start, to infinity.
    pub ray: Option<Complex>,
}

impl PlaneDomain {
    /// Way from a point outside of the domain to infinity, or in a hole to its middle; none if it has too many bends.
    pub(super) fn way_out(&self, z: Complex) -> Option<WayOut> {
        /// Most bends, ways that are followed at once, and directions in which they are.
        const BENDS: usize = 4;
        const WAYS: usize = 40;
        const DIRECTIONS: u32 = 24;
        let [x, y] = self.extent().map(|[low, high]| 0.5 * (low + high));
        let centre = Complex::new(x, y);
        let mut ways: Vec<Vec<Complex>> = vec![vec![z]];
        for _ in 0..BENDS {
            for way in &ways {
                let last = way[way.len() - 1];
                let bends = way[1..].to_vec();
                if let ray @ Some(_) = self.free_ray(last, last - centre) {
                    return Some(WayOut { bends, ray });
                }
                let mut middles = self.loops[1..].iter().map(|hole| middle(hole));
                if let Some(middle) = middles.find(|&middle| self.sees(last, middle)) {
                    let to_middle = (middle != last).then_some(middle);
                    return Some(WayOut {
                        bends: bends.into_iter().chain(to_middle).collect(),
                        ray: None,
                    });
                }
            }
            // On by half of the way to the boundary, first to where there is most room.
            let mut longer = Vec::new();
            for way in &ways {
                let last = way[way.len() - 1];
                for k in 0..DIRECTIONS {
                    let direction = Complex::unit(TAU / f64::from(DIRECTIONS) * f64::from(k));
                    let next = last + direction.scaled(0.5 * self.exit(last, direction));
                    longer.push((self.depth(next), [&way[..], &[next]].concat()));
                }
            }
            longer.sort_by(|one, other| one.0.total_cmp(&other.0));
            ways = longer.into_iter().take(WAYS).map(|(_, way)| way).collect();
        }
        None
    }

    /// Direction of a ray from a point outside of the domain that does not meet it: the nearest to a wanted one.
    fn free_ray(&self, z: Complex, wanted: Complex) -> Option<Complex> {
        /// Angle between directions, and number of pairs of them.
        const TURN: f64 = 0.1;
        const PAIRS: i32 = 31;
        let size = wanted.norm();
        let first = if size > 0.0 { wanted.scaled(1.0 / size) } else { Complex::new(1.0, 0.0) };
        let turned = (1..=PAIRS).flat_map(|k| [k, -k]);
        let turned = turned.map(|k| first * Complex::unit(TURN * f64::from(k)));
        let mut directions = [first].into_iter().chain(turned);
        directions.find(|&direction| self.exit(z, direction).is_infinite())
    }

    /// True if the boundary lies nowhere between two points.
    fn sees(&self, from: Complex, to: Complex) -> bool {
        let way = to - from;
        let length = way.norm();
        length == 0.0 || self.exit(from, way.scaled(1.0 / length)) > length
    }
}

/// Middle of a hole: the mean of points of its boundary, or the point of the hole with most room round it.
pub(super) fn middle(sides: &[PlaneSide]) -> Complex {
    let mut mean = Complex::default();
    let many = 16.0 * sides.len() as f64;
    for side in sides {
        for k in 0..16 {
            let point = side.point(side.length() * (f64::from(k) + 0.5) / 16.0);
            mean = mean + point.scaled(1.0 / many);
        }
    }
    let hole = PlaneDomain { loops: vec![sides.to_vec()] };
    if hole.holds(mean) {
        return mean;
    }
    let points = hole.inner_points(200).into_iter();
    points.max_by(|&a, &b| hole.distance(a).total_cmp(&hole.distance(b))).unwrap_or(mean)
}
