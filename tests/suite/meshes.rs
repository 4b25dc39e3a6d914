//! Meshes from outside: broken files are refused in one line, and meshes that are valid pass however they are numbered.

use crate::common::{Dice, config};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::TestCaseError;
use signorini_mathematics::mesh::gmsh::read;
use signorini_mathematics::mesh::{AnyMesh, BuiltIn, Facet, Mesh, MeshData, MeshError, refine};
use std::sync::LazyLock;
use std::{fs, path::Path};

/// Displacement of an inner node over the shortest edge.
const JITTER: f64 = 0.08;

/// Words that take the place of others.
const WORDS: [&str; 12] = [
    "",
    "0",
    "-1",
    "2",
    "4",
    "1e308",
    "-1e-308",
    "nan",
    "4294967296",
    "18446744073709551615",
    "$EndNodes",
    "\"\u{2028}\r\u{7}\"",
];

/// Files in `tests/meshes/`.
static FILES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let mut paths: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "msh"));
    paths.sort();
    paths.into_iter().map(|path| fs::read(path).unwrap()).collect()
});

/// Damage to a file.
#[derive(Clone, Debug)]
enum Damage {
    CutEnd(Index),
    CutOut(Index, usize),
    FlipBit(Index, u8),
    SwapWords(Index, Index),
    ReplaceWord(Index, &'static str),
    RepeatLine(Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = any::<Index>;
    prop_oneof![
        at().prop_map(Damage::CutEnd),
        (at(), 1..200usize).prop_map(|(at, length)| Damage::CutOut(at, length)),
        (at(), 0..8u8).prop_map(|(at, bit)| Damage::FlipBit(at, bit)),
        (at(), at()).prop_map(|(one, two)| Damage::SwapWords(one, two)),
        (at(), select(WORDS.to_vec())).prop_map(|(at, word)| Damage::ReplaceWord(at, word)),
        at().prop_map(Damage::RepeatLine),
    ]
}

/// Words of a file, with the blanks that follow.
fn words(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.split_inclusive(u8::is_ascii_whitespace).collect()
}

impl Damage {
    fn apply(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let after = match self {
            Self::CutEnd(at) => bytes[..at.index(bytes.len())].to_vec(),
            Self::CutOut(at, length) => {
                let at = at.index(bytes.len());
                [&bytes[..at], &bytes[(at + length).min(bytes.len())..]].concat()
            }
            Self::FlipBit(at, bit) => {
                let mut after = bytes.clone();
                after[at.index(bytes.len())] ^= 1 << bit;
                after
            }
            Self::SwapWords(one, two) => {
                let mut words = words(bytes);
                let count = words.len();
                words.swap(one.index(count), two.index(count));
                words.concat()
            }
            Self::ReplaceWord(at, word) => {
                let (mut words, word) = (words(bytes), [word.as_bytes(), b" "].concat());
                let at = at.index(words.len());
                words[at] = &word;
                words.concat()
            }
            Self::RepeatLine(at) => {
                let mut lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
                let at = at.index(lines.len());
                lines.insert(at, lines[at]);
                lines.concat()
            }
        };
        *bytes = after;
    }
}

proptest! {
    #![proptest_config(config(5000))]

    #[test]
    fn a_damaged_file_is_a_mesh_or_refused_in_one_line(
        file in any::<Index>(), damages in prop::collection::vec(damage(), 1..4)
    ) {
        let mut bytes = file.get(&FILES).clone();
        damages.iter().for_each(|damage| damage.apply(&mut bytes));
        match read(&bytes) {
            Ok(AnyMesh::Plane(mesh)) => prop_assert!(mesh.volume() > 0.0 && refine(&mesh).is_ok()),
            Ok(AnyMesh::Space(mesh)) => prop_assert!(mesh.volume() > 0.0 && refine(&mesh).is_ok()),
            Err(line) => {
                let is_short = (1..400).contains(&line.len());
                prop_assert!(is_short && !line.contains(char::is_control), "{line:?}");
            }
        }
    }
}

#[test]
fn a_number_that_promises_more_than_the_file_holds_is_refused() {
    for head in
        ["2.2 0 8\n$EndMeshFormat\n$Nodes\n", "4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 1 0 "]
    {
        let text = format!("$MeshFormat\n{head}18446744073709551615\n1 0 0 0\n$EndNodes\n");
        assert!(read(text.as_bytes()).is_err());
    }
    for section in ["Nodes", "Elements", "Entities"] {
        let mut bytes = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n".to_vec();
        bytes.extend(format!("${section}\n").bytes().chain([0xff; 200]));
        assert!(read(&bytes).is_err());
    }
}

/// Data of a mesh without curves: inner nodes a little displaced, nodes and cells in another order, in another scale.
fn shuffled<const D: usize, const V: usize>(mesh: &Mesh<D, V>, dice: &mut Dice) -> MeshData<D, V> {
    let mut is_inner = vec![true; mesh.points().len()];
    mesh.facets().iter().flat_map(|facet| facet.nodes).for_each(|k| is_inner[k as usize] = false);
    let step = JITTER * shortest_edge(mesh) / (D as f64).sqrt();
    let (scale, shift) = (10f64.powf(6.0 * dice.unit() - 3.0), 20.0 * dice.unit() - 10.0);
    let mut places: Vec<u32> = (0..).take(mesh.points().len()).collect();
    shuffle(&mut places, dice);
    let mut data = MeshData {
        points: vec![[0.0; D]; mesh.points().len()],
        parts: mesh.parts().to_vec(),
        ..MeshData::default()
    };
    data.parts.iter_mut().for_each(|part| part.curve = None);
    for (node, point) in mesh.points().iter().enumerate() {
        let reach = if is_inner[node] { step } else { 0.0 };
        data.points[places[node] as usize] =
            point.map(|x| scale * (x + reach * (2.0 * dice.unit() - 1.0) + shift));
    }
    // In any order, which is in either sense.
    for cell in mesh.cells() {
        let mut nodes = cell.map(|node| places[node as usize]);
        shuffle(&mut nodes, dice);
        data.cells.push(nodes);
    }
    shuffle(&mut data.cells, dice);
    data.facets.extend(mesh.facets().iter().map(|facet| Facet {
        nodes: facet.nodes.map(|node| places[node as usize]),
        part: facet.part,
    }));
    shuffle(&mut data.facets, dice);
    data
}

fn shuffle<T>(items: &mut [T], dice: &mut Dice) {
    for k in (1..items.len()).rev() {
        items.swap(k, dice.below(k as u64 + 1) as usize);
    }
}

fn shortest_edge<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> f64 {
    let mut shortest = f64::INFINITY;
    for vertices in mesh.cells().iter().map(|cell| mesh.vertices(cell)) {
        for (k, one) in vertices.iter().enumerate() {
            for other in &vertices[..k] {
                let square: f64 = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
                shortest = shortest.min(square.sqrt());
            }
        }
    }
    shortest
}

/// The mesh after some refinements.
fn refined<const D: usize, const V: usize>(mut mesh: Mesh<D, V>, times: u64) -> Mesh<D, V> {
    for _ in 0..times {
        mesh = refine(&mesh).unwrap().mesh;
    }
    mesh
}

/// A shuffled mesh passes the checks, and keeps its facets and, when refined, its volume.
fn passes<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    dice: &mut Dice,
) -> Result<(), TestCaseError> {
    let data = shuffled(mesh, dice);
    let checked = data.clone().mesh();
    prop_assert!(checked.is_ok(), "{checked:?}");
    let checked = checked.unwrap();
    prop_assert_eq!(checked.facets().len(), mesh.facets().len());
    let fine = refine(&checked).unwrap().mesh;
    prop_assert!((fine.volume() / checked.volume() - 1.0).abs() < 1e-12);
    prop_assert_eq!(fine.facets().len(), (1 << (D - 1)) * checked.facets().len());
    Ok(())
}

/// A shuffled mesh of which one cell is cut in two at the midpoint of an edge is refused, unless no other cell has the
/// edge.
fn one_cut_is_found<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    dice: &mut Dice,
) -> Result<(), TestCaseError> {
    let mut data = shuffled(mesh, dice);
    (data.facets, data.parts) = (Vec::new(), Vec::new());
    let cut = dice.below(data.cells.len() as u64) as usize;
    let first = dice.below(V as u64) as usize;
    let second = (first + 1 + dice.below(V as u64 - 1) as usize) % V;
    let edge = [data.cells[cut][first], data.cells[cut][second]];
    let cells = data.cells.iter().filter(|cell| edge.iter().all(|node| cell.contains(node)));
    let is_shared = cells.count() > 1;
    let [a, b] = edge.map(|node| data.points[node as usize]);
    let new = data.points.len() as u32;
    data.points.push(std::array::from_fn(|d| 0.5 * (a[d] + b[d])));
    let mut other = data.cells[cut];
    (data.cells[cut][first], other[second]) = (new, new);
    data.cells.push(other);
    let checked = data.mesh();
    match is_shared {
        true => {
            let found =
                matches!(checked, Err(MeshError::Hanging { node, .. }) if node == u64::from(new));
            prop_assert!(found, "{checked:?}");
        }
        false => prop_assert!(checked.is_ok(), "{checked:?}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(60))]

    #[test]
    fn a_valid_mesh_passes_in_every_order_and_keeps_its_volume(seed in 1..u64::MAX) {
        let mut dice = Dice(seed);
        let domains = [BuiltIn::Disc, BuiltIn::LShape, BuiltIn::Annulus, BuiltIn::Ball];
        let domain = domains[dice.below(domains.len() as u64) as usize];
        if let Some(plane) = domain.plane() {
            let mesh = refined(plane, dice.below(5));
            passes(&mesh, &mut dice)?;
            one_cut_is_found(&mesh, &mut dice)?;
        }
        if let Some(space) = domain.space() {
            let mesh = refined(space, dice.below(3));
            passes(&mesh, &mut dice)?;
            one_cut_is_found(&mesh, &mut dice)?;
        }
    }
}
