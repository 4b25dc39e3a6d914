//! Tetrahedra around a node, several side by side: what the flux of the patch must carry, and the circulations around
//! the edges at the node.
//!
//! The three other vertices are a, b and c. The circulation around the edge to a leaves through the side opposite to b
//! and enters through the side opposite to c: it is the constant field `(c - b) / (3 volume)`, with the other sign where
//! the node, a, b and c are in the negative sense; and so on around the cycle of a, b and c.

use crate::mesh::difference;

/// Number of tetrahedra side by side.
pub(super) const LANES: usize = 8;

/// Number of each tetrahedron.
type Lanes = [f64; LANES];

/// Tetrahedra around a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    /// Coordinates of a, b and c less those of the node.
    edges: [[Lanes; 3]; 3],
    /// w at a, b and c less w at the node.
    rises: [Lanes; 3],
    /// Volume, negative where the node, a, b and c are in the negative sense.
    signed: Lanes,
    /// Volume.
    pub volume: Lanes,
    /// Integrals of `grad w . grad phi` for the hat functions phi of a, b and c.
    pub work: [Lanes; 3],
    /// Integral of `|grad phi|^2` for the hat function phi of the node.
    pub stiffness: Lanes,
    /// Products, times 9, of the circulations around the edges to b and c, to c and a, and to a and b.
    pub products: [Lanes; 3],
    /// Products, times 9, of the circulations around the edges to a, b and c with the mean of a field.
    pub loads: [Lanes; 3],
}

impl Block {
    /// Puts the vertex of a tetrahedron that follows the node by k + 1: its place, and w there, less those of the node.
    pub(super) fn put(&mut self, lane: usize, k: usize, edge: &[f64], rise: f64) {
        self.edges[k].iter_mut().zip(edge).for_each(|(lanes, x)| lanes[lane] = *x);
        self.rises[k][lane] = rise;
    }

    /// Finds the volumes and the integrals of gradients.
    #[inline(always)]
    pub(super) fn measure(&mut self) {
        for lane in 0..LANES {
            let [a, b, c] = self.edges(lane);
            // Gradients of the hat functions times the determinant.
            let normals = [cross(b, c), cross(c, a), cross(a, b)];
            let determinant = dot(a, normals[0]);
            let inverse = 1.0 / determinant.abs();
            let of_node = combined([1.0; 3], normals);
            let [p, q, r] = at(&self.rises, lane);
            let sixth = inverse / 6.0;
            let slope = combined([sixth * p, sixth * q, sixth * r], normals);
            for (work, normal) in self.work.iter_mut().zip(normals) {
                work[lane] = dot(slope, normal);
            }
            self.signed[lane] = determinant / 6.0;
            self.volume[lane] = determinant.abs() / 6.0;
            self.stiffness[lane] = inverse * dot(of_node, of_node) / 6.0;
        }
    }

    /// Finds the products of circulations with each other and with the field that has these outflows through the sides
    /// opposite to a, b and c, less the node's share of `grad w`.
    #[inline(always)]
    pub(super) fn multiply(&mut self, outflows: &[Lanes; 3]) {
        for lane in 0..LANES {
            let [a, b, c] = self.edges(lane);
            let [of_a, of_b, of_c] = at(outflows, lane);
            let [to_a, to_b, to_c] = at(&self.work, lane);
            let (p, q, r) = (of_a + to_a, of_b + to_b, of_c + to_c);
            let quarter = 0.25 * (p + q + r);
            let mean = combined([quarter - p, quarter - q, quarter - r], [a, b, c]);
            let along = [difference(c, b), difference(a, c), difference(b, a)];
            let (inverse, signed) = (1.0 / self.volume[lane], 1.0 / self.signed[lane]);
            self.products[0][lane] = inverse * dot(along[1], along[2]);
            self.products[1][lane] = inverse * dot(along[2], along[0]);
            self.products[2][lane] = inverse * dot(along[0], along[1]);
            for (load, along) in self.loads.iter_mut().zip(along) {
                load[lane] = signed * dot(along, mean);
            }
        }
    }

    /// Edges from the node to a, b and c.
    #[inline(always)]
    fn edges(&self, lane: usize) -> [[f64; 3]; 3] {
        let [a, b, c] = &self.edges;
        [at(a, lane), at(b, lane), at(c, lane)]
    }

    /// Sense of the circulations of a tetrahedron: 1 or -1.
    pub(super) fn sense(&self, lane: usize) -> f64 {
        1.0f64.copysign(self.signed[lane])
    }
}

/// Three numbers of a tetrahedron.
#[inline(always)]
fn at(lanes: &[Lanes; 3], lane: usize) -> [f64; 3] {
    [lanes[0][lane], lanes[1][lane], lanes[2][lane]]
}

/// Sum of three vectors times these factors.
#[inline(always)]
fn combined([p, q, r]: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    [p * a[0] + q * b[0] + r * c[0], p * a[1] + q * b[1] + r * c[1], p * a[2] + q * b[2] + r * c[2]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
