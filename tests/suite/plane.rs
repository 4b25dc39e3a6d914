//! True solutions on domains in the plane other than the square: digits known from another program, brackets of finite
//! elements, files, refusals.

use crate::common::{Dice, Project, TABLE, gmsh_file, number};
use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::{Boundary, Domain, Fineness, Statement};
use std::fs;

/// Statement of the true solution on a domain.
fn statement(domain: Domain, f: &str) -> Statement {
    Statement {
        solver: Solver::Spectral,
        load: None,
        fineness: Fineness::Refined(1),
        ..Statement::usual(domain, f)
    }
}

/// Problems, one a line: the domain, with friction 0.3 or an inner part that is fixed or free; f; the energy to all
/// digits that another program gave; and ends of contact.
///
/// f = c1 r^k cos(k t) - c0 on the disc has closed forms: with A = c0 / 2 and B = c1 / (4 (k + 1)), contact ends where
/// cos(k t) = A / B - 1.
const KNOWN: &str = "\
    disc | formula(4*x-1) | -0.609846369525688 | 0 1
    disc | formula(8*x-1) | -3.510437382293933 | -0.5 0.866025404 -0.5 -0.866025404
    disc | formula(12*(x^3-3*x*y^2)-1) | -0.837394738980147 | 0.803956443 0.594688187
    lshape | else=-1 | -0.1070379013 |
    lshape | rect(0,9,0,9)=5; else=-3 | -8.730893498 | -1 -0.33266642 0 -0.66849237
    lshape friction | disc(-.3,.4,.4)=4; else=-.6 | -0.232159340 | -1 -0.0155635 0 -0.3180937 0.3947503 0 0.2811096 1
    disc | halfplane(1,.3,-.1)=4; else=-7 | -4.500172948 | 0.3312903 -0.9435289 -0.2427919 0.9700784
    disc | formula(7*(x^2-y^2)-1.5) | -0.744911466 |
    annulus | disc(.2,.8,.15)=30; else=-2 | -0.962794609 | -0.8668429 0.4985814 0.9994879 0.0319987 -0.4658530 0.1816066
    annulus fixed | disc(.2,.8,.15)=30; else=-2 | -0.693480313 | -0.5510441 0.8344761 0.8789100 0.4769876
    annulus free | disc(.2,.8,.15)=30; else=-2 | -1.042053659 | -0.8199202 0.5724779 0.9928603 0.1192827";

#[test]
fn digits_of_another_program_are_reached() {
    for line in KNOWN.lines() {
        let parts: Vec<_> = line.split('|').map(str::trim).collect();
        let [problem, f, energy, ends] = parts[..] else { panic!("{line}") };
        let (name, more) = problem.split_once(' ').unwrap_or((problem, ""));
        let boundary = match more {
            "fixed" => Boundary::default().with("inner", LawNumber::Fixed, 0.0),
            "free" => Boundary::default().with("inner", LawNumber::Free, 0.0),
            "friction" => Boundary::under(LawNumber::Friction, 0.3),
            _ => Boundary::default(),
        };
        let solved = Statement { boundary, ..statement(Domain::named(name), f) }.solved(None);
        let solved = solved.unwrap_or_else(|e| panic!("{line}: {e}"));
        let energy: f64 = energy.parse().unwrap();
        let off = (solved.energy() - energy).abs();
        // They are printed to nine decimals.
        assert!(off < 6e-10, "{line}: {} {off:e}", solved.energy());
        let [low, high] = solved.bounds()[0].as_ref().unwrap().energy;
        assert!(low - 1e-9 < energy && energy < high + 1e-9, "{line}: {low} {high}");
        assert!(high - low < 1e-6 * energy.abs(), "{line}: {low} {high}");
        let arcs = solved.contact().unwrap();
        let found: Vec<_> = arcs.iter().flat_map(|arc| [arc.from, arc.to]).collect();
        let ends: Vec<f64> = ends.split_whitespace().map(|x| x.parse().unwrap()).collect();
        for end in ends.chunks(2) {
            let is_there = |at: &[f64; 2]| (0..2).all(|d| (at[d] - end[d]).abs() < 1e-6);
            assert!(found.iter().any(is_there), "{line}: {end:?} {arcs:?}");
        }
    }
}

/// A Gmsh file of triangles, with the edges of a part named `low`.
fn file(points: &[[f64; 2]], cells: &[[usize; 3]], low: &[[usize; 2]]) -> Vec<u8> {
    file_of_regions(points, &[cells], low)
}

/// A Gmsh file of triangles in regions named `r1`, `r2` and so on, with the edges of a part named `low`.
fn file_of_regions(points: &[[f64; 2]], regions: &[&[[usize; 3]]], low: &[[usize; 2]]) -> Vec<u8> {
    let nodes = (1..).zip(points).map(|(k, [x, y])| format!("{k} {x} {y} 0"));
    let cells = (2..).zip(regions).flat_map(|(of, cells)| cells.iter().map(move |cell| (of, cell)));
    let cells = cells.map(|(of, [a, b, c])| format!(" 2 2 {of} 1 {a} {b} {c}"));
    let edges = low.iter().map(|[a, b]| format!(" 1 2 1 1 {a} {b}"));
    let elements = (1..).zip(edges.chain(cells)).map(|(k, element)| format!("{k}{element}"));
    let [nodes, elements] = [nodes.collect::<Vec<_>>(), elements.collect()].map(|l| l.join("\n"));
    let names = (2..2 + regions.len()).map(|of| format!("2 {of} \"r{}\"\n", of - 1));
    let names = format!("{}\n1 1 \"low\"\n{}", 1 + regions.len(), names.collect::<String>());
    let names = format!("$PhysicalNames\n{names}$EndPhysicalNames\n$Nodes");
    gmsh_file(&nodes, &elements).replacen("$Nodes", &names, 1).into_bytes()
}

/// Polygons: the L-shape, and files with a triangle and with a trapezium, whose lower side may be fixed or free.
fn polygons() -> Vec<(&'static str, Boundary, Option<Vec<u8>>)> {
    let triangle = file(&[[0.0, 0.0], [1.3, 0.1], [0.4, 1.1]], &[[1, 2, 3]], &[[1, 2]]);
    let points = [[-1.0, -0.5], [1.0, -0.5], [0.5, 0.6], [-0.7, 0.4]];
    let trapezium = file(&points, &[[1, 2, 3], [1, 3, 4]], &[[1, 2]]);
    let low = |of| Boundary::default().with("low", of, 0.0);
    vec![
        ("lshape", Boundary::default(), None),
        ("triangle.msh", Boundary::default(), Some(triangle)),
        ("trapezium.msh", low(LawNumber::Fixed), Some(trapezium.clone())),
        ("trapezium.msh", low(LawNumber::Free), Some(trapezium)),
    ]
}

#[test]
fn brackets_of_elements_hold_the_true_energies_of_random_problems() {
    let mut dice = Dice(63);
    let (mut solved, mut asked) = (0, 0);
    for (domain, boundary, file) in polygons() {
        for k in 0..5 {
            let [x, y] = [0, 1].map(|_| dice.between(-0.6, 0.6));
            let (value, rest) = (dice.between(1.0, 6.0), -dice.between(1.0, 4.0));
            let f = match k % 3 {
                0 => format!("disc({x},{y},{})={value}; else={rest}", dice.between(0.2, 0.5)),
                1 => format!("rect({x},{},{y},{})={value}; else={rest}", x + 0.5, y + 0.4),
                _ => format!("halfplane({x},{y},-0.1)={value}; else={rest}"),
            };
            let boundary = match k {
                4 => boundary.clone().with("", LawNumber::Friction, 2.0),
                _ => boundary.clone(),
            };
            let name = format!("{domain} {f} {boundary:?}");
            let truth = Statement { boundary, ..statement(Domain::named(domain), &f) };
            let elements = Statement {
                solver: Solver::Multigrid,
                fineness: Fineness::Refined(5),
                ..truth.clone()
            };
            let Ok(elements) = elements.solved(file.as_deref()) else { continue };
            asked += 1;
            let Ok(truth) = truth.solved(file.as_deref()) else { continue };
            solved += 1;
            let brackets = [&elements, &truth].map(|of| of.bounds()[0].as_ref().unwrap().energy);
            let ([low, high], energy) = (brackets[0], truth.energy());
            assert!(low <= energy && energy <= high, "{name}: {low} {energy} {high}");
            let rounding = 1e-10 * energy.abs();
            let [lower, upper] = brackets[1];
            assert!(
                lower - rounding <= energy && energy <= upper + rounding,
                "{name}: {lower} {energy} {upper}"
            );
            assert!(upper - lower < 0.01 * (high - low), "{name}: {lower} {upper}");
        }
    }
    assert!(asked > 15 && 10 * solved >= 9 * asked, "{solved} of {asked}");
}

#[test]
fn borders_may_end_in_the_middle_of_a_hole() {
    let project = Project::with(TABLE);
    let [truth, near] = ["spectral", "multigrid"].map(|solver| {
        let f = "--domain annulus --f 'rect(0,2,0,2)=3; else=-2'";
        number(&project.answer(&format!("{f} --solver {solver}"))["energy"])
    });
    assert!((truth - near).abs() < 0.02 * near.abs(), "{truth} {near}");
}

#[test]
fn regions_of_a_file_are_as_shapes_with_their_borders() {
    let points = [[-1.0, -0.5], [1.0, -0.5], [0.5, 0.6], [-0.7, 0.4]];
    let straight = file_of_regions(&points, &[&[[1, 2, 3]], &[[1, 3, 4]]], &[[1, 2]]);
    // A disc of two rings of nodes around the centre; the inner one is the border.
    let (mut points, many) = (vec![[0.0; 2]], 24);
    for radius in [0.5, 1.0] {
        for k in 0..many {
            let angle = std::f64::consts::TAU * k as f64 / many as f64;
            points.push([radius * angle.cos(), radius * angle.sin()]);
        }
    }
    let (mut inner, mut outer, mut rim) = (Vec::new(), Vec::new(), Vec::new());
    for k in 1..=many {
        let next = k % many + 1;
        inner.push([1, 1 + k, 1 + next]);
        outer.extend([[1 + k, 1 + many + k, 1 + many + next], [1 + k, 1 + many + next, 1 + next]]);
        rim.push([1 + many + k, 1 + many + next]);
    }
    let round = file_of_regions(&points, &[&inner, &outer], &rim);
    let trapezium = Domain::named("trapezium.msh");
    let energy =
        |f: String| statement(trapezium.clone(), &f).solved(Some(&straight)).unwrap().energy();
    // Alone, and with a shape on the rest that crosses the border.
    for other in ["", "rect(-0.2,0.4,-0.1,0.8)=-7; "] {
        let of_regions = energy(format!("region(r1)=2; {other}else=-6"));
        let of_shapes = energy(format!("{other}halfplane(-1.1,1.5,0.35)=2; else=-6"));
        assert!((of_regions / of_shapes - 1.0).abs() < 1e-10, "{of_regions} {of_shapes}");
    }
    // A border is the polygon of its edges, as the elements have it, also where its nodes lie on a circle.
    let disc = Domain::named("disc.msh");
    for f in ["region(r1)=2; else=-3", "region(r1)=5; rect(-0.2,0.9,-0.1,0.8)=-7; else=-3"] {
        let truth = statement(disc.clone(), f);
        let elements = Statement {
            solver: Solver::Multigrid,
            fineness: Fineness::Refined(5),
            ..truth.clone()
        };
        let [truth, elements] = [truth, elements].map(|one| one.solved(Some(&round)).unwrap());
        let [[lower, upper], [low, high]] =
            [&truth, &elements].map(|of| of.bounds()[0].as_ref().unwrap().energy);
        assert!(low <= upper && lower <= high, "{f}: {lower} {upper}, {low} {high}");
        // The disc inside a circle has more of f.
        assert!(high - low < 2e-3 * high.abs(), "{f}: {low} {high}");
    }
}

#[test]
fn components_of_a_file_are_problems_of_their_own() {
    let one = [[0.0, 0.0], [1.3, 0.1], [0.4, 1.1]];
    let two = one.map(|[x, y]| [x + 2.0, y]);
    let both = file(&[one, two].concat(), &[[1, 2, 3], [4, 5, 6]], &[[1, 2]]);
    let alone = file(&one, &[[1, 2, 3]], &[[1, 2]]);
    let moved = file(&two, &[[1, 2, 3]], &[[1, 2]]);
    let f = "halfplane(1,.3,.4)=4; disc(2.5,.4,.2)=7; else=-3";
    let [both, alone, moved] = [both, alone, moved]
        .map(|file| statement(Domain::named("f.msh"), f).solved(Some(&file)).unwrap());
    let sum = alone.energy() + moved.energy();
    assert!((both.energy() / sum - 1.0).abs() < 1e-12, "{} {sum}", both.energy());
    assert_eq!(both.contact().unwrap().len(), 2);
    let [truth, part] = [&both, &moved].map(|solved| solved.truth().unwrap());
    let point = [2.5, 0.4];
    assert!((truth.values(&[point])[0] - part.values(&[point])[0]).abs() < 1e-12);
    assert_eq!(truth.at(&[1.7, 0.5]), None);
}

#[test]
fn values_at_nodes_and_files_are_those_of_the_true_solution() {
    let project = Project::with(TABLE);
    let f = "rect(0,9,0,9)=5; else=-3";
    let truth = format!("--domain lshape --f '{f}' --solver spectral");
    let json = project.answer(&truth);
    assert_eq!(json["bound"]["energy"].as_array().unwrap().len(), 2, "{json}");
    assert!(json["grids"].is_null() && number(&json["checks"]["residual"]) < 1e-6, "{json}");
    let written = |options: &str, file: &str| {
        project.line(&format!("solve {options} --out {file}")).lines();
        fs::read(project.path(file)).unwrap()
    };
    let truth = format!("{truth} --refine 2");
    assert!(written(&truth, "v.vtu").starts_with(b"<?xml"));
    assert!(written(&truth, "v.svg").starts_with(b"<svg"));
    let values = |bytes: &[u8]| -> Vec<f64> {
        let numbers = &bytes[bytes.len() % 8..];
        numbers.as_chunks::<8>().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect()
    };
    let truth = values(&written(&truth, "v.npy"));
    let elements = values(&written(&format!("--domain lshape --f '{f}' --refine 6"), "w.npy"));
    // The first nodes of a finer mesh are those of the coarser one, and come after the head of the file.
    let nodes = 65;
    let (truth, head) = (&truth[truth.len() - nodes..], 128 / 8);
    let off = truth.iter().zip(&elements[head..]).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 0.01, "{truth:?}");
}

#[test]
fn points_of_the_boundary_lie_in_the_domain() {
    // v = (|x|^2 - 1) / 4 on the unit disc.
    for (name, points) in [
        ("disc", vec![[1.0, 0.0], [-1.0, 0.0], [0.6, 0.8], [-0.28, 0.96]]),
        (
            "lshape",
            vec![[0.0, 0.0], [-1.0, -1.0], [1.0, 0.5], [0.0, -0.5], [-1.0, 0.3], [0.5, 0.0]],
        ),
    ] {
        let solved = statement(Domain::named(name), "else=-1").solved(None).unwrap();
        let outside = [[1.001, 0.0], [0.9, -0.9]];
        let all = points.iter().chain(&outside).map(|point| point.to_vec());
        let values = solved.values_at(&all.collect::<Vec<_>>());
        let (on, off) = values.split_at(points.len());
        assert!(off.iter().all(|own| own.v.is_none()), "{off:?}");
        for own in on {
            let gradient = own.gradient.clone().unwrap();
            assert!(
                own.v == Some(0.0) && gradient.iter().all(|slope| slope.is_finite()),
                "{own:?}"
            );
            let radial = gradient.iter().zip(&own.point).map(|(slope, x)| slope - 0.5 * x);
            assert!(name != "disc" || radial.into_iter().all(|off| off.abs() < 1e-9), "{own:?}");
        }
    }
}

#[test]
fn a_polygon_on_a_circle_is_refused_until_it_has_its_curve() {
    let project = Project::with(TABLE);
    let circle: Vec<_> = (0..100).map(|k| 0.02 * std::f64::consts::PI * f64::from(k)).collect();
    let mut points: Vec<_> = circle.iter().map(|angle| [angle.cos(), angle.sin()]).collect();
    points.push([0.0; 2]);
    let cells: Vec<_> = (1..=100).map(|k| [k, k % 100 + 1, 101]).collect();
    let rim: Vec<_> = (1..=100).map(|k| [k, k % 100 + 1]).collect();
    project.write("round.msh", file(&points, &cells, &rim));
    let round = "--domain round.msh --f else=-1 --solver spectral";
    let said = project.line(&format!("solve {round}"));
    assert!(said.refusal().contains("on a circle, as low=0,0,1; use --solver multigrid"));
    let json = project.answer(&format!("{round} --curve low=0,0,1"));
    // v = (|x|^2 - 1) / 4 on the unit disc.
    let known = -std::f64::consts::PI / 16.0;
    assert!((json["energy"].as_f64().unwrap() - known).abs() < 1e-12, "{json}");
}

/// Copy of the plane: turned by a right angle or mirrored, by a power of two as large, and shifted.
struct Copied {
    turn: [[f64; 2]; 2],
    scale: f64,
    shift: [f64; 2],
}

impl Copied {
    fn direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.turn.map(|row| row[0] * x + row[1] * y)
    }

    fn point(&self, z: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.direction(z);
        [self.scale * x + self.shift[0], self.scale * y + self.shift[1]]
    }

    /// Half-plane, rectangle and disc, all of which meet the boundary of the L-shape.
    fn shapes(&self) -> [String; 3] {
        let [a, b] = self.direction([0.1, 0.3]);
        let along = a * self.shift[0] + b * self.shift[1];
        // So that no digit is lost in the copy.
        let d = self.scale * (-0.1 * 2f64.powi(28)).round() / 2f64.powi(28);
        assert_eq!((along + d) - along, d);
        let [[x0, y0], [x1, y1]] = [[0.25, -0.125], [0.75, 1.5]].map(|z| self.point(z));
        let [x, y] = self.point([-0.75, 0.625]);
        [
            format!("halfplane({a},{b},{})", along + d),
            format!("rect({},{},{},{})", x0.min(x1), x0.max(x1), y0.min(y1), y0.max(y1)),
            format!("disc({x},{y},{})", 0.3 * self.scale),
        ]
    }

    /// Brackets of the energies on the L-shape, over the fourth power of the scale, for each of the shapes.
    fn brackets(&self) -> [[f64; 2]; 3] {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1]];
        let points = corners.map(|z| self.point(z.map(f64::from)));
        let is_mirrored = self.turn[0][0] * self.turn[1][1] < self.turn[0][1] * self.turn[1][0];
        let cells: Vec<[usize; 3]> =
            (2..8).map(|k| if is_mirrored { [1, k + 1, k] } else { [1, k, k + 1] }).collect();
        let file = file(&points, &cells, &[[1, 2]]);
        self.shapes().map(|shape| {
            let stated = statement(Domain::named("l.msh"), &format!("{shape}=2; else=-3"));
            let solved = stated.solved(Some(&file)).unwrap_or_else(|e| panic!("{shape}: {e}"));
            solved.bounds()[0].as_ref().unwrap().energy.map(|end| end / self.scale.powi(4))
        })
    }
}

#[test]
fn brackets_of_copies_turned_scaled_and_far_away_meet() {
    const SAME: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
    let far = |k: i32| [2f64.powi(k + 1), -2f64.powi(k - 1)];
    let own = Copied { turn: SAME, scale: 1.0, shift: [0.0; 2] }.brackets();
    for (turn, scale, shift) in [
        (SAME, 1.0, far(20)),
        (SAME, 1.0, far(26)),
        ([[0.0, -1.0], [1.0, 0.0]], 2f64.powi(-20), [0.0; 2]),
        ([[-1.0, 0.0], [0.0, 1.0]], 2f64.powi(11), [0.0; 2]),
    ] {
        let copy = Copied { turn, scale, shift }.brackets();
        for ([lower, upper], [low, high]) in own.into_iter().zip(copy) {
            let text = format!("{turn:?} {scale} {shift:?}: [{lower}, {upper}] [{low}, {high}]");
            assert!(lower <= high && low <= upper, "{text}");
            assert!(high - low < 1e-9 * high.abs(), "{text}");
        }
    }
}
