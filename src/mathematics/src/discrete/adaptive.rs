//! Integrals over a triangle or tetrahedron of a function that is given by its values alone.
//!
//! A part of the cell counts as settled if two formulas, of degree 5 inside and of degree 3 with the corners, the
//! midpoints of the edges and the centroid, agree there on the integrals of the function times the hat functions. A
//! part that is not settled is halved across its longest edge, the part with the largest difference first.
//!
//! All vertices of the cell and midpoints of its edges are among the points, however it is halved: poles there, which
//! points inside would miss, are refused.

use super::quadrature::{QuadraturePoint, quadrature};
use crate::problem::error::SourceError;

/// Integrals of a function over a cell, over the volume of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SampledCell<const V: usize> {
    /// Of the function times the hat functions of the vertices.
    pub shares: [f64; V],
    /// Mean of the function.
    pub mean: f64,
    /// Mean square of the function less its mean.
    pub variance: f64,
    /// Mean of the absolute value.
    pub size: f64,
    /// Sum over all parts of the differences between the two formulas.
    pub difference: f64,
    /// Largest difference of a part over the power of its share of the cell that [`Settling`] allows.
    pub worst: f64,
}

/// Value that is not finite, and its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BadValue<const D: usize> {
    /// Value.
    pub value: f64,
    /// Point.
    pub point: [f64; D],
}

impl<const D: usize> From<BadValue<D>> for SourceError {
    fn from(BadValue { value, point }: BadValue<D>) -> Self {
        Self::no_value(value, &point)
    }
}

/// Parts of cells at least over a whole domain: peaks of a width of some hundredths of the domain are not missed.
pub(crate) const LEAST_PARTS: usize = 1 << 15;
/// Difference of the formulas on a part of a domain up to which it is settled, over the integral of |f| and the share
/// of the part to the power (D - 1) / D.
pub(crate) const SETTLED: f64 = 1e-6;
/// Numbers whose work takes as long as that on a cell.
pub(crate) const COST: usize = 64;

/// Parts of a cell at which its division ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settling {
    /// Parts of equal volume at least, a power of two: between fewer points a narrow peak would not be seen.
    pub least_parts: usize,
    /// Parts at most, if there are more than the least.
    pub most_parts: usize,
    /// Difference of a part up to which it is settled, over the power (D - 1) / D of its share of the cell: summed over
    /// the parts that a jump of the function crosses, the differences do not exceed a multiple of it.
    pub tolerance: f64,
}

/// Points and weights of both formulas on a cell with V vertices.
#[derive(Clone, Debug)]
pub(crate) struct Sampler<const V: usize> {
    /// Formula of degree 5, the centroid first.
    inner: Vec<QuadraturePoint<V>>,
    /// Formula of degree 3, the centroid last.
    outer: Vec<QuadraturePoint<V>>,
}

/// Part of a cell, with integrals over its volume.
#[derive(Clone, Copy, Debug)]
struct SampledPart<const V: usize> {
    /// Barycentric coordinates of the corners in the cell.
    corners: [[f64; V]; V],
    /// Volume over that of the cell.
    fraction: f64,
    /// Integrals; the shares and the differences are times `fraction`.
    of: SampledCell<V>,
}

impl<const V: usize> SampledCell<V> {
    const ZERO: Self =
        Self { shares: [0.0; V], mean: 0.0, variance: 0.0, size: 0.0, difference: 0.0, worst: 0.0 };
}

impl<const V: usize> Default for Sampler<V> {
    fn default() -> Self {
        // Exact for degree 3, as on a triangle Simpson's rule on its edges and centroid.
        let [corner, middle, centre] = match V {
            3 => [1.0 / 20.0, 2.0 / 15.0, 9.0 / 20.0],
            _ => [1.0 / 60.0, 1.0 / 15.0, 8.0 / 15.0],
        };
        let mut outer = Vec::new();
        for a in 0..V {
            outer.push(QuadraturePoint { barycentric: unit(a), weight: corner });
            for b in 0..a {
                outer.push(QuadraturePoint {
                    barycentric: halfway(unit(a), unit(b)),
                    weight: middle,
                });
            }
        }
        outer.push(QuadraturePoint { barycentric: [1.0 / V as f64; V], weight: centre });
        Self { inner: quadrature(), outer }
    }
}

impl<const V: usize> Sampler<V> {
    /// Integrates a function over a cell.
    ///
    /// # Errors
    /// [`BadValue`] where the function is infinite at a point, or no number at a point and beside it.
    pub(crate) fn integrate<const D: usize>(
        &self,
        cell: &CellValues<'_, D, V>,
        settling: Settling,
    ) -> Result<SampledCell<V>, BadValue<D>> {
        let whole = std::array::from_fn(unit);
        let mut open = Vec::new();
        if settling.least_parts < 2 {
            let whole = self.part(cell, whole, 1.0)?;
            if whole.of.worst <= settling.tolerance {
                return Ok(whole.of);
            }
            open.push(whole);
        } else {
            let mut pieces = vec![whole];
            while pieces.len() < settling.least_parts {
                pieces = pieces.into_iter().flat_map(|corners| cell.halves(corners)).collect();
            }
            let fraction = 1.0 / pieces.len() as f64;
            for corners in pieces {
                open.push(self.part(cell, corners, fraction)?);
            }
        }
        let mut sum = SampledPart { corners: whole, fraction: 0.0, of: SampledCell::ZERO };
        let mut parts = open.len();
        loop {
            let is_settled = |part: &SampledPart<V>| part.of.worst <= settling.tolerance;
            open.iter().filter(|part| is_settled(part)).for_each(|part| sum.add(part));
            open.retain(|part| !is_settled(part));
            let room = settling.most_parts.saturating_sub(parts);
            if open.len() > room {
                open.sort_by(|p, q| q.of.worst.total_cmp(&p.of.worst));
                open.drain(room..).for_each(|part| sum.add(&part));
            }
            if open.is_empty() {
                return Ok(sum.of);
            }
            parts += open.len();
            open = self.halved(cell, &open)?;
        }
    }

    /// Halves of some parts, each across its longest edge.
    fn halved<const D: usize>(
        &self,
        cell: &CellValues<'_, D, V>,
        parts: &[SampledPart<V>],
    ) -> Result<Vec<SampledPart<V>>, BadValue<D>> {
        let mut halves = Vec::with_capacity(2 * parts.len());
        for part in parts {
            for corners in cell.halves(part.corners) {
                halves.push(self.part(cell, corners, 0.5 * part.fraction)?);
            }
        }
        Ok(halves)
    }

    /// Integrals over the part of a cell with these corners.
    fn part<const D: usize>(
        &self,
        cell: &CellValues<'_, D, V>,
        corners: [[f64; V]; V],
        fraction: f64,
    ) -> Result<SampledPart<V>, BadValue<D>> {
        let mut part = SampledCell::ZERO;
        let mut values = [0.0; MOST_POINTS];
        let values = &mut values[..self.inner.len()];
        for (value, point) in values.iter_mut().zip(&self.inner) {
            let at = within(corners, point.barycentric);
            *value = cell.value(at)?;
            part.mean += point.weight * *value;
            part.size += point.weight * value.abs();
            add(&mut part.shares, point.weight * *value, at);
        }
        // The weights sum to 1 up to rounding only.
        if values.iter().all(|value| *value == values[0]) {
            part.mean = values[0];
            part.shares = mean_of(corners).map(|hat| hat * values[0]);
        }
        for (value, point) in values.iter().zip(&self.inner) {
            part.variance += point.weight * (value - part.mean) * (value - part.mean);
        }
        let (mut others, centroid) = ([0.0; V], self.outer.len() - 1);
        // A part of the cell has other corners.
        let shared = cell.shared.filter(|_| fraction == 1.0);
        for (number, point) in self.outer.iter().enumerate() {
            let at = within(corners, point.barycentric);
            // Both formulas have the value at the centroid.
            let value = match shared.and_then(|shared| shared.get(number).copied()) {
                _ if number == centroid => values[0],
                Some(value) if value.is_finite() => value,
                _ => cell.value(at)?,
            };
            add(&mut others, point.weight * value, at);
        }
        let apart = part.shares.iter().zip(others).map(|(p, q)| (p - q).abs());
        part.difference = fraction * apart.fold(0.0, f64::max);
        let dimension = V as f64 - 1.0;
        part.worst = part.difference;
        // The power of the whole, the most frequent part, is 1.
        if fraction < 1.0 {
            part.worst /= libm::pow(fraction, (dimension - 1.0) / dimension);
        }
        part.shares.iter_mut().for_each(|share| *share *= fraction);
        Ok(SampledPart { corners, fraction, of: part })
    }
}

/// Points at most that cells share: vertices and midpoints of edges.
pub(crate) const SHARED_POINTS: usize = 10;

/// Function on a cell.
pub(crate) struct CellValues<'a, const D: usize, const V: usize> {
    pub(crate) vertices: [[f64; D]; V],
    pub(crate) f: &'a dyn Fn([f64; D]) -> f64,
    /// Values at the vertices, behind each those at the midpoints of its edges to the vertices before, if known.
    pub(crate) shared: Option<[f64; SHARED_POINTS]>,
}

impl<const D: usize, const V: usize> CellValues<'_, D, V> {
    /// Value at the point with these barycentric coordinates.
    #[inline]
    fn value(&self, at: [f64; V]) -> Result<f64, BadValue<D>> {
        let point = QuadraturePoint { barycentric: at, weight: 1.0 }.within(self.vertices);
        let value = (self.f)(point);
        if value.is_finite() {
            return Ok(value);
        }
        // On the border of the cell rounding may have left the set on which a root or a logarithm is a number.
        let beside = at.map(|s| s + BESIDE * (1.0 / V as f64 - s));
        let inside =
            (self.f)(QuadraturePoint { barycentric: beside, weight: 1.0 }.within(self.vertices));
        match value.is_nan() && inside.is_finite() {
            true => Ok(inside),
            false => Err(BadValue { value, point }),
        }
    }

    /// Corners of the two halves of a part, cut across its longest edge.
    fn halves(&self, corners: [[f64; V]; V]) -> [[[f64; V]; V]; 2] {
        let points = corners
            .map(|at| QuadraturePoint { barycentric: at, weight: 1.0 }.within(self.vertices));
        let (mut longest, mut ends) = (-1.0, [0, 1]);
        for a in 0..V {
            for b in 0..a {
                // The largest difference of coordinates comes first, whose squares might overflow or vanish.
                let steps = points[a].iter().zip(points[b]).map(|(p, q)| (p - q).abs());
                let length = steps.clone().fold(0.0, f64::max);
                let square: f64 = steps.map(|step| (step / length) * (step / length)).sum();
                if length * square.sqrt() > longest {
                    (longest, ends) = (length * square.sqrt(), [a, b]);
                }
            }
        }
        let middle = halfway(corners[ends[0]], corners[ends[1]]);
        ends.map(|end| {
            let mut half = corners;
            half[end] = middle;
            half
        })
    }
}

impl<const V: usize> SampledPart<V> {
    /// Adds the integrals over another part.
    fn add(&mut self, other: &Self) {
        let fraction = self.fraction + other.fraction;
        let (sum, other, share) = (&mut self.of, &other.of, other.fraction / fraction);
        let step = other.mean - sum.mean;
        sum.variance +=
            share * (other.variance - sum.variance) + share * (1.0 - share) * step * step;
        sum.mean += share * step;
        sum.size += share * (other.size - sum.size);
        sum.shares.iter_mut().zip(other.shares).for_each(|(sum, share)| *sum += share);
        sum.difference += other.difference;
        sum.worst = sum.worst.max(other.worst);
        self.fraction = fraction;
    }
}

/// Points of the larger formula of degree 5.
const MOST_POINTS: usize = 15;
/// Way to the centroid of the cell on which a value is taken instead of one that is no number.
const BESIDE: f64 = 1e-9;

/// Barycentric coordinates of a vertex.
fn unit<const V: usize>(vertex: usize) -> [f64; V] {
    std::array::from_fn(|k| f64::from(u8::from(k == vertex)))
}

fn halfway<const V: usize>(p: [f64; V], q: [f64; V]) -> [f64; V] {
    std::array::from_fn(|k| 0.5 * (p[k] + q[k]))
}

fn mean_of<const V: usize>(corners: [[f64; V]; V]) -> [f64; V] {
    std::array::from_fn(|k| corners.iter().map(|corner| corner[k]).sum::<f64>() / V as f64)
}

/// Barycentric coordinates in the cell of a point of a part.
#[inline(always)]
fn within<const V: usize>(corners: [[f64; V]; V], at: [f64; V]) -> [f64; V] {
    QuadraturePoint { barycentric: at, weight: 1.0 }.within(corners)
}

#[inline(always)]
fn add<const V: usize>(sums: &mut [f64; V], mass: f64, hats: [f64; V]) {
    for (sum, hat) in sums.iter_mut().zip(hats) {
        *sum += mass * hat;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    const SETTLING: Settling = Settling { least_parts: 64, most_parts: 20_000, tolerance: 1e-6 };

    fn integrated<const D: usize, const V: usize>(
        vertices: [[f64; D]; V],
        f: &impl Fn([f64; D]) -> f64,
        settling: Settling,
    ) -> Result<SampledCell<V>, BadValue<D>> {
        Sampler::default().integrate(&CellValues { vertices, f, shared: None }, settling)
    }

    fn sampled(f: impl Fn([f64; 2]) -> f64) -> Result<SampledCell<3>, BadValue<2>> {
        integrated(TRIANGLE, &f, SETTLING)
    }

    #[test]
    fn both_formulas_have_their_degree() {
        let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let once = Settling { least_parts: 1, most_parts: 1, tolerance: 0.0 };
        for (a, b, c) in [(0, 0, 0), (1, 0, 0), (0, 1, 1), (2, 0, 0), (0, 2, 0)] {
            let power = |x: f64, n: i32| x.powi(n);
            let of = |[x, y, z]: [f64; 3]| power(x, a) * power(y, b) * power(z, c);
            let cell = integrated(tetrahedron, &of, once).unwrap();
            assert!(cell.difference < 1e-15, "{a} {b} {c}: {}", cell.difference);
            let flat = |[x, y]: [f64; 2]| power(x, a) * power(y, b);
            let cell = integrated(TRIANGLE, &flat, once).unwrap();
            assert!(cell.difference < 1e-15, "{a} {b}: {}", cell.difference);
        }
    }

    #[test]
    fn peaks_kinks_and_jumps_are_integrated() {
        let square = |[x, y]: [f64; 2], [a, b]: [f64; 2]| (x - a) * (x - a) + (y - b) * (y - b);
        // The integral of a peak that is cut off is that of the whole plane.
        let peak = sampled(|p| libm::exp(-1e4 * square(p, [0.31, 0.27]))).unwrap();
        assert!((0.5e4 * peak.mean / std::f64::consts::PI - 1.0).abs() < 1e-4, "{}", peak.mean);
        let kink = sampled(|[x, _]| (x - 0.3f64).max(0.0)).unwrap();
        let error = 0.5 * kink.mean - 0.7f64.powi(3) / 6.0;
        assert!(error.abs() < SETTLING.tolerance, "{error:e}");
        let jump = sampled(|[x, _]| f64::from(u8::from(x > 0.3))).unwrap();
        assert!((0.5 * jump.mean - 0.245).abs() < 1e-3 && jump.difference < 1e-2);
        assert!((jump.variance - jump.mean * (1.0 - jump.mean)).abs() < 1e-2);
        // Sums over the parts, each addition with its rounding error.
        let rounding = SETTLING.most_parts as f64 * f64::EPSILON;
        assert!((jump.shares.iter().sum::<f64>() - jump.mean).abs() < rounding);
    }

    #[test]
    fn smooth_functions_take_no_more_parts_and_constants_are_exact() {
        let constant = sampled(|_| -0.1).unwrap();
        assert_eq!((constant.mean, constant.size, constant.variance), (-0.1, 0.1, 0.0));
        let linear = sampled(|[x, y]| x - 2.0 * y).unwrap();
        assert!((linear.mean + 1.0 / 3.0).abs() < 1e-15 && linear.difference < 1e-15);
    }

    #[test]
    fn values_that_are_not_finite_are_refused_but_where_rounding_makes_them() {
        let bad = sampled(|[x, _]| 1.0 / (x - 0.5)).unwrap_err();
        assert_eq!((bad.value.is_infinite(), bad.point[0]), (true, 0.5));
        assert!(sampled(|[x, _]| (x - 0.4).sqrt()).is_err());
        // At a vertex, at the midpoint of an edge, of a cell in one piece or in many.
        for [a, b] in [[0.0, 0.0], [1.0, 0.0], [0.5, 0.0], [0.5, 0.5]] {
            let pole = |[x, y]: [f64; 2]| 1.0 / libm::hypot(x - a, y - b);
            for least_parts in [1, 2, 4, 64] {
                let settling = Settling { least_parts, most_parts: 0, ..SETTLING };
                let bad = integrated(TRIANGLE, &pole, settling).unwrap_err();
                assert_eq!((bad.value.is_infinite(), bad.point), (true, [a, b]));
            }
        }
        assert!(sampled(|[x, _]| (x - 1e-17).sqrt()).is_ok());
        assert!(sampled(|[x, y]| x * y / (x * y)).is_ok());
    }
}
