//! Triangles and tetrahedra: volumes, gradients of the hat functions, measures of facets.

pub(crate) use crate::problem::shape::dot;

/// Triangle or tetrahedron, as far as linear functions on it are concerned.
#[derive(Clone, Copy, Debug)]
pub struct Element<const D: usize, const V: usize> {
    /// Area or volume, positive.
    pub volume: f64,
    /// True if the vertices are numbered in the negative sense.
    pub is_mirrored: bool,
    /// Gradients of the barycentric coordinates, which are the hat functions of the vertices.
    pub gradients: [[f64; D]; V],
}

impl<const D: usize, const V: usize> Element<D, V> {
    /// Element with these vertices. Where they lie in a line or plane the volume is zero, and no gradient is finite.
    pub fn new(vertices: [[f64; D]; V]) -> Self {
        let (determinant, cofactors) = cofactors(edges(vertices));
        let mut gradients = [[0.0; D]; V];
        for k in 0..D {
            for d in 0..D {
                let slope = cofactors[k][d] / determinant;
                gradients[k + 1][d] = slope;
                gradients[0][d] -= slope;
            }
        }
        let volume = volume_of::<D>(determinant);
        Self { volume, is_mirrored: determinant < 0.0, gradients }
    }

    /// Integral over the element of the product of the gradients of two hat functions.
    pub fn stiffness(&self, i: usize, j: usize) -> f64 {
        self.volume * dot(self.gradients[i], self.gradients[j])
    }

    /// Gradient of the linear function with these values at the vertices.
    pub fn gradient(&self, values: [f64; V]) -> [f64; D] {
        let mut gradient = [0.0; D];
        for (slopes, value) in self.gradients.iter().zip(values) {
            gradient.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += value * slope);
        }
        gradient
    }
}

/// Area or volume of the triangle or tetrahedron with these vertices, as in [`Element`].
pub fn volume<const D: usize, const V: usize>(vertices: [[f64; D]; V]) -> f64 {
    volume_of::<D>(cofactors(edges(vertices)).0)
}

/// Volume of an element from the determinant of the map from the reference element.
fn volume_of<const D: usize>(determinant: f64) -> f64 {
    let factorial = if D == 3 { 6.0 } else { 2.0 };
    determinant.abs() / factorial
}

/// Rows of the matrix of the map from the reference element.
#[inline(always)]
fn edges<const D: usize, const V: usize>(vertices: [[f64; D]; V]) -> [[f64; D]; D] {
    let mut edges = [[0.0; D]; D];
    for (edge, vertex) in edges.iter_mut().zip(&vertices[1..]) {
        *edge = difference(*vertex, vertices[0]);
    }
    edges
}

/// Returns the determinant of a matrix of two or three rows, and the cofactors of its entries.
#[inline(always)]
fn cofactors<const D: usize>(rows: [[f64; D]; D]) -> (f64, [[f64; D]; D]) {
    let mut cofactors = [[0.0; D]; D];
    for k in 0..D {
        for d in 0..D {
            cofactors[k][d] = match D {
                2 => {
                    let sign = if k == d { 1.0 } else { -1.0 };
                    sign * rows[1 - k][1 - d]
                }
                _ => {
                    let ([k1, k2], [d1, d2]) =
                        ([(k + 1) % 3, (k + 2) % 3], [(d + 1) % 3, (d + 2) % 3]);
                    rows[k1][d1] * rows[k2][d2] - rows[k1][d2] * rows[k2][d1]
                }
            };
        }
    }
    (dot(rows[0], cofactors[0]), cofactors)
}

/// Difference of two points.
#[inline(always)]
pub(crate) fn difference<const D: usize>(mut a: [f64; D], b: [f64; D]) -> [f64; D] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
    a
}

/// Mean of some points.
pub fn centroid<const D: usize, const V: usize>(vertices: [[f64; D]; V]) -> [f64; D] {
    std::array::from_fn(|d| vertices.iter().map(|vertex| vertex[d]).sum::<f64>() / V as f64)
}

/// Least and greatest coordinates of some points along each axis; the greatest is below the least if there is no point.
pub(super) fn bounds<const D: usize>(points: &[[f64; D]]) -> [[f64; 2]; D] {
    std::array::from_fn(|d| {
        points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], point| {
            // Shorter than the functions for this, which look for NaN.
            [
                if point[d] < least { point[d] } else { least },
                if point[d] > greatest { point[d] } else { greatest },
            ]
        })
    })
}

/// Length of the longest side of a box.
pub(super) fn longest_side<const D: usize>(bounds: [[f64; 2]; D]) -> f64 {
    bounds.iter().fold(0.0, |longest, [least, greatest]| (greatest - least).max(longest))
}

/// Length of the longest edge between some points.
pub fn size<const D: usize, const V: usize>(vertices: [[f64; D]; V]) -> f64 {
    let mut longest = 0.0f64;
    for i in 0..V {
        for j in 0..i {
            let edge: [f64; D] = std::array::from_fn(|d| vertices[i][d] - vertices[j][d]);
            longest = longest.max(dot(edge, edge));
        }
    }
    longest.sqrt()
}

/// Length of an edge in the plane, or area of a triangle in space.
pub(crate) fn measure<const D: usize>(corners: [[f64; D]; D]) -> f64 {
    let edge = |k: usize| -> [f64; D] { std::array::from_fn(|d| corners[k][d] - corners[0][d]) };
    match D {
        2 => dot(edge(1), edge(1)).sqrt(),
        _ => {
            // The Gram determinant of two edges is the square of twice the area.
            let (one, two) = (edge(1), edge(2));
            let [a, b, c] = [dot(one, one), dot(one, two), dot(two, two)];
            0.5 * (a * c - b * b).max(0.0).sqrt()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_those_of_the_barycentric_coordinates() {
        let vertices = [[0.0, 0.0, 1.0], [2.0, 0.5, 1.0], [0.3, 3.0, 0.0], [0.1, 0.2, 4.0]];
        let element = Element::new(vertices);
        // 2 x - 3 y + 5 z is linear.
        let values = vertices.map(|[x, y, z]| 2.0 * x - 3.0 * y + 5.0 * z);
        let gradient = element.gradient(values);
        assert!(gradient.iter().zip([2.0, -3.0, 5.0]).all(|(g, s)| (g - s).abs() < 1e-13));
        let triangle = Element::new([[0.0, 0.0], [0.0, 2.0], [3.0, 0.0]]);
        assert_eq!((triangle.volume, triangle.is_mirrored), (3.0, true));
        assert_eq!(measure([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), 2.0);
        assert_eq!(measure([[0.0, 0.0], [3.0, 4.0]]), 5.0);
    }
}
