//! Values of f at a point on a jump: limits from the side that a [`Tie`] names.

use super::shape::{Shape, plain};
use super::source::{STEP_OFF, Tie};
use std::ops::Range;

/// Row of nodes of a grid, and the tie rule for those on a jump.
pub(crate) struct TiedRow<'a> {
    /// Coordinates x of the nodes, ascending.
    pub xs: &'a [f64],
    /// Coordinate y of the nodes.
    pub y: f64,
    /// The coordinates x, each moved off a jump along the axis.
    pub moved_xs: &'a [f64],
    /// The coordinate y, moved off a jump along the axis.
    pub moved_y: f64,
    /// Tie rule.
    pub tie: Tie,
}

impl TiedRow<'_> {
    /// Writes `value` at the nodes that belong to a shape.
    ///
    /// A node on the border of a half-plane or disc is inside if the tie rule steps into the shape; where the step is
    /// along the border, its horizontal part decides, so that all nodes on a line are on one side of it.
    pub(crate) fn paint(&self, shape: &Shape<2>, value: f64, row: &mut [f64]) {
        match *shape {
            // Its sides are along the axes, and a step along each axis is off them.
            Shape::Box(_) => row[self.held(shape)].fill(value),
            Shape::HalfSpace { normal, d } => {
                let (normal, d) = plain(normal, d);
                for (x, at) in self.xs.iter().zip(row) {
                    let above = normal[0] * x + normal[1] * self.y - d;
                    if self.is_below([*x, self.y], above, normal) {
                        *at = value;
                    }
                }
            }
            Shape::Ball { centre: [cx, cy], radius } => {
                for (x, at) in self.xs.iter().zip(row) {
                    let [dx, dy] = [x - cx, self.y - cy];
                    // The distance from the circle over the radius, but for terms of second order.
                    let above = 0.5 * (dx * dx + dy * dy - radius * radius);
                    if self.is_below([*x, self.y], above, [dx, dy]) {
                        *at = value;
                    }
                }
            }
        }
    }

    fn held(&self, rectangle: &Shape<2>) -> Range<usize> {
        rectangle.along(self.moved_xs, [0.0, self.moved_y])
    }

    /// True if a function with this value and gradient at a node is negative, or zero and negative on the side of the
    /// tie rule; on the other side if the square has no points on that one.
    fn is_below(&self, node: [f64; 2], value: f64, gradient: [f64; 2]) -> bool {
        let size = gradient[0].abs() + gradient[1].abs();
        if value.abs() > STEP_OFF * size {
            return value < 0.0;
        }
        let signs = self.tie.signs();
        let steps = [0, 1].map(|axis| gradient[axis] * signs[axis]);
        let both = steps[0] + steps[1];
        let change = if both.abs() > ALONG * size { both } else { steps[0] };
        let is_inside = (0..2).any(|axis| {
            // From a node on a side of the square no step leads out.
            let directions = [-1.0, 1.0].into_iter().filter(|step| node[axis] * step < 0.5);
            directions.into_iter().any(|step| gradient[axis] * step * change > 0.0)
        });
        is_inside == (change < 0.0)
    }
}

/// Sum of the parts of a step, over the sum of their sizes, below which the step is along a border but for rounding.
const ALONG: f64 = 1e-9;
