//! Facets by the boxes around them, so that few of them are compared with a point or with each other.
//!
//! The boxes, with sides along the axes and a little larger than the facets, are those of a tree: the middle one by the
//! longest side of all centres parts the others.

use super::geometry::{bounds, size};

/// Distance over the size of a facet up to which a point lies on the facet.
pub(super) const NEAR: f64 = 1e-9;

/// Least and greatest coordinate in each direction.
type Bounds<const D: usize> = [[f64; 2]; D];

/// Facets by their boxes, each facet by its position in a list.
pub(super) struct FacetBoxes<const D: usize>(Vec<TreeBox<D>>);

/// Middle of a part of the tree.
struct TreeBox<const D: usize> {
    facet: u32,
    own: Bounds<D>,
    /// Bounds of all boxes of the part.
    all: Bounds<D>,
}

impl<const D: usize> FacetBoxes<D> {
    /// Boxes of facets, given by their corners.
    pub(super) fn new(facets: impl Iterator<Item = [[f64; D]; D]>) -> Self {
        let of_facet = |(corners, facet)| {
            let own = around(corners);
            TreeBox { facet, own, all: own }
        };
        let mut tree: Vec<TreeBox<D>> = facets.zip(0..).map(of_facet).collect();
        arrange(&mut tree);
        Self(tree)
    }

    /// Facets near a point.
    pub(super) fn near_point(&self, point: [f64; D]) -> Vec<u32> {
        self.meeting(&point.map(|x| [x, x]))
    }

    /// Facets near a facet, given by its corners.
    pub(super) fn near_facet(&self, corners: [[f64; D]; D]) -> Vec<u32> {
        self.meeting(&around(corners))
    }

    /// Facets whose boxes meet these bounds, in increasing order.
    fn meeting(&self, bounds: &Bounds<D>) -> Vec<u32> {
        let (mut found, mut parts) = (Vec::new(), vec![&self.0[..]]);
        while let Some(part) = parts.pop() {
            let middle = part.len() / 2;
            let Some(node) = part.get(middle).filter(|node| meet(&node.all, bounds)) else {
                continue;
            };
            found.extend(meet(&node.own, bounds).then_some(node.facet));
            parts.extend([&part[..middle], &part[middle + 1..]]);
        }
        found.sort_unstable();
        found
    }
}

/// Box around a facet, a little larger.
fn around<const D: usize>(corners: [[f64; D]; D]) -> Bounds<D> {
    let more = NEAR * size(corners);
    bounds(&corners).map(|[least, greatest]| [least - more, greatest + more])
}

fn meet<const D: usize>(one: &Bounds<D>, two: &Bounds<D>) -> bool {
    one.iter().zip(two).all(|(one, two)| one[0] <= two[1] && two[0] <= one[1])
}

/// Arranges boxes as a tree.
fn arrange<const D: usize>(boxes: &mut [TreeBox<D>]) {
    let middle = boxes.len() / 2;
    if boxes.is_empty() {
        return;
    }
    let centres: Vec<[f64; D]> =
        boxes.iter().map(|of| of.own.map(|[low, high]| 0.5 * low + 0.5 * high)).collect();
    let lengths = bounds(&centres).map(|[least, greatest]| greatest - least);
    let axis = (0..D).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).expect("a direction");
    let centre = |of: &TreeBox<D>| 0.5 * of.own[axis][0] + 0.5 * of.own[axis][1];
    boxes.select_nth_unstable_by(middle, |a, b| centre(a).total_cmp(&centre(b)));
    let mut all = boxes[middle].own;
    let (below, above) = boxes.split_at_mut(middle);
    for part in [below, &mut above[1..]] {
        arrange(part);
        if let Some(node) = part.get(part.len() / 2) {
            for (all, of_part) in all.iter_mut().zip(node.all) {
                *all = [all[0].min(of_part[0]), all[1].max(of_part[1])];
            }
        }
    }
    boxes[middle].all = all;
}
