//! f by formulas: loads against closed forms and known solutions.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{mesh_load, uniform_cube};
use signorini_mathematics::square::load::{integral, load};

use signorini_mathematics::problem::source::{Source, Tie};

const RULES: [LoadRule; 4] = [
    LoadRule::Exact { diagonal: Diagonal::Rising },
    LoadRule::Exact { diagonal: Diagonal::Falling },
    LoadRule::Bilinear {},
    LoadRule::Nodal { tie: Tie::LowerLeft, diagonal: Some(Diagonal::Rising) },
];

fn source(text: &str) -> Source {
    text.parse().unwrap()
}

/// Largest difference of two vectors.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn loads_of_polynomials_are_their_integrals() {
    let f = source("formula(x + 2*y^2 - 3*x*y - 1)");
    assert!((integral(&f) + 5.0 / 6.0).abs() < 1e-13);
    for n in [2, 5, 16] {
        let grid = Grid::new(n).unwrap();
        for rule in &RULES[..3] {
            let load = load(grid, &f, *rule);
            let mut moments = [0.0; 3];
            for (node, part) in load.iter().enumerate() {
                let [x, y] = [node % grid.side(), node / grid.side()].map(|i| grid.coordinate(i));
                moments = [moments[0] + part, moments[1] + part * x, moments[2] + part * y];
            }
            let error = apart(&moments, &[-5.0 / 6.0, 1.0 / 12.0, 0.0]);
            assert!(error < 1e-14, "{rule:?} 1/{n} {error:e}");
        }
    }
}

#[test]
fn formulas_have_the_loads_of_known_solutions_and_constants() {
    for (formula, other) in [
        ("formula(-2*pi^2*cos(pi*x)*cos(pi*y))", "exact(full-contact)"),
        ("formula(-1.5)", "else=-1.5"),
    ] {
        let (formula, other) = (source(formula), source(other));
        assert!((integral(&formula) - integral(&other)).abs() < 1e-13);
        let grid = Grid::new(8).unwrap();
        for rule in RULES {
            let error = apart(&load(grid, &formula, rule), &load(grid, &other, rule));
            assert!(error < 1e-15, "{rule:?} {error:e}");
        }
    }
    for (formula, other) in [
        ("formula(-3*pi^2*cos(pi*x)*cos(pi*y)*cos(pi*z))", "exact(full-contact)"),
        ("formula(-1.5)", "else=-1.5"),
    ] {
        let [formula, other]: [Source<3>; 2] = [formula, other].map(|text| text.parse().unwrap());
        let mesh = uniform_cube(4);
        let [one, same] = [&formula, &other].map(|f| mesh_load(&mesh, f).unwrap());
        assert!((one.integral - same.integral).abs() < 1e-12);
        let error = apart(&one.load, &same.load);
        assert!(error < 1e-15, "{error:e}");
    }
}
