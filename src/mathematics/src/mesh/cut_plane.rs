//! Triangles that borders of discs, rectangles and half-planes cross.
//!
//! A triangle is one more convex set: the function less its background, painted over with zero on the three half-planes
//! outside, has the integrals over the triangle as those over the unit cell, which the sweep of the square takes.

use super::cut::{CutMoments, CutShape, FramedCell};
use crate::discrete::cells::SweepCut;
use crate::problem::region::Region;
use crate::problem::shape::{Convex, plain};

impl CutShape<2, 3> for Region {
    type Storage = SweepCut;

    fn moved(&self, [x, y]: [f64; 2], unit: f64) -> Self {
        self.seen_from(x, [y], unit)
    }

    fn misses(&self, cell: &FramedCell<2, 3>) -> bool {
        match *self {
            Self::Rect { x, y } => cell.is_beside([x, y]),
            Self::HalfPlane { a, b, c } => {
                let (normal, c) = plain([a, b], c);
                cell.is_beyond(normal, c)
            }
            Self::Disc { centre, radius } => cell.is_away_from(centre, radius),
        }
    }

    fn integrate(
        storage: &mut SweepCut,
        cell: &FramedCell<2, 3>,
        background: f64,
        pieces: &[(Self, f64)],
    ) -> CutMoments<2> {
        let outside = outside(cell);
        let [f, size] = [false, true].map(|of_size| {
            let less = |value: f64| {
                if of_size { value.abs() - background.abs() } else { value - background }
            };
            let above = pieces.iter().map(|&(shape, value)| (shape, less(value)));
            storage.set(0.0, outside.into_iter().map(|shape| (shape, 0.0)).chain(above));
            storage.moments()
        });
        let [one, x, y, ..] = f.f;
        CutMoments { one, first: [x, y], square: f.square, size: size.f[0] }
    }
}

/// The half-planes that the sides of a triangle separate from it, in its frame.
fn outside(cell: &FramedCell<2, 3>) -> [Region; 3] {
    std::array::from_fn(|vertex| {
        // The hat function of the vertex is negative there.
        let [a, b] = cell.element.gradients[vertex];
        let [x, y] = cell.framed[(vertex + 1) % 3];
        Region::HalfPlane { a, b, c: a * x + b * y }
    })
}
