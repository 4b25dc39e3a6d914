//! Sharpness with which a table fixes f: how far each value moves before a count changes, and which one does.

use super::evaluate::Evaluator;
use crate::discrete::norms::largest;
use serde::{Deserialize, Serialize};

/// Per row and grid, whether a published count comes out in a free run.
type Held = Vec<Vec<bool>>;

/// Smallest and largest move tried, relative to the largest value of f.
const REACH: [f64; 2] = [1e-5, 1.0];
/// Ratio of one move to the next, hence the resolution of what single cells allow.
const RATIO: f64 = 1.25;
/// Halvings that refine the first break of a direction.
const HALVINGS: usize = 10;

/// A count of the table: row and grid, both counted from 0.
pub(super) type Cell = (usize, usize);

/// Changes of counts along one direction in the space of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Breaks {
    /// Piece whose value moves; `None` if all are multiplied by one factor.
    pub piece: Option<usize>,
    /// Distance by which the value, or the factor from 1, may move down and up with every count that came
    /// out still coming out. The set of such f need not be convex: this is the part around f.
    pub range: [f64; 2],
    /// Count that changes first, down and up; `None` if none did within reach.
    pub first: [Option<Cell>; 2],
    /// `cells[k][level]`: the largest of the moves tried, down and up, up to which this count comes out; the next
    /// one is 1.25 times as large. `None` if it comes out after every move within reach.
    pub cells: Vec<Vec<[Option<f64>; 2]>>,
}

/// The neighbourhood of f in which its table stays as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    /// The values of f.
    pub values: Vec<f64>,
    /// Counts that come out at f; the others constrain nothing.
    pub exact: usize,
    /// One direction per piece, and last the common factor.
    pub directions: Vec<Breaks>,
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
    first: Option<Cell>,
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

    /// Writes down which of the counts `kept` these moves change, from the counts that come out after each.
    fn scan(&mut self, kept: &[Cell], steps: &[f64], found: &[Held]) {
        let mut before = 0.0;
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

/// Maps the neighbourhood of the f with these `values` on the pieces of the evaluator's first geometry.
///
/// # Panics
/// If there is not one value per piece.
pub fn identifiability(evaluator: &Evaluator<'_>, values: &[f64]) -> Identifiability {
    let here = evaluator.held(0, &[values.to_vec()]).remove(0);
    let cells = (0..here.len()).flat_map(|k| (0..here[k].len()).map(move |level| (k, level)));
    let kept: Vec<Cell> = cells.filter(|&(k, level)| here[k][level]).collect();
    let size = largest(values);
    let side = |piece: Option<usize>, sign: f64| {
        let unit = if piece.is_some() { size } else { 1.0 };
        let (between, cells) = ([REACH[1]; 2], vec![None; kept.len()]);
        Side { values, piece, sign, unit, between, first: None, cells }
    };
    let pieces = (0..values.len()).map(Some).chain([None]);
    let mut sides: Vec<Side> =
        pieces.flat_map(|piece| [side(piece, -1.0), side(piece, 1.0)]).collect();
    // The same moves on all sides at once, so that no vector lane is idle.
    let steps: Vec<f64> = std::iter::successors(Some(REACH[0]), |step| Some(step * RATIO))
        .take_while(|step| *step <= REACH[1])
        .collect();
    let moves = sides.iter().flat_map(|side| steps.iter().map(|&step| side.moved(step)));
    let found = evaluator.held(0, &moves.collect::<Vec<_>>());
    for (side, found) in sides.iter_mut().zip(found.chunks(steps.len())) {
        side.scan(&kept, &steps, found);
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
    let breaks = |sides: &[Side]| {
        let [down, up] = sides else { unreachable!("two sides of each direction") };
        let mut cells: Vec<_> = here.iter().map(|row| vec![[None; 2]; row.len()]).collect();
        for (&(k, level), range) in kept.iter().zip(down.cells.iter().zip(&up.cells)) {
            cells[k][level] = [*range.0, *range.1];
        }
        let range = [down, up].map(|side| side.between[0] * side.unit);
        Breaks { piece: down.piece, range, first: [down.first, up.first], cells }
    };
    let directions = sides.chunks(2).map(breaks).collect();
    Identifiability { values: values.to_vec(), exact: kept.len(), directions }
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
