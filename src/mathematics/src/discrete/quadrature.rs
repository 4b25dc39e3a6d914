//! Quadrature on triangles and tetrahedra, exact for polynomials of degree 5, and on facets.
//!
//! A. H. Stroud, Approximate Calculation of Multiple Integrals, 1971: formulas T2: 5-1 (Radon) and T3: 5-1.

/// Point of a formula.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuadraturePoint<const V: usize> {
    /// Barycentric coordinates.
    pub(crate) barycentric: [f64; V],
    /// Weight; those of all points sum to 1.
    pub(crate) weight: f64,
}

impl<const V: usize> QuadraturePoint<V> {
    /// Point of the cell with these vertices.
    #[inline(always)]
    pub(crate) fn within<const D: usize>(&self, vertices: [[f64; D]; V]) -> [f64; D] {
        std::array::from_fn(|d| {
            let mut sum = self.barycentric[0] * vertices[0][d];
            for (share, vertex) in self.barycentric[1..].iter().zip(&vertices[1..]) {
                sum += share * vertex[d];
            }
            sum
        })
    }
}

/// Returns the points of the formula on a triangle, V = 3, or tetrahedron, V = 4.
pub(crate) fn quadrature<const V: usize>() -> Vec<QuadraturePoint<V>> {
    let root = 15f64.sqrt();
    let mut points = Vec::new();
    if V == 3 {
        add(&mut points, 9.0 / 40.0, [1.0 / 3.0; 2], 0);
        for sign in [-1.0, 1.0] {
            let near = (6.0 + sign * root) / 21.0;
            add(&mut points, (155.0 + sign * root) / 1200.0, [near, 1.0 - 2.0 * near], 1);
        }
    } else {
        add(&mut points, 16.0 / 135.0, [0.25; 2], 0);
        for sign in [-1.0, 1.0] {
            let near = (7.0 + sign * root) / 34.0;
            let weight = (2665.0 - sign * 14.0 * root) / 37800.0;
            add(&mut points, weight, [near, 1.0 - 3.0 * near], 1);
        }
        let near = (10.0 - 2.0 * root) / 40.0;
        add(&mut points, 10.0 / 189.0, [near, 0.5 - near], 2);
    }
    points
}

/// Points of Gauss on an edge, five of them, exact for polynomials of degree nine: places and weights.
const GAUSS: [[f64; 2]; 5] = [
    [0.046_910_077_030_668, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_23],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_5, 0.239_314_335_249_683_23],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];
/// Pieces of an edge with points of their own: where a value is a root, its derivative is large beside an end.
const PIECES: u32 = 4;

/// Returns the points on a facet of a cell in D dimensions.
pub(crate) fn facet_points<const D: usize>() -> Vec<QuadraturePoint<D>> {
    if D != 2 {
        return quadrature();
    }
    let mut points = Vec::new();
    for piece in 0..PIECES {
        for [place, weight] in GAUSS {
            let place = (f64::from(piece) + place) / f64::from(PIECES);
            let barycentric = std::array::from_fn(|k| if k == 0 { 1.0 - place } else { place });
            points.push(QuadraturePoint { barycentric, weight: weight / f64::from(PIECES) });
        }
    }
    points
}

/// Adds the points with the second coordinate at `count` vertices, all choices of them, and the first at the others.
fn add<const V: usize>(
    points: &mut Vec<QuadraturePoint<V>>,
    weight: f64,
    [most, few]: [f64; 2],
    count: usize,
) {
    for choice in 0..1u32 << V {
        if choice.count_ones() as usize == count {
            let coordinate = |vertex: usize| if choice >> vertex & 1 == 1 { few } else { most };
            points.push(QuadraturePoint { barycentric: std::array::from_fn(coordinate), weight });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral over the simplex, over its volume, of the product of powers of the barycentric coordinates.
    fn exact<const V: usize>(powers: [u32; V]) -> f64 {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        let d = V as u32 - 1;
        let above: f64 = powers.iter().map(|&p| factorial(p)).product();
        factorial(d) * above / factorial(powers.iter().sum::<u32>() + d)
    }

    fn error<const V: usize>(powers: [u32; V]) -> f64 {
        let terms = quadrature::<V>().into_iter().map(|point| {
            let factors = point.barycentric.iter().zip(powers);
            point.weight * factors.map(|(x, p)| x.powi(p as i32)).product::<f64>()
        });
        (terms.sum::<f64>() - exact(powers)).abs()
    }

    #[test]
    fn polynomials_of_degree_five_are_integrated_exactly() {
        for (a, b) in (0..6).flat_map(|a| (0..6 - a).map(move |b| (a, b))) {
            assert!(error([a, b, 5 - a - b]) < 1e-15, "{a} {b}");
            for c in 0..6 - a - b {
                assert!(error([a, b, c, 5 - a - b - c]) < 1e-15, "{a} {b} {c}");
            }
        }
        assert!(error([6, 0, 0]) > 1e-6 && error([6, 0, 0, 0]) > 1e-6);
    }
}
