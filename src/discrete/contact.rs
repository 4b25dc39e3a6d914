//! Contact as a result: an arc of the boundary that carries reactions, and where it ends between nodes.

/// A part of the boundary in contact, anticlockwise.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ContactArc {
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends; the same point as `from` if all of the boundary is in contact.
    pub to: [f64; 2],
    /// The reactions on it together, the integral of dv/dn.
    pub force: f64,
}

/// How far contact reaches beyond its last node, in cells, from the next two values: they grow like the
/// distance to the power 3/2, so that their powers 2/3 lie on a line. Half a cell if they do not grow.
pub fn reach(values: [f64; 2]) -> f64 {
    let [near, far] = values.map(|v| libm::cbrt(v * v));
    if far > near { 1.0 - near / (far - near) } else { 0.5 }
}
