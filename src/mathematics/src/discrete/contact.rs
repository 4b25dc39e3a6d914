//! Contact as a result: the arcs of the boundary that carry reactions, their forces, and where they end between nodes.

use super::grid::Grid;
use super::kkt::Judgement;

/// A part of the boundary in contact, anticlockwise.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ContactArc {
    /// First point.
    pub from: [f64; 2],
    /// Last point; the same point as `from` if the arc is closed.
    pub to: [f64; 2],
    /// True if the arc is all of a closed curve of the boundary.
    pub closed: bool,
    /// Names of the parts of the boundary on which the arc lies; none on the square, whose boundary has no parts.
    pub part: Option<String>,
    /// The reactions on it together, the integral of dv/dn.
    pub force: f64,
}

impl ContactArc {
    /// Arc on a boundary without parts, closed if its ends are one point.
    pub fn new([from, to]: [[f64; 2]; 2], force: f64) -> Self {
        Self { from, to, closed: from == to, part: None, force }
    }
}

/// The arcs of boundary nodes [in contact](Judgement::in_contact), for the nodal vector `y` and its judgement.
pub fn arcs(grid: Grid, y: &[f64], judgement: &Judgement) -> Vec<ContactArc> {
    let (in_contact, flux) = (judgement.in_contact(), &judgement.flux);
    let y: Vec<f64> = grid.boundary().map(|node| y[node]).collect();
    let nodes = flux.len();
    let carries = |b: usize| in_contact[b % nodes];
    if (0..nodes).all(carries) {
        let corner = point(grid, 0.0);
        return vec![ContactArc::new([corner; 2], flux.iter().sum())];
    }
    let arc = |start: usize| {
        let end = (start..start + nodes).find(|&b| !carries(b)).expect("not all carry");
        let before = [nodes - 1, nodes - 2].map(|k| y[(start + k) % nodes]);
        let after = [0, 1].map(|k| y[(end + k) % nodes]);
        let mut beyond = [before, after].map(|values| reach(values).clamp(0.0, 1.0));
        if end - start == 1 && beyond == [0.0; 2] {
            // No ends can be told around this one node, and an arc without length would stand for all of the boundary.
            beyond = [0.5; 2];
        }
        let places = [start as f64 - beyond[0], (end - 1) as f64 + beyond[1]];
        let force = (start..end).map(|b| flux[b % nodes]).sum();
        ContactArc::new(places.map(|place| point(grid, place)), force)
    };
    (1..=nodes).filter(|&b| carries(b) && !carries(b - 1)).map(arc).collect()
}

/// The point of the boundary at the distance `p h` from the lower left corner, anticlockwise.
fn point(grid: Grid, p: f64) -> [f64; 2] {
    let n = grid.cells() as f64;
    let p = p.rem_euclid(4.0 * n) / n;
    let along = p.fract() - 0.5;
    match p as usize {
        0 => [along, -0.5],
        1 => [0.5, along],
        2 => [-along, 0.5],
        _ => [-0.5, -along],
    }
}

/// Distance by which contact reaches beyond its last node, in cells, from the next two values: they grow like the
/// distance to the power 3/2, so that their powers 2/3 lie on a line. Half a cell if they do not grow.
pub fn reach(values: [f64; 2]) -> f64 {
    let [near, far] = values.map(|v| libm::cbrt(v * v));
    if far > near { 1.0 - near / (far - near) } else { 0.5 }
}
