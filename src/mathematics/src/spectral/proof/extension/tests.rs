//! Bounds of Dirichlet integrals against exact minima, and the distances on which they rest against many points.

use super::*;
use crate::spectral::proof::Proof;
use crate::spectral::proof::bench::solved;

/// Names of problems with all kinds of splits and pieces.
const NAMES: [&str; 8] = [
    "thin bar",
    "disc in contact",
    "ring in contact",
    "half disc",
    "bar with gaps",
    "triangle",
    "three quarters of a disc",
    "ends of contact on a disc",
];

#[test]
fn bounds_on_a_circle_are_those_of_the_density_and_no_less_than_the_minimum() {
    let own = solved("disc in contact");
    let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
    let cells = proof.cells().unwrap();
    let room = Room::new(&own.found.fit.walk, &proof.chords, &cells);
    // H = cos n t on the circle of radius 1, whose harmonic extension has the integral pi n.
    for n in [1.0, 4.0, 20.0, 100.0, 1000.0] {
        let bound = room.integral(&cells, [2.0, 0.0], &vec![n; cells.len()]);
        assert!(bound > PI * n, "{n}: {bound}");
        // Wherever the density is the range over 0.4 radii or the slope along arcs.
        let density = 5.0_f64.max(1.05 * n);
        let areas = cells.iter().map(|own| 0.8 * own.cell.length() + 0.16 * PI);
        let sum = density * density * areas.sum::<f64>();
        assert!((bound / sum - 1.0).abs() < 1e-9, "{n}: {bound} {sum}");
    }
    // A slope next to one cell alone: that of a function with support there, linear on both sides of its middle.
    for p in [0, cells.len() / 2] {
        let mut slopes = vec![0.0; cells.len()];
        slopes[p] = 1e4;
        let far = room.integral(&cells, [1e-9, 0.0], &slopes);
        let near: f64 = (0..cells.len())
            .filter(|&q| {
                let away = (cells[p].middle(&own.found.fit.walk)
                    - cells[q].middle(&own.found.fit.walk))
                .norm();
                away < 0.39
            })
            .map(|q| (1.05e4_f64).powi(2) * (0.8 * cells[q].cell.length() + 0.16 * PI))
            .sum();
        assert!(far >= near, "{far} {near}");
    }
}

#[test]
fn bounds_next_to_splits_count_each_doubling_of_the_distance_and_the_circles_round_them() {
    for name in NAMES {
        let own = solved(name);
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let cells = proof.cells().unwrap();
        let room = Room::new(&own.found.fit.walk, &proof.chords, &cells);
        let graded = own.found.fit.walk.splits.iter().filter(|split| split.depth() < 1.0);
        let (range, slope) = (0.3, 2.0);
        // All slopes the same, in log r those times r.
        let slopes: Vec<f64> = cells
            .iter()
            .map(|own| if own.cell.is_log { slope * own.cell.span[1] } else { slope })
            .collect();
        let bound = room.integral(&cells, [range, 0.0], &slopes);
        let mut least = graded.clone().count() as f64 * 4.0 * PI * range * range;
        for (own, delta) in cells.iter().zip(&room.deltas) {
            let cell = &own.cell;
            let area = |length: f64| 2.0 * delta * length + PI * delta * delta;
            least += match cell.is_log {
                true => {
                    let doublings = (libm::log2(cell.span[1] / cell.span[0])).max(1.0);
                    let density = (range / delta).max(slope * cell.span[1]);
                    doublings * density * density * area(1.0)
                }
                false => (range / delta).max(ARC * slope).powi(2) * area(cell.length()),
            };
        }
        assert!(bound > least * (1.0 - 1e-9) && bound < 1.6 * least, "{name}: {bound} {least}");
        // Without slopes nothing but the range counts, once for each doubling.
        let flat = vec![0.0; cells.len()];
        let bound = room.integral(&cells, [range, 0.0], &flat);
        let mut sum = graded.clone().count() as f64 * 4.0 * PI * range * range;
        for (own, delta) in cells.iter().zip(&room.deltas) {
            let (many, length) = match own.cell.is_log {
                true => (libm::log2(own.cell.span[1] / own.cell.span[0]).ceil(), 1.0),
                false => (1.0, own.cell.length()),
            };
            let density = range / delta;
            sum += many * density * density * (2.0 * delta * length + PI * delta * delta);
        }
        assert!((bound / sum - 1.0).abs() < 1e-9, "{name}: {bound} {sum}");
        // What varies next to splits: interpolated there, and in the range.
        let near = 0.1;
        let more = room.integral(&cells, [range, near], &flat);
        let own = graded.map(|split| interpolated(split.angle, 0.25, 4.5)).sum::<f64>();
        let all = room.integral(&cells, [range + near, 0.0], &flat);
        let least = (all.sqrt() + near * own.sqrt()).powi(2);
        assert!(more >= least, "{name}: {more} {least}");
    }
}

/// Dirichlet integral of the interpolation along circles between values of modulus up to 1 on both sides of an angle,
/// sums of powers of the distance between two, and of its descent to zero.
fn interpolated(angle: f64, least: f64, most: f64) -> f64 {
    // Both derivatives of the values, whose integral is p q / (p + q) for two powers; the difference of the values.
    let up = angle * 0.5 * most + 2.0 / (least * angle);
    let down = 1.5 * angle + 4.0 * LN_2 / angle;
    up + down
}

#[test]
fn what_is_interpolated_next_to_splits_is_no_more_than_its_bound() {
    for k in 1..=40 {
        let angle = 2.0 * PI * f64::from(k) / 40.0;
        let bound = 22.0 * (4.0 * PI + 128.0 / angle);
        // The weakest power is a quarter, that of a slit; with each power the integral of the sector is known.
        for power in [0.25, 0.5, 1.0, 2.0, 4.5] {
            // Values r^p and -r^p.
            let own = angle * power / 2.0 / 3.0 + 4.0 / angle / (2.0 * power);
            assert!(own <= interpolated(angle, 0.25, 4.5), "{angle} {power}: {own}");
        }
        assert!(interpolated(angle, 0.25, 4.5) <= bound, "{angle}: {bound}");
    }
}

/// Point of a cell.
struct CellPoint {
    cell: usize,
    z: Complex,
    /// Distance from the end from which the cell is seen.
    r: f64,
}

fn points(walk: &Walk, cells: &[ProofCell]) -> Vec<CellPoint> {
    let mut points = Vec::new();
    for (cell, own) in cells.iter().enumerate() {
        let [from, to] = own.cell.span;
        for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let r = if own.cell.is_log {
                from * libm::pow(to / from, part)
            } else {
                from + (to - from) * part
            };
            points.push(CellPoint { cell, z: walk.spot(own.interval, own.side, r, 0.0).z, r });
        }
    }
    points
}

#[test]
fn circles_of_the_density_meet_their_own_piece_alone_whose_slopes_count() {
    for name in NAMES {
        let own = solved(name);
        let walk = &own.found.fit.walk;
        let proof = Proof::new(&own.setup, &own.found.fit).unwrap();
        let cells = proof.cells().unwrap();
        let room = Room::new(walk, &proof.chords, &cells);
        let pieces = pieces(walk);
        let points = points(walk, &cells);
        let graded: Vec<_> = walk.splits.iter().filter(|split| split.depth() < 1.0).collect();
        for x in points.iter().filter(|x| x.r > 1e-4) {
            let (own, delta) = (&cells[x.cell], room.deltas[x.cell]);
            let interval = &walk.intervals[own.interval];
            let reach = if own.cell.is_log { delta * x.r } else { delta };
            let mut nearest = 0.4 / interval.curvature.abs();
            for split in &graded {
                let away = (split.z - x.z).norm();
                assert!(
                    own.cell.is_log || 2.0 * delta <= away * (1.0 + 1e-9),
                    "{name}: {own:?} {delta} {away}"
                );
                nearest = nearest.min(0.5 * away);
            }
            for y in &points {
                let other = &cells[y.cell];
                let away = (y.z - x.z).norm();
                let is_same = match own.cell.is_log {
                    true => other.interval == own.interval,
                    false => pieces[other.interval] == pieces[own.interval],
                };
                if !is_same {
                    nearest = nearest.min(away);
                    assert!(
                        reach <= away * (1.0 + 1e-9),
                        "{name}: {own:?} {delta} {away} {other:?}"
                    );
                    continue;
                }
                if away > reach * (1.0 - 1e-9) {
                    continue;
                }
                let (mine, its) = (
                    if own.cell.is_log { x.r } else { 1.0 },
                    if other.cell.is_log { y.r } else { 1.0 },
                );
                let beside = room.beside[x.cell].iter().find(|(q, _)| *q == y.cell);
                let factor = beside.map_or(0.0, |(_, factor)| *factor);
                assert!(
                    factor * its >= mine * (1.0 - 1e-9),
                    "{name}: {own:?} {other:?} {factor} {mine} {its}"
                );
                if own.interval == other.interval && own.side == other.side {
                    assert!((y.r - x.r).abs() <= ARC * away + 1e-15, "{name}: {own:?} {other:?}");
                }
            }
            assert!(
                own.cell.is_log || delta > 0.2 * nearest.min(1.0) || delta > 0.2,
                "{name}: {own:?} {delta} {nearest}"
            );
        }
    }
}
