//! Isolines of a function that is linear on each triangle of a mesh: borders of the regions where it reaches a level.

use signorini_mathematics::mesh::PlaneMesh;
use std::collections::BTreeMap;

/// Closed polygon, the last corner joined with the first.
pub(super) type Loop = Vec<[f64; 2]>;

/// Corner of a border: a node, or the place on an edge at which the function has the level. As pairs of numbers and not
/// of coordinates, both triangles at an edge have the same one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Corner {
    Node(u32),
    Crossing([u32; 2]),
}

impl Corner {
    /// Crossing of the edge between two nodes, in any order.
    fn between(a: u32, b: u32) -> Self {
        Self::Crossing([a.min(b), a.max(b)])
    }
}

/// Function on a mesh, and a level.
#[derive(Clone, Copy)]
pub(super) struct AtLevel<'a> {
    pub(super) mesh: &'a PlaneMesh,
    /// Values at the nodes.
    pub(super) values: &'a [f64],
    pub(super) level: f64,
}

impl AtLevel<'_> {
    /// Returns the borders of the region in which the function is at least the level, with the region on their left;
    /// those of the whole domain if the level is minus infinity.
    ///
    /// 1. Each edge of the boundary contributes the part of it in the region.
    /// 2. Each triangle that the level crosses contributes the segment that cuts it.
    /// 3. At every corner ends one segment and begins another, so that the segments join to closed polygons.
    pub(super) fn borders(&self) -> Vec<Loop> {
        let mut next: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
        for facet in self.mesh.facets() {
            let [a, b] = facet.nodes;
            let [from, to] = match [a, b].map(|node| self.reaches(node)) {
                [true, true] => [Corner::Node(a), Corner::Node(b)],
                [true, false] => [Corner::Node(a), Corner::between(a, b)],
                [false, true] => [Corner::between(a, b), Corner::Node(b)],
                [false, false] => continue,
            };
            next.entry(from).or_default().push(to);
        }
        for &[a, b, c] in self.mesh.cells() {
            let (mut leaves, mut enters) = (None, None);
            for [p, q] in [[a, b], [b, c], [c, a]] {
                match [p, q].map(|node| self.reaches(node)) {
                    [true, false] => leaves = Some(Corner::between(p, q)),
                    [false, true] => enters = Some(Corner::between(p, q)),
                    [true, true] | [false, false] => {}
                }
            }
            if let (Some(from), Some(to)) = (leaves, enters) {
                next.entry(from).or_default().push(to);
            }
        }
        let mut loops = Vec::new();
        while let Some((&start, _)) = next.first_key_value() {
            let (mut corner, mut border) = (start, Vec::new());
            while let Some(after) = next.get_mut(&corner).and_then(Vec::pop) {
                border.push(self.place(corner));
                corner = after;
            }
            next.retain(|_, after| !after.is_empty());
            loops.push(border);
        }
        loops
    }

    fn reaches(&self, node: u32) -> bool {
        self.values[node as usize] >= self.level
    }

    fn place(&self, corner: Corner) -> [f64; 2] {
        let points = self.mesh.points();
        match corner {
            Corner::Node(node) => points[node as usize],
            Corner::Crossing(nodes) => {
                let [p, q] = nodes.map(|node| points[node as usize]);
                let [low, high] = nodes.map(|node| self.values[node as usize]);
                let t = (self.level - low) / (high - low);
                [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::mesh::{BuiltIn, refine};

    fn area(border: &Loop) -> f64 {
        let next = border.iter().cycle().skip(1);
        border.iter().zip(next).map(|([ax, ay], [bx, by])| 0.5 * (ax * by - ay * bx)).sum()
    }

    fn annulus() -> PlaneMesh {
        refine(&BuiltIn::Annulus.plane().unwrap()).unwrap().mesh
    }

    #[test]
    fn the_whole_domain_has_the_curves_of_its_boundary_as_borders() {
        let mesh = annulus();
        let values = vec![0.0; mesh.points().len()];
        let borders = AtLevel { mesh: &mesh, values: &values, level: f64::NEG_INFINITY }.borders();
        assert_eq!(borders.len(), 2);
        assert_eq!(borders.iter().map(Vec::len).sum::<usize>(), mesh.facets().len());
        let sum: f64 = borders.iter().map(area).sum();
        let cells = mesh.cells().iter().map(|cell| area(&mesh.vertices(cell).to_vec()));
        assert!((sum - cells.sum::<f64>()).abs() < 1e-12);
    }

    #[test]
    fn a_level_cuts_the_domain_where_the_function_has_it() {
        let mesh = annulus();
        let values: Vec<f64> = mesh.points().iter().map(|[x, _]| *x).collect();
        let borders = AtLevel { mesh: &mesh, values: &values, level: 0.1 }.borders();
        assert_eq!(borders.len(), 1);
        assert!(borders[0].iter().all(|[x, _]| *x >= 0.1 - 1e-12) && area(&borders[0]) > 0.0);
        // A straight isoline has a point on every edge that it crosses; inside, two triangles have the edge.
        let crosses = |[a, b]: [u32; 2]| (values[a as usize] < 0.1) != (values[b as usize] < 0.1);
        let cells = mesh.cells().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let sides = cells.filter(|&side| crosses(side)).count();
        let outer = mesh.facets().iter().filter(|facet| crosses(facet.nodes)).count();
        let on_isoline = borders[0].iter().filter(|[x, _]| (x - 0.1).abs() < 1e-12).count();
        assert_eq!(2 * on_isoline, sides + outer);
        assert!(AtLevel { mesh: &mesh, values: &values, level: 2.0 }.borders().is_empty());
    }
}
