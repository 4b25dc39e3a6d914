//! Triangles that borders of discs, rectangles and half-planes cross.
//!
//! A triangle is one more convex set: the function less its background, painted over with zero on the three half-planes
//! outside, has the integrals over the triangle as those over the unit cell, which the sweep of the square takes.

use super::cut::{CutMoments, CutShape, FramedCell};
use crate::discrete::cells::SweepCut;
use crate::problem::shape::Shape;

impl CutShape<2, 3> for Shape<2> {
    type Storage = SweepCut;

    fn integrate(
        storage: &mut SweepCut,
        cell: &FramedCell<2, 3>,
        background: f64,
        pieces: &[(Self, f64)],
    ) -> CutMoments<2> {
        let [f, size] = [false, true].map(|of_size| {
            let less = |value: f64| {
                if of_size { value.abs() - background.abs() } else { value - background }
            };
            let above = pieces.iter().map(|&(shape, value)| (shape, less(value)));
            storage.set(0.0, cell.outside().into_iter().map(|shape| (shape, 0.0)).chain(above));
            storage.moments()
        });
        let [one, x, y, ..] = f.f;
        CutMoments { one, first: [x, y], square: f.square, size: size.f[0] }
    }
}
