//! Tetrahedra around a node: what the flux of the patch must carry, and the circulations around the edges at the node.
//!
//! The three other vertices are a, b and c. The circulation around the edge to a leaves through the side opposite to b
//! and enters through the side opposite to c: it is the constant field `(c - b) / (3 volume)`, with the other sign
//! where the node, a, b and c are in the negative sense; and so on around the cycle of a, b and c.

use crate::mesh::{difference, dot};

/// Tetrahedron around a node, with a linear function w.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tetrahedron {
    /// Edges from the node to a, b and c.
    pub edges: [[f64; 3]; 3],
    /// Volume, negative where the node, a, b and c are in the negative sense.
    pub signed: f64,
    /// Integrals of `grad w . grad phi` for the hat functions phi of a, b and c.
    pub work: [f64; 3],
    /// Integral of `|grad phi|^2` for the hat function phi of the node.
    pub stiffness: f64,
}

impl Tetrahedron {
    /// Tetrahedron with these edges from the node to a, b and c, along which w rises by so much.
    #[inline(always)]
    pub(super) fn new(edges: [[f64; 3]; 3], [p, q, r]: [f64; 3]) -> Self {
        let [a, b, c] = edges;
        // Gradients of the hat functions times the determinant.
        let [of_a, of_b, of_c] = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = dot(a, of_a);
        let part = 1.0 / (6.0 * determinant.abs());
        let of_node = combined([1.0; 3], [of_a, of_b, of_c]);
        let slope = combined([part * p, part * q, part * r], [of_a, of_b, of_c]);
        let work = [dot(slope, of_a), dot(slope, of_b), dot(slope, of_c)];
        let stiffness = part * dot(of_node, of_node);
        Self { edges, signed: determinant / 6.0, work, stiffness }
    }

    /// Volume.
    #[inline(always)]
    pub(super) fn volume(&self) -> f64 {
        self.signed.abs()
    }

    /// Edges opposite to the node: the circulations around the edges to a, b and c times `3 signed`.
    #[inline(always)]
    fn around(&self) -> [[f64; 3]; 3] {
        let [a, b, c] = self.edges;
        [difference(c, b), difference(a, c), difference(b, a)]
    }

    /// Products, times 9, of the circulations around the edges to b and c, to c and a, and to a and b.
    #[inline(always)]
    pub(super) fn products(&self) -> [f64; 3] {
        let ([a, b, c], size) = (self.around(), 1.0 / self.volume());
        [size * dot(b, c), size * dot(c, a), size * dot(a, b)]
    }

    /// Products, times 9, of the circulations around the edges to a, b and c with the field that has these outflows
    /// through the sides opposite to a, b and c, less the node's share of `grad w`.
    #[inline(always)]
    pub(super) fn loads(&self, [of_a, of_b, of_c]: [f64; 3]) -> [f64; 3] {
        let (p, q, r) = (of_a + self.work[0], of_b + self.work[1], of_c + self.work[2]);
        let (inverse, quarter) = (1.0 / self.signed, 0.25 * (p + q + r));
        let mean = combined([quarter - p, quarter - q, quarter - r], self.edges);
        let [a, b, c] = self.around();
        [inverse * dot(a, mean), inverse * dot(b, mean), inverse * dot(c, mean)]
    }
}

/// Sum of three vectors times these factors.
#[inline(always)]
fn combined([p, q, r]: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (d, sum) in sum.iter_mut().enumerate() {
        *sum = p * a[d] + q * b[d] + r * c[d];
    }
    sum
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
