//! Warnings about meshes of files: the same in every unit, and told where rounding errors leave a residual.

use crate::common::{Project, TABLE, gmsh_file};

/// Two unit squares side by side, of two triangles each.
const SQUARES: (&[[i32; 3]], &str) = (
    &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]],
    "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 2 2 2 5 6\n4 2 2 2 2 2 6 3",
);
/// Two tetrahedra on either side of a triangle.
const TETRAHEDRA: (&[[i32; 3]], &str) = (
    &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]],
    "1 4 2 1 1 1 2 3 4\n2 4 2 1 1 2 3 4 5",
);
const SOLVERS: [&str; 2] = ["multigrid", "active-set"];

/// Warnings of an answer on the mesh of a file.
fn warnings(project: &Project, file: String, more: &str) -> String {
    project.write("m.msh", file);
    project.answer(&format!("--domain m.msh {more}"))["warnings"].to_string()
}

#[test]
fn warnings_do_not_depend_on_the_unit() {
    let project = Project::with(TABLE);
    for (points, elements) in [SQUARES, TETRAHEDRA] {
        for solver in SOLVERS {
            let said = [1.0, 1e-40, 1e-6, 1e6, 1e40].map(|unit| {
                let nodes = (1..).zip(points).map(|(k, point)| {
                    let [x, y, z] = point.map(|x| unit * f64::from(x));
                    format!("{k} {x:e} {y:e} {z:e}")
                });
                let file = gmsh_file(&nodes.collect::<Vec<_>>().join("\n"), elements);
                warnings(&project, file, &format!("--refine 2 --f else=-1 --solver {solver}"))
            });
            assert!(!said[0].contains("balance") && !said[0].contains("sums"), "{said:?}");
            assert!(said.iter().all(|one| *one == said[0]), "{said:?}");
        }
    }
}

#[test]
fn residuals_that_rounding_errors_leave_are_told() {
    let project = Project::with(TABLE);
    for (height, is_told) in [("1e-7", true), ("0.1", false)] {
        let nodes = (0..=300).map(|k| {
            let x = f64::from(k) / 300.0;
            format!("{} {x} 0 0\n{} {x} {height} 0", k + 1, k + 302)
        });
        let elements = (1..=300).map(|k| {
            let [a, b, c, d] = [k, k + 1, k + 302, k + 301];
            format!("1 2 2 1 1 {a} {b} {c}\n1 2 2 1 1 {a} {c} {d}")
        });
        let [nodes, elements] = [nodes.collect::<Vec<_>>(), elements.collect()];
        let file = gmsh_file(&nodes.join("\n"), &elements.join("\n"));
        for solver in SOLVERS {
            let more = "--f 'rect(0,0.3,-9,9)=3; else=-2' --refine 0 --solver";
            let said = warnings(&project, file.clone(), &format!("{more} {solver}"));
            assert_eq!(said.contains("rounding errors leave a KKT residual"), is_told, "{said}");
        }
    }
}
