//! Lines through many places, without the corners that no reader would miss.

use super::picture::Place;

/// Greatest distance in display pixels from a corner that is left out to the line that is drawn.
const OFF_LINE: f64 = 0.1;

/// Returns a line without corners that lie within [`OFF_LINE`] of what is left of it (Ramer, Computer Graphics and
/// Image Processing 1, 1972; Douglas and Peucker, Cartographica 10, 1973). Both ends are kept.
///
/// 1. Between two corners that are kept, find the one farthest from the segment between them.
/// 2. If it is too far away, keep it, and go on with both halves; otherwise leave out all that lie between.
pub(super) fn simplified(corners: &[Place]) -> Vec<Place> {
    let Some(last) = corners.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; corners.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut pieces = vec![[0, last]];
    while let Some([from, to]) = pieces.pop() {
        let ends = [corners[from], corners[to]];
        let (mut farthest, mut most) = (from, OFF_LINE * OFF_LINE);
        for (k, &corner) in corners.iter().enumerate().take(to).skip(from + 1) {
            let squared = squared_distance(corner, ends);
            // What has no place stays, and the picture is refused.
            if squared > most || squared.is_nan() {
                (farthest, most) = (k, squared);
            }
        }
        if farthest > from {
            is_kept[farthest] = true;
            pieces.extend([[from, farthest], [farthest, to]]);
        }
    }
    let kept = corners.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept);
    kept.map(|(&corner, _)| corner).collect()
}

/// Square of the distance from a place to a segment, which may be a point.
fn squared_distance((x, y): Place, [(x0, y0), (x1, y1)]: [Place; 2]) -> f64 {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length = dx * dx + dy * dy;
    let along = (x - x0) * dx + (y - y0) * dy;
    let t = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    let (ex, ey) = (x - x0 - t * dx, y - y0 - t * dy);
    ex * ex + ey * ey
}

/// Greatest distance from one of the places to a line.
#[cfg(test)]
pub(super) fn farthest(places: &[Place], line: &[Place]) -> f64 {
    let distances = places.iter().map(|&place| {
        let edges = line.windows(2).map(|edge| squared_distance(place, [edge[0], edge[1]]));
        edges.fold(f64::INFINITY, f64::min)
    });
    distances.fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on a spiral of two turns.
    fn spiral(count: usize) -> Vec<Place> {
        let turns = (0..=count).map(|k| k as f64 / count as f64);
        turns
            .map(|t| {
                let (angle, radius) = (4.0 * std::f64::consts::PI * t, 100.0 * (1.0 + t));
                (radius * libm::cos(angle), radius * libm::sin(angle))
            })
            .collect()
    }

    #[test]
    fn every_corner_that_is_left_out_lies_on_what_is_left_however_many_there_are() {
        for count in [20, 300, 3000, 30_000] {
            let corners = spiral(count);
            let line = simplified(&corners);
            // Such chords have an angle of 0.073 on average; halving makes them up to twice as short.
            assert!(line.len() < 350, "{} of {count}", line.len());
            assert!(farthest(&corners, &line) <= OFF_LINE, "{count}");
            assert_eq!((line[0], line.last()), (corners[0], corners.last()));
        }
    }

    /// Place number `k` on a straight line.
    fn side(k: i32) -> Place {
        (f64::from(k), 0.5 * f64::from(k))
    }

    #[test]
    fn straight_lines_keep_their_few_corners_and_a_way_back_is_one() {
        let straight: Vec<Place> = (0..=1000).map(side).collect();
        assert_eq!(simplified(&straight), [side(0), side(1000)]);
        let there_and_back: Vec<Place> = (0..=900).chain((300..900).rev()).map(side).collect();
        assert_eq!(simplified(&there_and_back), [side(0), side(900), side(300)]);
        // A closed line has no segment between its ends.
        let closed: Vec<Place> = (0..=900).chain((0..900).rev()).map(side).collect();
        assert_eq!(simplified(&closed), [side(0), side(900), side(0)]);
        assert_eq!(simplified(&[(1.0, 2.0)]), [(1.0, 2.0)]);
        assert!(simplified(&[]).is_empty());
    }
}
