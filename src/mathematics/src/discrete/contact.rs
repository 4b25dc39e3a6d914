//! Contact as a result: arcs of the boundary that carry reactions.

/// A part of the boundary in contact, anticlockwise.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ContactArc {
    /// First point.
    pub from: [f64; 2],
    /// Last point; the same point as `from` if the arc is closed.
    pub to: [f64; 2],
    /// Distances along the boundary within which the ends of a true solution lie from `from` and `to`, as estimated.
    pub error: Option<[f64; 2]>,
    /// True if the arc is all of a closed curve of the boundary.
    pub closed: bool,
    /// Names of the parts of the boundary on which the arc lies; none on the square, whose boundary has no parts.
    pub part: Option<String>,
    /// The reactions on it together, the integral of dv/dn.
    pub force: f64,
    /// Length along the boundary.
    #[serde(skip)]
    pub length: f64,
}

impl ContactArc {
    /// Arc of this length on a boundary without parts, closed if its ends are one point.
    pub fn new([from, to]: [[f64; 2]; 2], force: f64, length: f64) -> Self {
        Self { from, to, error: None, closed: from == to, part: None, force, length }
    }

    /// Arc on the boundary of the square.
    pub fn on_square(ends: [[f64; 2]; 2], force: f64) -> Self {
        const SIDES: f64 = 4.0;
        let [from, to] = ends.map(along_square);
        let length = if ends[0] == ends[1] { SIDES } else { (to - from).rem_euclid(SIDES) };
        Self::new(ends, force, length)
    }
}

/// Way along the boundary of the square from its lower left corner, anticlockwise.
fn along_square([x, y]: [f64; 2]) -> f64 {
    match () {
        () if y <= -0.5 => x + 0.5,
        () if x >= 0.5 => y + 1.5,
        () if y >= 0.5 => 2.5 - x,
        () => 3.5 - y,
    }
}

/// Distance by which contact reaches beyond its last node, in cells, from the next two values: they grow like the
/// distance to the power 3/2, so that their powers 2/3 lie on a line. Half a cell if they do not grow.
pub fn reach(values: [f64; 2]) -> f64 {
    let [near, far] = values.map(|v| libm::cbrt(v * v));
    if far > near { 1.0 - near / (far - near) } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_measured_anticlockwise() {
        let length = |from, to| ContactArc::on_square([from, to], 0.0).length;
        assert_eq!(length([-0.25, -0.5], [0.25, -0.5]), 0.5);
        assert_eq!(length([0.25, -0.5], [-0.25, -0.5]), 3.5);
        assert_eq!(length([-0.5, -0.25], [-0.25, -0.5]), 0.5);
        assert_eq!(length([0.5, 0.25], [0.25, 0.5]), 0.5);
        assert_eq!(length([0.5, 0.5], [0.5, 0.5]), 4.0);
    }
}
