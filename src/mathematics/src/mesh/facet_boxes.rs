//! Facets by the boxes in which they lie, so that few of them are compared with a point or with each other.
//!
//! The boxes are a little larger than the facets, so that this holds on graded meshes too.

use super::geometry::{bounds, size};
use std::collections::{BTreeSet, HashMap};

/// Distance over the size of a facet up to which a point lies on the facet.
pub(super) const NEAR: f64 = 1e-9;

/// Facets by their boxes, each facet by its position in a list.
pub(super) struct FacetBoxes<const D: usize> {
    exponents: BTreeSet<i32>,
    facets_in: HashMap<GridBox<D>, Vec<u32>>,
}

/// Box in space: a power of two as width, and the position in units of the width.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct GridBox<const D: usize> {
    exponent: i32,
    position: [i64; D],
}

impl<const D: usize> GridBox<D> {
    /// Box of this width that holds a point.
    fn around(point: [f64; D], exponent: i32) -> Self {
        let position = point.map(|x| libm::floor(libm::ldexp(x, -exponent)) as i64);
        Self { exponent, position }
    }
}

impl<const D: usize> FacetBoxes<D> {
    /// Boxes of facets, given by their corners.
    pub(super) fn new(facets: impl Iterator<Item = [[f64; D]; D]>) -> Self {
        let mut boxes = Self { exponents: BTreeSet::new(), facets_in: HashMap::new() };
        for (facet, corners) in facets.enumerate() {
            let exponent = exponent(corners);
            boxes.exponents.insert(exponent);
            for found in boxes_around(corners, exponent) {
                boxes.facets_in.entry(found).or_default().push(facet as u32);
            }
        }
        boxes
    }

    /// Facets near a point.
    pub(super) fn near_point(&self, point: [f64; D]) -> impl Iterator<Item = u32> {
        let lists = self.exponents.iter().map(move |&exponent| GridBox::around(point, exponent));
        lists.filter_map(|found| self.facets_in.get(&found)).flatten().copied()
    }

    /// Facets near a facet, given by its corners, in boxes that are not narrower than those of the facet.
    pub(super) fn near_facet(&self, corners: [[f64; D]; D]) -> BTreeSet<u32> {
        let exponents = self.exponents.range(exponent(corners)..);
        let lists = exponents.flat_map(|&exponent| boxes_around(corners, exponent));
        lists.filter_map(|found| self.facets_in.get(&found)).flatten().copied().collect()
    }
}

/// Exponent of the width of the boxes of a facet, which is larger than the facet.
fn exponent<const D: usize>(corners: [[f64; D]; D]) -> i32 {
    libm::ilogb(size(corners).max(f64::MIN_POSITIVE)) + 1
}

/// Returns the boxes of a width that a facet meets, at most two or three in each direction.
fn boxes_around<const D: usize>(corners: [[f64; D]; D], exponent: i32) -> Vec<GridBox<D>> {
    let size = size(corners);
    let bounds = bounds(&corners);
    let low = GridBox::around(bounds.map(|[least, _]| least - NEAR * size), exponent).position;
    let high =
        GridBox::around(bounds.map(|[_, greatest]| greatest + NEAR * size), exponent).position;
    let mut positions = vec![low];
    for d in 0..D {
        for k in 0..positions.len() {
            let mut position = positions[k];
            // The second bound, for numbers whose squares are zero, is reached by no mesh that has a use.
            while position[d] < high[d].min(low[d].saturating_add(2)) {
                position[d] += 1;
                positions.push(position);
            }
        }
    }
    positions.into_iter().map(|position| GridBox { exponent, position }).collect()
}
