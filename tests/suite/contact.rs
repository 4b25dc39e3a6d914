//! Contact sets have the symmetries of f, and multipliers of the cube its total force, whatever rounding errors do.

use crate::common::Dice;
use crate::domains::{CubeMesh, Domain, SquareGrid, run};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{arcs, square_boundary};
use signorini_mathematics::multigrid::{Goal, MultigridParams};
use signorini_mathematics::problem::shape::Shape;
use signorini_mathematics::square::load::{integral, load};
use signorini_mathematics::square::multigrid::solve_square;

use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::Pair;

const EXACT: LoadRule = LoadRule::Exact { diagonal: Diagonal::Rising };

/// The solutions for a load vector by multigrid and, on coarse grids, by the active sets.
fn solutions(n: usize, load: &[f64]) -> Vec<Vec<f64>> {
    let params = MultigridParams::default();
    let mut solutions = vec![solve_square(n, Law::SIGNORINI, load, &params).unwrap().0];
    if n <= 64 {
        solutions.push(SquareGrid(n).direct(load).unwrap());
    }
    solutions
}

/// Contact at the boundary nodes as the judgement reads it and as pictures do, which must be the same.
fn in_contact(grid: Grid, y: &[f64], load: &[f64]) -> Vec<bool> {
    let judgement = judge((grid, Law::SIGNORINI), y, load);
    let contact = judgement.in_contact();
    let a = judgement.multiplier(y);
    assert_eq!(Pair { y: y.to_vec(), a }.in_contact((grid, Law::SIGNORINI)), contact);
    contact
}

/// Whether a set of boundary nodes is mapped to itself, where the map is given for twice the indices from the middle.
fn is_symmetric(grid: Grid, set: &[bool], map: [[i64; 2]; 2]) -> bool {
    let n = grid.cells() as i64;
    let nodes: Vec<_> = grid.boundary().collect();
    let side = grid.side() as i64;
    nodes.iter().zip(set).all(|(&node, &is)| {
        let [x, y] = [node as i64 % side, node as i64 / side].map(|i| 2 * i - n);
        let [i, j] = map.map(|row| (row[0] * x + row[1] * y + n) / 2);
        let image = nodes.iter().position(|&other| other as i64 == j * side + i).unwrap();
        set[image] == is
    })
}

const TURN: [[i64; 2]; 2] = [[0, -1], [1, 0]];
const MIRROR: [[i64; 2]; 2] = [[-1, 0], [0, 1]];
const RISING: [[i64; 2]; 2] = [[0, 1], [1, 0]];
const FALLING: [[i64; 2]; 2] = [[0, -1], [-1, 0]];

#[test]
fn no_corner_between_nodes_in_contact_is_a_gap() {
    // The load of two corner cells is zero but for rounding errors: both halves of f cancel there.
    let mut tried = 0;
    for value in [1.0, 0.1, 2.0, 0.3, 1e-9, 1e9] {
        for (plane, diagonal) in [("1,-1,0", RISING), ("1,1,0", FALLING), ("-1,1,0", RISING)] {
            for pull in ["disc(0,0,0.25)", "rect(-0.2,0.2,-0.2,0.2)"] {
                let f =
                    format!("halfplane({plane})={value}; {pull}={}; else=-{value}", -9.0 * value);
                let f: Source = f.parse().unwrap();
                for (n, rule) in [8, 24, 64, 128]
                    .into_iter()
                    .zip([EXACT, LoadRule::Bilinear {}].into_iter().cycle())
                {
                    let grid = Grid::new(n).unwrap();
                    let load = load(grid, &f, rule);
                    for y in solutions(n, &load) {
                        let arcs = arcs(
                            &[square_boundary(grid, Law::SIGNORINI)],
                            &y,
                            &judge((grid, Law::SIGNORINI), &y, &load),
                        );
                        assert_eq!(arcs.len(), 1, "{f} 1/{n}: {arcs:?}");
                        assert!((arcs[0].force + integral(&f)).abs() < 1e-9 * value, "{f} 1/{n}");
                        let contact = in_contact(grid, &y, &load);
                        let corners = [0, n, 2 * n, 3 * n].map(|corner| contact[corner]);
                        assert_eq!(corners.into_iter().filter(|&is| is).count(), 3, "{f} 1/{n}");
                        // f less its mean changes its sign; only the pull is symmetric in all ways.
                        assert!(
                            is_symmetric(
                                grid,
                                &contact,
                                if diagonal == RISING { FALLING } else { RISING }
                            ),
                            "{f} 1/{n}"
                        );
                        tried += 1;
                    }
                }
            }
        }
    }
    assert_eq!(tried, 6 * 3 * 2 * 7);
}

#[test]
fn contact_has_the_symmetries_of_f() {
    let mut dice = Dice(7);
    let mut partial = 0;
    for case in 0..120 {
        let [x, y, size] = [0; 3].map(|_| dice.unit());
        let [x, y, size] = [0.4 * x - 0.2, 0.4 * y - 0.2, 0.05 + 0.2 * size];
        let value = if case % 2 == 0 { 4.0 } else { -4.0 };
        // Images of one disc under the symmetries in question, each side of the square included.
        let (places, maps): (Vec<[f64; 2]>, Vec<_>) = match case % 4 {
            0 => (vec![[0.0, 0.0]], vec![TURN, MIRROR]),
            1 => (vec![[x, y], [y, x]], vec![RISING]),
            2 => (vec![[x, y], [-x, y]], vec![MIRROR]),
            _ => (vec![[x, y], [-y, x], [-x, -y], [y, -x]], vec![TURN]),
        };
        let discs: Vec<_> =
            places.iter().map(|[x, y]| format!("disc({x:?},{y:?},{size:?})={value}")).collect();
        let f: Source = format!("{}; else=-1", discs.join("; ")).parse().unwrap();
        if integral(&f) > -0.05 {
            continue;
        }
        let n = [16, 48, 64][case % 3];
        let grid = Grid::new(n).unwrap();
        let load = load(grid, &f, LoadRule::Bilinear {});
        for y in solutions(n, &load) {
            let contact = in_contact(grid, &y, &load);
            partial += usize::from(contact.contains(&false));
            for &map in &maps {
                assert!(is_symmetric(grid, &contact, map), "{f} 1/{n}");
            }
        }
    }
    assert!(partial > 20, "{partial}");
}

#[test]
fn the_multiplier_of_the_cube_has_the_total_force() {
    let mut dice = Dice(11);
    for case in 0..24 {
        let cube = CubeMesh::new([1, 3, 1, 1][case % 4], [2, 1, 3, 4][case % 4]);
        let centre = [0; 3].map(|_| dice.unit() - 0.5);
        let ball = Shape::Ball { centre, radius: 0.1 + 0.3 * dice.unit() };
        let value = 3.0 * dice.unit() - 2.0;
        let pieces = if case == 0 { Vec::new() } else { vec![(ball, value)] };
        let load = cube.load(&Source::Pieces { background: -1.0, pieces });
        let total: f64 = -load.iter().sum::<f64>();
        if total < 0.05 {
            continue;
        }
        let (y, _) = run(&cube, &load, Goal::RoundingFloor);
        let judgement = judge(cube.network(), &y, &load);
        let a = judgement.multiplier(&y);
        let forces = judgement.contact.iter().zip(&a).map(|(contact, a)| contact.measure * a);
        let force: f64 = forces.sum();
        assert!((force - total).abs() < 1e-12 * total.max(1.0), "{case}: {force} {total}");
        let least = a.iter().copied().fold(f64::INFINITY, f64::min);
        if least > 0.0 {
            assert!((judgement.kkt.min_lambda.unwrap() - least).abs() < 1e-15, "{case}: {least}");
        }
    }
}

#[test]
fn contact_does_not_change_when_f_is_multiplied_by_a_number() {
    let mut partial = 0;
    for (case, pieces) in [
        ["disc(-0.25,0,0.2)", "6", "-1"],
        ["quadrant(ll)", "3", "-1.1"],
        ["rect(-0.3,0.1,-0.2,0.4)", "-5", "0.25"],
        ["halfplane(1,2,-0.1)", "-2", "0"],
    ]
    .into_iter()
    .enumerate()
    {
        let n = [32, 64, 128, 48][case];
        let grid = Grid::new(n).unwrap();
        let contacts = |factor: f64| {
            let [shape, value, background] = pieces;
            let [value, background] =
                [value, background].map(|text| factor * text.parse::<f64>().unwrap());
            let f: Source = format!("{shape}={value:e}; else={background:e}").parse().unwrap();
            let load = load(grid, &f, LoadRule::Bilinear {});
            solutions(n, &load).iter().map(|y| in_contact(grid, y, &load)).collect::<Vec<_>>()
        };
        let one = contacts(1.0);
        assert!(one.iter().all(|contact| *contact == one[0]));
        partial += usize::from(one[0].contains(&false));
        for factor in [1e-120, 3.7e-45, 1e-3, 0.1, 7.0, 1e6, 9.1e77, 1e120] {
            assert_eq!(contacts(factor), one, "{pieces:?} times {factor:e}");
        }
    }
    assert!(partial >= 3, "{partial}");
}
