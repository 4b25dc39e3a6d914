//! Samples: numbers that look random, right-hand sides, meshes, and tables as they are read.

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;
use signorini_mathematics::mesh::{AnyMesh, gmsh};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::square::load::integral;
use std::collections::BTreeMap;
use std::fs;

/// Names and f of the paper's problems, from their scenes.
pub(crate) fn paper_problems() -> Vec<(String, String)> {
    let scenes = [
        include_str!("../../pipeline/scenes/problem1.toml"),
        include_str!("../../pipeline/scenes/problem2.toml"),
    ];
    let scenes = scenes.map(|text| text.parse::<toml::Table>().unwrap());
    let named = scenes.map(|scene| {
        let (name, f) = (format!("problem {}", scene["paper_table"]), scene["f"].as_str());
        (name, f.unwrap().to_owned())
    });
    named.into()
}

/// Row of a table in CSV, by the names of its columns.
pub(crate) type Row = BTreeMap<String, String>;

/// Rows of a table in CSV.
pub(crate) fn rows(csv: &str) -> Vec<Row> {
    let mut lines = csv.lines().map(cells);
    let head = lines.next().expect("a header");
    lines.map(|cells| head.iter().cloned().zip(cells).collect()).collect()
}

/// Cells of a line in CSV.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().unwrap().push(c),
        }
    }
    cells
}

/// Text of a file in Gmsh's version 2.2 with these nodes and elements, one a line.
pub(crate) fn gmsh_file(nodes: &str, elements: &str) -> String {
    let [of_nodes, of_elements] = [nodes, elements].map(|lines| lines.lines().count());
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{of_nodes}\n{nodes}\n$EndNodes\n\
         $Elements\n{of_elements}\n{elements}\n$EndElements\n"
    )
}

/// Path of a file in `tests/meshes/`.
pub(crate) fn mesh_path(name: &str) -> String {
    format!("{}/tests/meshes/{name}.msh", env!("CARGO_MANIFEST_DIR"))
}

/// Mesh of a built-in domain, or of a file in `tests/meshes/`.
pub(crate) fn mesh(name: &str) -> AnyMesh {
    let of_file = || gmsh::read(&fs::read(mesh_path(name)).unwrap()).unwrap();
    AnyMesh::built_in(name).unwrap_or_else(of_file)
}

/// Deterministic numbers that look random: xorshift64*.
pub(crate) struct Dice(pub u64);

impl Dice {
    /// A number below `bound`.
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) % bound
    }

    /// A number from 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.below(1 << 32) as f64 / 2f64.powi(32)
    }

    /// A number between two others.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// Overlapping shapes with a negative integral, to two decimals.
pub(crate) fn random_source(dice: &mut Dice) -> Source {
    let mut hundredths = |low: i64, high: i64| {
        let width = u64::try_from(high - low).unwrap();
        (low + i64::try_from(dice.below(width)).unwrap()) as f64 / 100.0
    };
    loop {
        let mut text = String::new();
        for _ in 0..hundredths(100, 500) as usize {
            let value = hundredths(-800, 800);
            text += &match hundredths(0, 500) as usize {
                0 | 1 => {
                    let [x, y] = [0; 2].map(|_| hundredths(-60, 40));
                    let [w, h] = [0; 2].map(|_| hundredths(5, 80));
                    format!("rect({x},{},{y},{})", x + w, y + h)
                }
                2 => ["quadrant(ll)", "quadrant(lr)", "quadrant(ul)", "quadrant(ur)"]
                    [hundredths(0, 400) as usize]
                    .into(),
                3 => {
                    let [x, y] = [0; 2].map(|_| hundredths(-60, 60));
                    format!("disc({x},{y},{})", hundredths(6, 45))
                }
                _ => {
                    let [a, c] = [hundredths(-100, 100), hundredths(-50, 50)];
                    format!("halfplane({a},{},{c})", hundredths(-100, 100) + 0.003)
                }
            };
            text += &format!("={value}; ");
        }
        let f: Source = (text + &format!("else={}", hundredths(-600, 300))).parse().unwrap();
        if integral(&f) < -0.02 {
            return f;
        }
    }
}

/// Settings of a property test with the same cases every time: a failure is a failure for everyone.
pub(crate) fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}
