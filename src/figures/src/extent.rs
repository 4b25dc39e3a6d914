//! Frames around meshes in the plane: shaped as the mesh, with the same scale along both axes.

use signorini_mathematics::mesh::PlaneMesh;

/// Room around a mesh in the frame of a square one, over its size.
const ROOM: f64 = 0.05;
/// Greatest width and height of a frame in display pixels.
const MOST: [f64; 2] = [668.0, 520.0];
/// Least width and height, for the numbers beside it.
const LEAST: f64 = 48.0;

/// Smallest rectangle around a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Ends along each axis.
    ends: [(f64, f64); 2],
}

impl Extent {
    pub(super) fn of(mesh: &PlaneMesh) -> Self {
        Self { ends: [0, 1].map(|d| super::range(mesh.points().iter().map(|point| point[d]))) }
    }

    /// Returns width and height of the frame of a map alone in its picture, as large as a square of this side unless
    /// that is too long, and the ranges of its axes.
    pub(super) fn frame(self, side: f64) -> ((f64, f64), [(f64, f64); 2]) {
        let room = room(side);
        let lengths = self.lengths();
        let alike = (side - room) / (lengths[0] * lengths[1]).sqrt();
        let longest = [0, 1].map(|d| (MOST[d] - room) / lengths[d]);
        let pixels = alike.min(longest[0]).min(longest[1]);
        let [wide, high] = lengths.map(|length| (length * pixels + room).max(LEAST));
        ((wide, high), self.ranges([wide, high], pixels))
    }

    /// Returns the ranges of x and y in a square frame.
    pub(super) fn in_square(self, side: f64) -> [(f64, f64); 2] {
        let longest = self.lengths().into_iter().fold(0.0, f64::max);
        self.ranges([side; 2], (side - room(side)) / longest)
    }

    /// Returns the ranges in a frame of this size, by the display pixels per length, with the mesh in the middle.
    fn ranges(self, size: [f64; 2], pixels: f64) -> [(f64, f64); 2] {
        [0, 1].map(|d| {
            let (low, high) = self.ends[d];
            let (middle, half) = (0.5 * (low + high), 0.5 * size[d] / pixels);
            (middle - half, middle + half)
        })
    }

    fn lengths(self) -> [f64; 2] {
        self.ends.map(|(low, high)| high - low)
    }
}

/// Room on both sides of a mesh, in display pixels, by the side of the frame of a square one.
fn room(side: f64) -> f64 {
    2.0 * ROOM / (1.0 + 2.0 * ROOM) * side
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(wide: f64, high: f64) -> Extent {
        Extent { ends: [(3.0, 3.0 + wide), (-1.0, -1.0 + high)] }
    }

    #[test]
    fn a_frame_is_shaped_as_its_domain_and_never_too_long_or_too_short() {
        for (wide, high) in
            [(1.0, 1.0), (2.0, 1.0), (10.0, 1.0), (1.0, 20.0), (1e-3, 1.0), (1e6, 1.0)]
        {
            let (size, ranges) = extent(wide, high).frame(288.0);
            let sides = [size.0, size.1];
            let lengths = [wide, high];
            let scales = [0, 1].map(|d| (ranges[d].1 - ranges[d].0) / sides[d]);
            assert!((scales[0] / scales[1] - 1.0).abs() < 1e-12, "{wide} x {high}");
            for d in 0..2 {
                assert!((LEAST..=MOST[d] + 1e-9).contains(&sides[d]), "{wide} x {high}: {size:?}");
                // Around the domain there is room, and no more than a short frame asks for.
                let around = sides[d] - lengths[d] / scales[d];
                assert!(around > 26.0 && around < LEAST, "{wide} x {high}: {around}");
                let (low, high) = extent(wide, high).ends[d];
                assert!((low + high - ranges[d].0 - ranges[d].1).abs() < 1e-9 * (high - low));
            }
        }
        let (size, ranges) = extent(2.0, 2.0).frame(288.0);
        assert!((size.0 - 288.0).abs() < 1e-9 && (size.1 - 288.0).abs() < 1e-9);
        assert!((ranges[0].0 - 2.9).abs() < 1e-12);
        assert_eq!(format!("{:.9?}", extent(2.0, 2.0).in_square(288.0)), format!("{ranges:.9?}"));
    }
}
