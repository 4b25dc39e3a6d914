//! Sharpness with which a table fixes f: how far each value moves before a count changes, and which one does.

use super::COARSEST;
use super::evaluate::Evaluator;
use crate::discrete::norms::largest;
use crate::saddle::batch::LANES;
use serde::{Deserialize, Serialize};

/// Per row and grid, whether a published count comes out in a free run.
type Held = Vec<Vec<bool>>;

/// Smallest and largest move tried, relative to the largest value of f.
const REACH: [f64; 2] = [1e-5, 1.0];
/// Ratio of one move to the next, hence the resolution of what single cells allow.
const RATIO: f64 = 1.25;
/// Halvings that refine the first break of a direction.
const HALVINGS: usize = 10;

/// A count of the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableCell {
    /// Duality parameter of the row.
    pub r: f64,
    /// Cells per side of the grid.
    pub cells: usize,
}

/// Row and grid of a count, both counted from 0.
type Place = (usize, usize);

/// Names of the quadrants, in the order of their values.
const QUADRANTS: [&str; 4] = ["lower left", "lower right", "upper left", "upper right"];

/// Changes of counts along one direction in the space of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Breaks {
    /// Name of the quadrant whose value moves; `None` if all are multiplied by one factor.
    pub quadrant: Option<String>,
    /// The value, or the factor 1.
    pub value: f64,
    /// First change of a count below the value.
    pub down: FirstChange,
    /// First change of a count above the value.
    pub up: FirstChange,
}

/// First change of a count when a value, or the factor of all, moves down or up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstChange {
    /// Distance of the move up to which every count that came out still does. The set of such f need not be convex:
    /// this is the part around f.
    pub range: f64,
    /// Count that changes first; `None` if none did within reach.
    pub first: Option<TableCell>,
}

/// Moves under which the counts of a row stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Holds {
    /// Duality parameter of the row.
    pub r: f64,
    /// Per grid, the largest of the moves tried of any single value, either way, up to which the count comes out; the
    /// next one is 1.25 times as large. `None` if it comes out after every move within reach, or does not at f itself.
    pub moves: Vec<Option<f64>>,
}

/// The neighbourhood of f in which its table stays as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    /// The values of f.
    pub values: Vec<f64>,
    /// Counts that come out at f; the others constrain nothing.
    pub exact: usize,
    /// One direction per quadrant, and last the common factor.
    pub directions: Vec<Breaks>,
    /// Moves of single values under which the counts stay, row by row.
    pub holds: Vec<Holds>,
    /// Hundredth of the largest value of f.
    pub percent: f64,
    /// Number of counts that no move of a single value by up to [`Self::percent`] changes.
    pub loose: usize,
}

/// Number of counts that come out in free runs, on a lattice in the plane of two values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slice {
    /// Pieces whose values vary along x and along y.
    pub pieces: [usize; 2],
    /// Values along x.
    pub x: Vec<f64>,
    /// Values along y.
    pub y: Vec<f64>,
    /// `exact[j][i]`: counts that come out at `(x[i], y[j])`.
    pub exact: Vec<Vec<usize>>,
}

/// One side of a direction: a value, or the factor of all, that moves down or up.
struct Side<'a> {
    values: &'a [f64],
    piece: Option<usize>,
    /// -1 for down, 1 for up.
    sign: f64,
    /// Absolute size of a relative move of one.
    unit: f64,
    /// The longest move known to change no count, and the shortest known to change one, both relative; the largest
    /// tried where none changes any.
    between: [f64; 2],
    /// As in [`Breaks`].
    first: Option<Place>,
    /// Largest move under which each count that comes out at f still does.
    cells: Vec<Option<f64>>,
}

impl Side<'_> {
    fn moved(&self, step: f64) -> Vec<f64> {
        let by = self.sign * step * self.unit;
        let mut moved = self.values.to_vec();
        match self.piece {
            Some(p) => moved[p] += by,
            None => moved.iter_mut().for_each(|v| *v *= 1.0 + by),
        }
        moved
    }

    /// Number of grids up to the finest on which a count of a row, among those `kept`, is not changed yet.
    fn open(&self, kept: &[Place], row: usize) -> usize {
        let counts = kept.iter().zip(&self.cells);
        let open = counts.filter(|&(&(k, _), range)| k == row && range.is_none());
        open.map(|(&(_, level), _)| level + 1).max().unwrap_or(0)
    }

    /// Writes down which of the counts `kept` these moves change, from the counts that come out after each; the longest
    /// move before these is given.
    fn scan(&mut self, kept: &[Place], mut before: f64, steps: &[f64], found: &[Held]) {
        for (now, &step) in found.iter().zip(steps) {
            for (&(k, level), range) in kept.iter().zip(&mut self.cells) {
                if !now[k][level] {
                    range.get_or_insert(before * self.unit);
                    if self.first.is_none() {
                        (self.first, self.between) = (Some((k, level)), [before, step]);
                    }
                }
            }
            before = step;
        }
    }
}

/// Maps the neighbourhood of the f with these `values` on the quadrants, which are the pieces of the evaluator's first
/// geometry.
///
/// # Panics
/// If the evaluator has another geometry.
pub fn identifiability(evaluator: &Evaluator<'_>, values: &[f64; 4]) -> Identifiability {
    let here = evaluator.held(0, &[values.to_vec()]).remove(0);
    let target = evaluator.target();
    let cells = (0..here.len()).flat_map(|k| (0..here[k].len()).map(move |level| (k, level)));
    let kept: Vec<Place> = cells.filter(|&(k, level)| here[k][level]).collect();
    let size = largest(values);
    let side = |piece: Option<usize>, sign: f64| {
        let unit = if piece.is_some() { size } else { 1.0 };
        let (between, cells) = ([REACH[1]; 2], vec![None; kept.len()]);
        Side { values, piece, sign, unit, between, first: None, cells }
    };
    let pieces = (0..values.len()).map(Some).chain([None]);
    let mut sides: Vec<Side> =
        pieces.flat_map(|piece| [side(piece, -1.0), side(piece, 1.0)]).collect();
    // The same moves on all sides at once, so that no vector lane is idle, and of each row as long as a count may
    // change.
    let steps: Vec<f64> = std::iter::successors(Some(REACH[0]), |step| Some(step * RATIO))
        .take_while(|step| *step <= REACH[1])
        .collect();
    let mut before = 0.0;
    for steps in steps.chunks(LANES) {
        let moves = sides.iter().flat_map(|side| steps.iter().map(|&step| side.moved(step)));
        let moves: Vec<_> = moves.collect();
        let found = evaluator
            .held_where(0, &moves, |number, row| sides[number / steps.len()].open(&kept, row));
        for (side, found) in sides.iter_mut().zip(found.chunks(steps.len())) {
            side.scan(&kept, before, steps, found);
        }
        before = steps[steps.len() - 1];
    }
    let mut open: Vec<&mut Side> = sides.iter_mut().filter(|side| side.first.is_some()).collect();
    for _ in 0..HALVINGS {
        let middle = |side: &Side| 0.5 * (side.between[0] + side.between[1]);
        let moves: Vec<_> = open.iter().map(|side| side.moved(middle(side))).collect();
        for (side, held) in open.iter_mut().zip(evaluator.held(0, &moves)) {
            let broken = kept.iter().copied().find(|&(k, level)| !held[k][level]);
            side.between[usize::from(broken.is_some())] = middle(side);
            side.first = broken.or(side.first);
        }
    }
    let cell = |(k, level): Place| TableCell { r: target.r[k], cells: COARSEST << level };
    let first = |side: &Side| FirstChange {
        range: side.between[0] * side.unit,
        first: side.first.map(cell),
    };
    let breaks = |sides: &[Side]| Breaks {
        quadrant: sides[0].piece.map(|p| QUADRANTS[p].to_owned()),
        value: sides[0].piece.map_or(1.0, |p| values[p]),
        down: first(&sides[0]),
        up: first(&sides[1]),
    };
    let directions = sides.chunks(2).map(breaks).collect();
    let mut holds: Vec<Holds> = Vec::new();
    for &r in &target.r {
        holds.push(Holds { r, moves: vec![None; target.levels()] });
    }
    for side in sides.iter().filter(|side| side.piece.is_some()) {
        for (&(k, level), range) in kept.iter().zip(&side.cells) {
            let least = &mut holds[k].moves[level];
            *least = least.iter().chain(range).copied().reduce(f64::min);
        }
    }
    let percent = 0.01 * size;
    let moves = holds.iter().flat_map(|row| &row.moves);
    let loose = moves.filter(|greatest| greatest.is_none_or(|it| it > percent)).count();
    let (values, exact) = (values.to_vec(), kept.len());
    Identifiability { values, exact, directions, holds, percent, loose }
}

/// Counts that come out when the values of two pieces of the evaluator's first geometry vary by up to `reach`,
/// each its own, either way.
///
/// # Panics
/// If a piece does not exist.
pub fn slice(
    evaluator: &Evaluator<'_>,
    values: &[f64],
    pieces: [usize; 2],
    reach: [f64; 2],
    points: usize,
) -> Slice {
    let axis = |k: usize| -> Vec<f64> {
        let (middle, reach) = (values[pieces[k]], reach[k]);
        let step = 2.0 * reach / points.saturating_sub(1).max(1) as f64;
        (0..points).map(|i| middle - reach + step * i as f64).collect()
    };
    let (x, y) = (axis(0), axis(1));
    let moved = |(v, u): (f64, f64)| {
        let mut moved = values.to_vec();
        moved[pieces[1]] = v;
        moved[pieces[0]] = u;
        moved
    };
    let all: Vec<_> = y.iter().flat_map(|&v| x.iter().map(move |&u| (v, u))).map(moved).collect();
    let count = |held: &Held| held.iter().flatten().filter(|&&held| held).count();
    let counts: Vec<usize> = evaluator.held(0, &all).iter().map(count).collect();
    let exact = counts.chunks(points.max(1)).map(<[usize]>::to_vec).collect();
    Slice { pieces, x, y, exact }
}
