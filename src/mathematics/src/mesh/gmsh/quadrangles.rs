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

#[cfg(test)]
mod tests {
    use crate::mesh::MeshOrigin;
    use crate::mesh::gmsh::read;
    use crate::mesh::gmsh::tests::{SQUARE_22, plane};

    /// Square of one quadrangle, whose last two corners are here.
    fn quadrangle(corners: [&str; 2]) -> String {
        let cells = "23 2 2 2 1 11 12 13\n24 2 2 2 1 11 13 14";
        let nodes = ["13 1 1 0", "14 0 1 0"];
        let text = SQUARE_22.replace("$Elements\n4", "$Elements\n3");
        let text = text.replace(cells, "23 3 2 2 1 11 12 13 14");
        nodes.iter().zip(corners).fold(text, |text, (node, corner)| text.replace(node, corner))
    }

    #[test]
    fn quadrangles_are_cut_by_the_shorter_diagonal_inside() {
        let square = plane(SQUARE_22.as_bytes());
        for (corners, cells) in [
            // As long: through the first corner.
            (["13 1 1 0", "14 0 1 0"], [[0, 1, 2], [0, 2, 3]]),
            (["13 3 3 0", "14 0 1 0"], [[0, 1, 3], [1, 2, 3]]),
            // The diagonal between the second corner and the fourth is shorter, and outside.
            (["13 0.9 0.3 0", "14 1 0.6 0"], [[0, 1, 2], [0, 2, 3]]),
        ] {
            let mut mesh = plane(quadrangle(corners).as_bytes());
            assert_eq!((mesh.cells(), mesh.origin.quadrangles), (&cells[..], 1), "{corners:?}");
            let notes = mesh.notes();
            assert!(notes[0].contains("1 quadrangle is cut into triangles"), "{notes:?}");
            if corners[0] == "13 1 1 0" {
                mesh.origin = MeshOrigin::default();
                mesh.elements = vec![23, 24];
                assert_eq!(mesh, square);
            }
        }
        // A straight corner is none of a triangle, whatever the sense.
        for corners in [["13 2 0 0", "14 0 1 0"], ["13 2 0 0", "14 1 -3 0"]] {
            assert_eq!(plane(quadrangle(corners).as_bytes()).cells().len(), 2, "{corners:?}");
        }
        let crosswise = quadrangle(["13 1 1 0", "14 0 1 0"]).replace("11 12 13 14", "11 12 14 13");
        let said = read(crosswise.as_bytes()).unwrap_err();
        assert_eq!(
            said,
            "element 23 is a quadrangle whose sides cross: name its corners in their order around it"
        );
        for nodes in ["11 12 13 13", "11 12 12 13", "11 11 12 13", "11 12 13 11"] {
            let text = quadrangle(["13 1 1 0", "14 0 1 0"]).replace("11 12 13 14", nodes);
            let mesh = plane(text.as_bytes());
            assert_eq!(
                (mesh.volume(), mesh.notes().concat().as_str()),
                (0.5, "1 quadrangle with a node twice is read as a triangle"),
                "{nodes}"
            );
        }
        // Version 2 writes a cell of two groups twice.
        let cell = "23 3 2 2 1 11 12 13 14";
        let both = quadrangle(["13 1 1 0", "14 0 1 0"])
            .replace("$Elements\n3", "$Elements\n4")
            .replace(cell, &format!("{cell}\n25 3 2 5 1 11 12 13 14"));
        let names = plane(both.as_bytes()).region_names()[0].to_string();
        assert_eq!(names, "plate, 5");
    }
}
