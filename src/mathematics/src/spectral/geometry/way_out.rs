//! Ways outside of a domain, along which jumps of f are led away from its boundary.

use super::domain::PlaneDomain;
use super::ring::PlaneRing;
use crate::problem::complex::Complex;

/// Way outside of a domain.
pub(crate) struct WayOut {
    /// Points at which it bends; without a ray, the last is its end.
    pub bends: Vec<Complex>,
    /// Direction from the last of them, or the start, to infinity.
    pub ray: Option<Complex>,
}

impl PlaneDomain {
    /// Way from a point outside of the domain to infinity, or in a hole to its middle, with the fewest bends: in posts
    /// before corners and sides. None if there is none by those.
    pub(crate) fn way_out(&self, z: Complex) -> Option<WayOut> {
        let centre = self.centre();
        let middles: Vec<Complex> = self.rings[1..].iter().map(middle).collect();
        let (mut ways, mut posts): (Vec<Vec<Complex>>, _) = (vec![vec![]], None);
        let mut next = 0;
        while next < ways.len() {
            let bends = ways[next].clone();
            let last = bends.last().copied().unwrap_or(z);
            if let ray @ Some(_) = self.free_ray(last, last - centre) {
                return Some(WayOut { bends, ray });
            }
            if let Some(&middle) = middles.iter().find(|&&middle| self.sees(last, middle)) {
                let to_middle = (middle != last).then_some(middle);
                return Some(WayOut {
                    bends: bends.into_iter().chain(to_middle).collect(),
                    ray: None,
                });
            }
            let unseen: &mut Vec<Complex> = posts.get_or_insert_with(|| self.posts());
            unseen.retain(|&post| {
                let sees = self.sees(last, post);
                if sees {
                    ways.push([&bends[..], &[post]].concat());
                }
                !sees
            });
            next += 1;
        }
        None
    }

    /// Points outside, on half of the way from each corner and the middle of each side to the boundary.
    fn posts(&self) -> Vec<Complex> {
        let (mut posts, size) = (Vec::new(), self.diameter());
        for ring in &self.rings {
            for (k, side) in ring.sides.iter().enumerate() {
                let [before, after] = ring.tangents(k);
                let along = before + after;
                let middle = 0.5 * side.length();
                for (from, along) in
                    [(side.point(0.0), along), (side.point(middle), side.tangent(middle))]
                {
                    let outwards = -along.turned().scaled(1.0 / along.norm().max(1e-9));
                    posts.push(from + outwards.scaled(0.5 * self.exit(from, outwards).min(size)));
                }
            }
        }
        posts
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
pub(crate) fn middle(ring: &PlaneRing) -> Complex {
    let mut mean = Complex::default();
    let many = 16.0 * ring.sides.len() as f64;
    for side in &ring.sides {
        for k in 0..16 {
            let point = side.point(side.length() * (f64::from(k) + 0.5) / 16.0);
            mean = mean + point.scaled(1.0 / many);
        }
    }
    let hole = PlaneDomain { rings: vec![ring.clone()], ..PlaneDomain::default() };
    if hole.holds(mean) {
        return mean;
    }
    let points = hole.inner_points(200).into_iter();
    points.max_by(|&a, &b| hole.distance(a).total_cmp(&hole.distance(b))).unwrap_or(mean)
}
