//! Connected components of a mesh as meshes of their own.

use super::Mesh;
use super::same_place::components;

/// No number.
const NONE: u32 = u32::MAX;

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Meshes of the connected components, in the order of their first cells, with the regions and parts of all.
    pub(crate) fn split(&self) -> Vec<Self> {
        let of_nodes = components(self.points.len(), &self.cells);
        let mut roots: Vec<u32> =
            self.cells.iter().map(|cell| of_nodes[cell[0] as usize]).collect();
        let of_cells = roots.clone();
        let mut seen = vec![false; self.points.len()];
        roots.retain(|&root| !std::mem::replace(&mut seen[root as usize], true));
        let mut meshes = Vec::with_capacity(roots.len());
        for root in roots {
            let cells: Vec<usize> =
                (0..self.cells.len()).filter(|&cell| of_cells[cell] == root).collect();
            let mut numbers = vec![NONE; self.points.len()];
            let mut points = Vec::new();
            for (node, point) in self.points.iter().enumerate() {
                if of_nodes[node] == root {
                    numbers[node] = points.len() as u32;
                    points.push(*point);
                }
            }
            let mut facets = self.facets.clone();
            facets.retain(|facet| of_nodes[facet.nodes[0] as usize] == root);
            for facet in &mut facets {
                facet.nodes = facet.nodes.map(|node| numbers[node as usize]);
            }
            let renumbered =
                cells.iter().map(|&k| self.cells[k].map(|node| numbers[node as usize]));
            meshes.push(Self {
                points,
                cells: renumbered.collect(),
                elements: cells.iter().filter_map(|&k| self.elements.get(k).copied()).collect(),
                regions: cells.iter().filter_map(|&k| self.regions.get(k).copied()).collect(),
                facets,
                ..self.clone()
            });
        }
        meshes
    }
}
