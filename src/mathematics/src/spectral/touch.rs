//! Borders of f on the square that nearly touch: a reason for which no solution may be found.

use super::curve::SIDES;
use super::jumps::Jumps;
use std::fmt;

/// Two borders that nearly touch, by the shapes that they bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch(pub [String; 2]);

impl fmt::Display for Touch {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "; the borders of {} and {} nearly touch", self.0[0], self.0[1])
    }
}

impl Jumps {
    /// The two borders that come nearest to touching or coinciding without doing so, if any nearly do.
    pub(super) fn nearly_touching(&self) -> Option<Touch> {
        /// Angle, or distance, below which borders nearly touch.
        const NEARLY: f64 = 0.03;
        let many = self.curves.len();
        let curves = [&self.curves[..], &SIDES[..]].concat();
        let (mut nearest, mut touch) = (NEARLY, None);
        for k in 0..many {
            for j in k + 1..curves.len() {
                let apart = curves[k].apartness(curves[j]);
                if apart < nearest && !curves[k].touches(curves[j]) {
                    nearest = apart;
                    touch = Some(Touch([k, j].map(|k| self.border_name(k))));
                }
            }
        }
        touch
    }

    /// Name of a shape by the number of a curve that bounds it; curves after the last are the sides.
    fn border_name(&self, curve: usize) -> String {
        match self.shapes.get(curve) {
            Some(shape) => shape.to_string(),
            None => {
                let side = ["left", "right", "lower", "upper"][curve - self.curves.len()];
                format!("the {side} side")
            }
        }
    }
}
