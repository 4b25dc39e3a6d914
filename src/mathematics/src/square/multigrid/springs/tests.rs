//! Tests of the springs against the lattice: energies of sets in contact, ends, corners and single nodes.

use super::*;
use crate::square::multigrid::coarsest::Coarsest;
use crate::square::multigrid::rows::share;

/// Contact flags counter-clockwise for these nodes in contact.
fn set(n: usize, nodes: impl IntoIterator<Item = usize>) -> Vec<bool> {
    let mut flags = vec![false; 4 * n];
    nodes.into_iter().for_each(|p| flags[p % (4 * n)] = true);
    flags
}

/// `1 / (4 + spring)` counter-clockwise.
fn inverse_diagonal(n: usize, set: &[bool], cells: usize) -> Vec<f64> {
    let mut springs = vec![0.0; 4 * cells];
    find_springs(n, set, &intervals(n, set), &mut springs);
    springs.iter().map(|s| if *s < STIFFEST { 1.0 / (4.0 + s) } else { 0.0 }).collect()
}

#[test]
fn the_finest_grid_sees_its_own_contact_set() {
    let n = 16;
    for (first, last) in [(3, 3), (3, 4), (5, 14), (0, 0), (15, 17), (16, 16), (60, 70), (14, 35)] {
        let inverse = inverse_diagonal(n, &set(n, first..=last), n);
        for (p, inverse) in inverse.into_iter().enumerate() {
            let inside = (first..=last).any(|q| q % (4 * n) == p);
            let expected = if inside { 0.0 } else { 0.25 };
            // A single node reaches a little further than the end of a run.
            let wrong = (inverse - expected).abs();
            assert!(wrong < 0.01, "{first}..={last} at {p}: {inverse}");
        }
    }
}

#[test]
fn ends_between_coarse_nodes_become_springs() {
    // Contact on 4..=9 of the finest grid ends at 9 + TIP, 4.5 + TIP / 2 in coarse cells: node 4 is in
    // contact, and node 5 has a spring for the rest.
    let inverse = inverse_diagonal(32, &set(32, 4..=9), 16);
    let rest = 0.5 - 0.5 * TIP;
    assert_eq!((inverse[3], inverse[4]), (0.0, 0.0));
    assert!((0.5 / inverse[5] - (2.0 + SPRING * rest / (1.0 - rest))).abs() < 1e-12);
    assert_eq!(inverse[6], 0.25);
}

#[test]
fn short_intervals_keep_their_capacity() {
    // One node seen from grids 2, 4 and 8 times coarser: each adds ln 2 / pi to the resistance.
    let contact = set(64, [32]);
    for (coarse_n, halvings) in [(32, 1.0), (16, 2.0), (8, 3.0)] {
        let inverse = inverse_diagonal(64, &contact, coarse_n)[coarse_n / 2];
        let spring = 0.5 / inverse - 2.0;
        assert!((1.0 / spring - halvings * 2.0_f64.ln() / PI).abs() < 1e-9, "{coarse_n}");
    }
}

#[test]
fn contact_everywhere_and_nowhere_have_no_ends() {
    for (nodes, expected) in [(0..32, 0.0), (0..0, 0.25)] {
        let inverses = inverse_diagonal(8, &set(8, nodes), 4);
        assert!(inverses.iter().all(|&inverse| inverse == expected));
    }
}

/// `F'y` for a constant load and the linear problem with these inverses on the boundary.
fn energy(n: usize, inverse_diagonal: &[f64]) -> f64 {
    let mut level = MultigridLevel::new(n);
    level.load.iter_mut().for_each(|half| half.fill((n as f64).powi(-2)));
    for (p, inverse) in inverse_diagonal.iter().enumerate() {
        level.inverse_diagonal[number(n, p)] = *inverse;
    }
    let mut coarsest = Coarsest::new(n);
    coarsest.factor(&level);
    coarsest.solve_linear(&mut level);
    let mut energy = 0.0;
    for k in 0..level.nodes {
        let cell = share(n, k % (n + 1)) * share(n, k / (n + 1)) / (n * n) as f64;
        energy += cell * level.value(k);
    }
    energy
}

#[test]
fn coarse_grids_see_how_much_a_set_holds() {
    let n = 64;
    let on_edges = [(32, 32), (31, 31), (30, 31), (29, 31), (90, 97)];
    let beside_corner = [(65, 65), (65, 66), (66, 66), (66, 67), (68, 68), (65, 68), (60, 62)];
    let short = [(0, 0), (0, 1), (1, 0), (1, 1), (0, 2), (1, 2), (2, 2)];
    let legs = short.into_iter().chain([(3, 0), (3, 3), (4, 4), (9, 6)]);
    let around_corner = legs.map(|(before, after)| (n - before, n + after));
    for (first, last) in around_corner.chain(on_edges).chain(beside_corner) {
        let contact = set(n, first..=last);
        let own: Vec<_> = contact.iter().map(|&held| if held { 0.0 } else { 0.25 }).collect();
        let exact = energy(n, &own);
        for coarse_n in [32, 16, 8] {
            let ratio = energy(coarse_n, &inverse_diagonal(n, &contact, coarse_n)) / exact;
            assert!((ratio - 1.0).abs() < 0.01, "{first}..={last} on {coarse_n}: {ratio}");
        }
    }
}

/// `Re sqrt(z^2 - reach^2)` at node (i, j).
fn far_field(reach: f64, i: usize, j: usize) -> f64 {
    let (x, y) = (i as f64, j as f64);
    let (re, im) = (x * x - y * y - reach * reach, 2.0 * x * y);
    (0.5 * (re.hypot(im) + re)).sqrt()
}

/// Reach around the corner, in cells, of a spring or of contact at node (1, 0) of a quadrant whose left side is in
/// contact; `inverse` is the inverse of the diagonal at that node.
///
/// The lattice problem is solved on a square with [`far_field`] on its far sides, and the reach is adjusted to the
/// solution in the middle, six times.
fn reach_around_the_corner(inverse: f64) -> f64 {
    const N: usize = 48;
    const SWEEPS: usize = 400;
    let relaxation = 2.0 / (1.0 + PI / N as f64);
    let mut reach = 0.0;
    for _ in 0..6 {
        let mut v = vec![[0.0; N + 1]; N + 1];
        for (j, row) in v.iter_mut().enumerate() {
            for (i, value) in row.iter_mut().enumerate() {
                *value = far_field(reach, i, j);
            }
        }
        for _ in 0..SWEEPS {
            for j in 0..N {
                for i in 1..N {
                    let sides = v[j][i - 1] + v[j][i + 1];
                    let best = match (i, j) {
                        (1, 0) => inverse * (0.5 * sides + v[1][1]),
                        (_, 0) => 0.5 * (0.5 * sides + v[1][i]),
                        _ => 0.25 * (sides + v[j - 1][i] + v[j + 1][i]),
                    };
                    v[j][i] += relaxation * (best - v[j][i]);
                }
            }
        }
        let middle = (N / 2) as f64;
        reach = (middle * middle - v[0][N / 2] * v[0][N / 2]).sqrt();
    }
    reach
}

const RHO: f64 = 3.0 - 2.0 * SQRT_2;

/// First `count` coefficients of `(1 - ratio z)^(-power)`.
fn binomial_series(power: f64, ratio: f64, count: usize) -> Vec<f64> {
    let mut terms = vec![1.0];
    for k in 0..count - 1 {
        terms.push(terms[k] * ratio * (power + k as f64) / (k + 1) as f64);
    }
    terms
}

/// Coefficient `k` of the product of a slowly and a fast decreasing series.
fn product_coefficient(slow: &[f64], fast: &[f64], k: usize) -> f64 {
    fast.iter().enumerate().map(|(m, c)| c * slow[k - m]).sum()
}

/// End of the interval by `k - (u / C)^2`, from coefficient `k = count - 1` of U.
fn end_from_series(t: f64, count: usize) -> f64 {
    let slow = binomial_series(1.5, 1.0, count);
    let fast = binomial_series(0.5, RHO, 60);
    let u = (1.0 - t) * product_coefficient(&slow, &fast, count - 1)
        + t * product_coefficient(&slow, &fast, count - 2);
    let growth = 2.0 / PI.sqrt() / (1.0 - RHO).sqrt();
    count as f64 - (u / growth).powi(2)
}

#[test]
fn ends_and_springs_are_those_of_the_lattice() {
    for t in [0.0, 0.3, 0.9] {
        let extrapolated = 2.0 * end_from_series(t, 20_000) - end_from_series(t, 10_000);
        assert!((extrapolated - TIP - t).abs() < 1e-6, "{t}: {extrapolated}");
    }
    // The factorisation of the symbol.
    for angle in [0.1, 1.0, 3.0_f64] {
        let c = angle.cos();
        let factors = ((2.0 - 2.0 * c) * (1.0 + RHO * RHO - 2.0 * RHO * c) / RHO).sqrt();
        assert!((2.0 * ((1.0 - c) * (3.0 - c)).sqrt() / factors - 1.0).abs() < 1e-12);
    }
    assert!((end_spring(0.3) - 0.3 / 0.7 / (2.0 * RHO.sqrt())).abs() < 1e-12);
}

#[test]
fn corner_constants_are_those_of_the_lattice() {
    let contact = reach_around_the_corner(0.0);
    assert!((contact / CORNER_LEG - 1.0).abs() < 1e-3, "{contact}");
    for t in [0.2, 0.5, 0.8_f64] {
        let reach = reach_around_the_corner(1.0 / (2.0 + CORNER_SPRING * t / (1.0 - t)));
        assert!((reach / (CORNER_LEG * t.sqrt()) - 1.0).abs() < 1e-3, "{t}: {reach}");
    }
}
