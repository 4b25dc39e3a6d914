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
}

/// Distance by which contact reaches beyond its last node, in cells, from the next two values: they grow like the
/// distance to the power 3/2, so that their powers 2/3 lie on a line. Half a cell if they do not grow.
pub fn reach(values: [f64; 2]) -> f64 {
    let [near, far] = values.map(|v| libm::cbrt(v * v));
    if far > near { 1.0 - near / (far - near) } else { 0.5 }
}
