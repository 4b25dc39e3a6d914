//! Partitions of a mesh, of which a file may have one alone.
//!
//! Version 4 lists the partitions of all entities, also in a file of one partition. Version 2 has the partition of each
//! element, and that of neighbours only with ghost cells; but a file of one partition keeps the numbers of the nodes.

use super::build::Sections;
use super::error::GmshError;
use std::collections::BTreeSet;

/// Part of the numbers of nodes that are missing in a file of one partition, at least: a whole mesh may be partitioned
/// into one, and some numbers be left out.
const MISSING: f64 = 0.1;

impl Sections {
    /// Checks that all partitions are there.
    pub(super) fn check_partitions(&self) -> Result<(), GmshError> {
        let Self { elements, entities, .. } = self;
        let dimension = if elements.tetrahedra.is_empty() { 2 } else { 3 };
        let found = &elements.partitions[dimension];
        if found.is_empty() {
            return Ok(());
        }
        // Where all cells are in groups, Gmsh has saved no others.
        let listed = entities.partitions(dimension as i64, !self.has_cell_without_group());
        if listed.iter().any(|partition| !found.contains(partition)) {
            let all = found.union(&listed).count().to_string();
            return Err(GmshError::Partitions { found: found.len(), all });
        }
        let named: BTreeSet<u64> = found.union(&elements.ghosts).copied().collect();
        if named.len() > found.len() || (found.len() == 1 && self.has_missing_nodes()) {
            let all = format!("at least {}", named.last().copied().unwrap_or_default().max(2));
            return Err(GmshError::Partitions { found: found.len(), all });
        }
        Ok(())
    }

    fn has_missing_nodes(&self) -> bool {
        let tags = &self.nodes.tags;
        let greatest = tags.iter().fold(0, |most, &tag| most.max(tag)) as f64;
        self.entities.is_empty() && greatest - tags.len() as f64 > MISSING * greatest
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::read;

    /// Unit square of two triangles, each a partition.
    const TWO: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n\
        $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
        $Elements\n2\n1 2 4 0 1 1 1 1 2 3\n2 2 4 0 1 1 2 1 3 4\n$EndElements\n";
    /// Entities of the square in version 4.
    const ENTITIES: &str = "$Entities\n0 0 2 0\n1 0 0 0 1 1 0 0 0\n2 0 0 0 1 1 0 0 0\n$EndEntities\n\
        $PartitionedEntities\n2\n1\n9 2\n0 0 2 0\n3 2 1 1 1 0 0 0 1 1 0 0 0\n4 2 2 1 2 0 0 0 1 1 0 0 0\n\
        $EndPartitionedEntities\n";
    const FOUR_ZERO: &str =
        "$Nodes\n1 4\n3 2 0 4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n";
    const FOUR_ONE: &str =
        "$Nodes\n1 4 1 4\n2 3 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n$Elements\n";

    /// Refusal of a file, if it is refused.
    fn said(text: &str) -> Option<String> {
        read(text.as_bytes()).err()
    }

    /// File without one of the cells of the square.
    fn piece(cell: &str) -> String {
        TWO.replace("$Elements\n2", "$Elements\n1").replace(cell, "")
    }

    /// Refusal of a file in version 4.0 or 4.1, if it is refused.
    fn said_of(version: &str, entities: &str, elements: &str) -> Option<String> {
        let nodes = if version == "4.0" { FOUR_ZERO } else { FOUR_ONE };
        let head = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        let file = format!("{head}{entities}{nodes}{elements}$EndElements\n");
        said(&file)
    }

    #[test]
    fn one_of_two_partitions_is_refused_in_version_4() {
        let said = Some("the file has 1 of 2 partitions; save the mesh in one file".to_owned());
        let [first, second] = ["2 3 2 1\n1 1 2 3\n", "2 4 2 1\n2 1 3 4\n"];
        let ghost = "2 9 2 1\n2 1 3 4\n";
        assert_eq!(said_of("4.1", ENTITIES, &format!("2 2 1 2\n{first}{second}")), None);
        assert_eq!(said_of("4.1", ENTITIES, &format!("1 1 1 1\n{first}")), said);
        assert_eq!(said_of("4.1", ENTITIES, &format!("1 1 2 2\n{second}")), said);
        assert_eq!(said_of("4.1", ENTITIES, &format!("2 2 1 2\n{first}{ghost}")), said);
        // Version 4.0 has entities before their dimensions.
        let [first, second] = [first.replace("2 3 2", "3 2 2"), second.replace("2 4 2", "4 2 2")];
        assert_eq!(said_of("4.0", ENTITIES, &format!("2 2\n{first}{second}")), None);
        assert_eq!(said_of("4.0", ENTITIES, &format!("1 1\n{second}")), said);
    }

    #[test]
    fn partitions_of_entities_that_are_not_saved_are_not_missed() {
        let piece = "1 1 1 1\n2 3 2 1\n1 1 2 3\n";
        let first = ENTITIES.replace("\n1 0 0 0 1 1 0 0 0", "\n1 0 0 0 1 1 0 1 7 0");
        assert_eq!(said_of("4.1", &first, piece), None);
        let both = first.replace("\n2 0 0 0 1 1 0 0 0", "\n2 0 0 0 1 1 0 1 7 0");
        assert!(said_of("4.1", &both, piece).is_some());
    }

    #[test]
    fn one_of_two_partitions_is_refused_in_version_2() {
        let [first, second] = ["1 2 4 0 1 1 1 1 2 3\n", "2 2 4 0 1 1 2 1 3 4\n"];
        assert_eq!(said(TWO), None);
        let into_one = TWO.replace(second, "2 2 4 0 1 1 1 1 3 4\n");
        assert_eq!(said(&into_one), None);
        let with_gap = piece(first).replace("2 1 0 0\n", "").replace("$Nodes\n4", "$Nodes\n3");
        let two = "the file has 1 of at least 2 partitions; save the mesh in one file";
        assert_eq!(said(&with_gap).as_deref(), Some(two));
        let ghost = piece(second).replace("1 2 4 0 1 1 1", "1 2 5 0 1 2 1 -3");
        assert_eq!(said(&ghost), Some(two.replace('2', "3")));
    }
}
