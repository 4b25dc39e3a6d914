//! Slots, necks and slender holes: brackets of a domain and of its parts by symmetry meet.

use super::*;
use crate::problem::law::Law;
use crate::spectral::geometry::polygons::loop_of;
use crate::spectral::geometry::side::SidePlace;

/// Domain of loops of corners, whose sides are free along these lines x = .. and y = ... .
fn with_free(loops: &[&[[f64; 2]]], lines: [Option<f64>; 2]) -> PlaneDomain {
    let mut all = Vec::new();
    for points in loops {
        let mut conditions = Vec::new();
        for k in 0..points.len() {
            let ends = [points[k], points[(k + 1) % points.len()]];
            let is_free =
                (0..2).any(|axis| lines[axis].is_some_and(|at| ends.iter().all(|p| p[axis] == at)));
            conditions.push(if is_free { Law::FREE } else { Law::SIGNORINI });
        }
        all.push(loop_of(points, &conditions));
    }
    PlaneDomain::new(all).unwrap()
}

/// Guaranteed bracket for f = -1 under the paper's law, all in contact.
fn bracket_of(domain: PlaneDomain) -> [f64; 2] {
    let contact = vec![RingContact::default(); domain.rings.len()];
    bracket_from(domain, "else=-1", PlaneStart { contact, spacing: 1e-3 })
}

/// Guaranteed bracket under the paper's law from a contact set.
fn bracket_from(domain: PlaneDomain, f: &str, start: PlaneStart) -> [f64; 2] {
    let problem = PlaneProblem { domain, source: pieces(f) };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    found.bracket.unwrap()
}

/// Checks that the bracket of a domain meets that of a part of it, of which there are `many`, and that both are narrow.
fn check_parts([lower, upper]: [f64; 2], part: [f64; 2], many: f64, width: f64) {
    let [low, high] = part.map(|end| many * end);
    assert!(lower <= high && low <= upper, "[{lower}, {upper}] [{low}, {high}]");
    for width_of in [upper - lower, high - low] {
        assert!(width_of < width * upper.abs(), "[{lower}, {upper}] [{low}, {high}]");
    }
}

#[test]
fn a_square_with_a_slot_has_twice_the_energy_of_its_half() {
    for (w, d) in [(0.1, 0.5), (0.05, 0.2), (0.3, 0.8)] {
        let [a, b] = [0.5 - 0.5 * w, 0.5 + 0.5 * w];
        let slot = [[a, 0.0], [a, d], [b, d], [b, 0.0]];
        let whole = [&[[0.0, 0.0]], &slot[..], &[[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]].concat();
        let half = [[0.0, 0.0], [a, 0.0], [a, d], [0.5, d], [0.5, 1.0], [0.0, 1.0]];
        let whole = bracket_of(with_free(&[&whole], [None; 2]));
        let half = bracket_of(with_free(&[&half], [Some(0.5), None]));
        check_parts(whole, half, 2.0, 1e-7);
    }
}

#[test]
fn squares_joined_by_a_neck_have_four_times_the_energy_of_their_quarter() {
    for (h, length) in [(0.2, 0.1), (0.006, 0.5)] {
        let (low, high, to) = (0.5 - 0.5 * h, 0.5 + 0.5 * h, 1.0 + length);
        let left = [[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, low]];
        let right = [[to, low], [to, 0.0], [to + 1.0, 0.0], [to + 1.0, 1.0], [to, 1.0]];
        let whole = [&left[..], &right, &[[to, high], [1.0, high]]].concat();
        let middle = 1.0 + 0.5 * length;
        let quarter =
            [[0.0, 0.0], [1.0, 0.0], [1.0, low], [middle, low], [middle, 0.5], [0.0, 0.5]];
        let whole = bracket_of(with_free(&[&whole], [None; 2]));
        let quarter = with_free(&[&quarter], [Some(middle), Some(0.5)]);
        check_parts(whole, bracket_of(quarter), 4.0, 1e-7);
    }
}

#[test]
fn a_square_with_a_slender_hole_has_twice_the_energy_of_its_half() {
    let outer = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let hole = [[0.2, 0.45], [0.2, 0.55], [0.8, 0.55], [0.8, 0.45]];
    let half = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [0.8, 0.5],
        [0.8, 0.45],
        [0.2, 0.45],
        [0.2, 0.5],
        [0.0, 0.5],
    ];
    let whole = bracket_of(with_free(&[&outer, &hole], [None; 2]));
    let half = bracket_of(with_free(&[&half], [None, Some(0.5)]));
    check_parts(whole, half, 2.0, 1e-5);
}

#[test]
fn contact_that_ends_where_a_side_is_free_ends_in_the_corner() {
    const F: &str = "disc(0,0,0.34)=4; else=-2.92";
    let a = 0.178;
    let ends =
        [[0.5, a], [a, 0.5], [-a, 0.5], [-0.5, a], [-0.5, -a], [-a, -0.5], [a, -0.5], [0.5, -a]];
    let whole = bracket_from(square(), F, start(&square(), &[&ends]));
    // Sides that are free meet the other at right angles and at 45 degrees, where powers are whole.
    let conditions = [Law::FREE, Law::SIGNORINI, Law::FREE];
    let sides = loop_of(&[[0.0, 0.0], [0.5, 0.0], [0.5, 0.5]], &conditions);
    let part = PlaneDomain::new(vec![sides]).unwrap();
    // Next to the corner, as Newton's method finds it there.
    let arcs = vec![[a, 0.5 - 1e-8].map(|s| part.rings[0].along(SidePlace { side: 1, s }))];
    let from = PlaneStart {
        contact: vec![RingContact { arcs, gaps: vec![BoundaryState::SlipsUp] }],
        spacing: 1e-3,
    };
    check_parts(whole, bracket_from(part, F, from), 8.0, 1e-9);
}
