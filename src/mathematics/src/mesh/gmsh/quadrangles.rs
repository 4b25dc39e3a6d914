//! Quadrangles in the plane, which are cut into triangles.

use super::elements::FileElement;
use super::error::GmshError;
use super::nodes::FileNodes;
use std::cmp::Ordering;

/// Difference of two diagonals, over the longer one, that is a rounding error.
const SAME_LENGTH: f64 = 1e-9;
/// Area of a triangle over the square of its longest side, up to which it is flat.
const FLAT: f64 = 1e-9;

/// Returns the triangles into which the shorter diagonal cuts a quadrangle in the plane, or the one that lies inside;
/// of two as long, the one through the first corner.
///
/// # Errors
/// [`GmshError::Crosswise`].
pub(super) fn halves(
    nodes: &FileNodes,
    quadrangle: &FileElement<4>,
) -> Result<[FileElement<3>; 2], GmshError> {
    let &FileElement { tag, nodes: corners, groups } = quadrangle;
    let places = corners.map(|node| nodes.points[node as usize]);
    let [a, b, c, d] = places;
    let [abc, acd, abd, bcd] = [[a, b, c], [a, c, d], [a, b, d], [b, c, d]].map(sense);
    let [first_inside, second_inside] =
        [[abc, acd], [abd, bcd]].map(|[one, two]| one == two && one != Ordering::Equal);
    // Of a flat quadrangle something else is said later.
    if !first_inside && !second_inside && abc != Ordering::Equal && acd == abc.reverse() {
        return Err(GmshError::Crosswise(tag));
    }
    let second_shorter = distance(b, d) < (1.0 - SAME_LENGTH) * distance(a, c);
    let [a, b, c, d] = corners;
    let halves = match second_inside && (second_shorter || !first_inside) {
        true => [[a, b, d], [b, c, d]],
        false => [[a, b, c], [a, c, d]],
    };
    Ok(halves.map(|nodes| FileElement { tag, nodes, groups }))
}

fn distance([px, py, _]: [f64; 3], [qx, qy, _]: [f64; 3]) -> f64 {
    libm::hypot(qx - px, qy - py)
}

/// Sense in which three points are passed; equal for points in a line.
fn sense([a, b, c]: [[f64; 3]; 3]) -> Ordering {
    let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
    let [[px, py], [qx, qy]] = [b, c].map(|to| [0, 1].map(|d| (to[d] - a[d]) / longest));
    let area = 0.5 * (px * qy - py * qx);
    // Written so that NaN is flat.
    if area.abs() > FLAT { area.total_cmp(&0.0) } else { Ordering::Equal }
}
