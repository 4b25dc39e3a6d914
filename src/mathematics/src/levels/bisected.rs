//! Meshes of a run of adaptive refinement, made anew without a solution.

use super::triangulations::read;
use super::{Problem, ProblemError, Triangulations};
use crate::discrete::nested::NestedNetwork;
use crate::mesh::{
    NestedMeshes, PlaneMesh, Sides, assemble_sides, bisect, label_longest_edges, mesh_load, quarter,
};

impl Problem {
    /// Problem on the meshes of a run that marked these cells for its bisections, one list for each, with f as text; an
    /// empty list divides all cells into four.
    ///
    /// # Errors
    /// [`ProblemError`] as the run had them.
    ///
    /// # Panics
    /// If there is no cell with a number that is marked.
    pub fn on_bisected(
        coarsest: &PlaneMesh,
        marks: &[Vec<u32>],
        f: &str,
    ) -> Result<Self, ProblemError> {
        let (f, text) = (read(coarsest, f)?, f);
        let mut mesh = coarsest.clone();
        label_longest_edges(&mut mesh);
        let mut sides = Sides::new(&mesh);
        let network = assemble_sides(&mesh, &sides);
        let mut networks = vec![NestedNetwork { network, parents: Vec::new() }];
        let mut meshes = vec![mesh];
        for marked in marks {
            let coarse = &meshes[meshes.len() - 1];
            let made =
                if marked.is_empty() { quarter(coarse) } else { bisect(coarse, &sides, marked) }?;
            let network = assemble_sides(&made.mesh, &made.sides);
            networks.push(NestedNetwork { network, parents: made.parents });
            meshes.push(made.mesh);
            sides = made.sides;
        }
        let load = mesh_load(&meshes[meshes.len() - 1], &f[..])?;
        let is_curved = coarsest.parts().iter().any(|part| part.curve.is_some());
        let nested = NestedMeshes { meshes, networks, sides };
        let levels = Triangulations::of(nested, (f, text), load);
        Ok(Self::checked(levels, is_curved))
    }
}
