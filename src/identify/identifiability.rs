//! How sharply a table fixes f: how far each value moves before a count changes, and which one does.

use super::evaluate::Evaluator;
use crate::discrete::norms::largest;
use serde::{Deserialize, Serialize};

/// Per row and grid, whether a published count comes out.
type Held = Vec<Vec<bool>>;

/// Smallest and largest move tried, relative to the largest value of f.
const REACH: [f64; 2] = [1e-5, 1.0];
/// Ratio of one move to the next, hence the resolution of what single cells allow.
const RATIO: f64 = 1.25;
/// Halvings that refine the first break of a direction.
const HALVINGS: usize = 10;

/// A count of the table: row and grid, both counted from 0.
pub(super) type Cell = (usize, usize);

/// What happens along one direction in the space of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Breaks {
    /// Piece whose value moves; `None` if all are multiplied by one factor.
    pub piece: Option<usize>,
    /// How far the value, or the factor from 1, may move down and up with every count that came
    /// out still coming out. The set of such f need not be convex: this is the part around f.
    pub range: [f64; 2],
    /// Count that changes first, down and up; `None` if none did within reach.
    pub first: [Option<Cell>; 2],
    /// `cells[k][level]`: how far this count alone lets it move, down and up, to within a factor
    /// of 1.25; `None` if it never changes within reach.
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

/// Number of counts that come out on a lattice in the plane of two values.
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

/// Maps the neighbourhood of the f with these `values` on the pieces of the evaluator's first geometry.
///
/// # Panics
/// If there is not one value per piece.
pub fn identifiability(evaluator: &Evaluator<'_>, values: &[f64]) -> Identifiability {
    let held = |all: &[Vec<f64>]| evaluator.held(0, all);
    let here = held(&[values.to_vec()]).remove(0);
    let size = largest(values);
    let pieces = (0..values.len()).map(Some).chain([None]);
    let directions = pieces.map(|piece| Direction { piece, values, size }).collect::<Vec<_>>();
    let directions = along(&directions, &here, &held);
    Identifiability { values: values.to_vec(), exact: count(&here), directions }
}

/// One value, or the factor of all, that moves.
struct Direction<'a> {
    piece: Option<usize>,
    values: &'a [f64],
    /// The largest value of f.
    size: f64,
}

impl Direction<'_> {
    /// What a relative move of one is.
    fn unit(&self) -> f64 {
        if self.piece.is_some() { self.size } else { 1.0 }
    }

    fn moved(&self, by: f64) -> Vec<f64> {
        let mut moved = self.values.to_vec();
        match self.piece {
            Some(p) => moved[p] += by,
            None => moved.iter_mut().for_each(|v| *v *= 1.0 + by),
        }
        moved
    }
}

/// The counts that come out for many f at once.
type Tried<'a> = &'a dyn Fn(&[Vec<f64>]) -> Vec<Held>;

/// How many counts come out.
fn count(held: &[Vec<bool>]) -> usize {
    held.iter().flatten().filter(|&&held| held).count()
}

/// One side of a direction on which a count changes.
struct Side {
    direction: usize,
    /// 0 for down, 1 for up.
    side: usize,
    /// The longest move known to change no count, and the shortest known to change one.
    between: [f64; 2],
}

/// Up or down.
fn sign(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

/// The counts that come out here, of which moves may change some.
struct Kept<'a> {
    directions: &'a [Direction<'a>],
    cells: Vec<Cell>,
}

impl Kept<'_> {
    fn broken(&self, held: &[Vec<bool>]) -> Option<Cell> {
        self.cells.iter().copied().find(|&(k, level)| !held[k][level])
    }

    fn moved(&self, direction: usize, side: usize, step: f64) -> Vec<f64> {
        let direction = &self.directions[direction];
        direction.moved(sign(side) * step * direction.unit())
    }

    /// Tries the same moves in all directions; writes down which counts they change, and returns the sides on
    /// which one does.
    fn scan(&self, breaks: &mut [Breaks], held: Tried) -> Vec<Side> {
        let steps: Vec<f64> = std::iter::successors(Some(REACH[0]), |step| Some(step * RATIO))
            .take_while(|step| *step <= REACH[1])
            .collect();
        let sides = || (0..self.directions.len()).flat_map(|d| [(d, 0), (d, 1)]);
        let moves = sides().flat_map(|(d, side)| steps.iter().map(move |&step| (d, side, step)));
        let tried: Vec<_> = moves.map(|(d, side, step)| self.moved(d, side, step)).collect();
        let found = held(&tried);
        let mut open = Vec::new();
        for ((d, side), found) in sides().zip(found.chunks(steps.len())) {
            let (breaks, mut before) = (&mut breaks[d], 0.0);
            for (now, &step) in found.iter().zip(&steps) {
                if breaks.first[side].is_none()
                    && let Some(cell) = self.broken(now)
                {
                    breaks.first[side] = Some(cell);
                    open.push(Side { direction: d, side, between: [before, step] });
                }
                for &(k, level) in &self.cells {
                    let range = &mut breaks.cells[k][level][side];
                    if range.is_none() && !now[k][level] {
                        *range = Some(before * self.directions[d].unit());
                    }
                }
                before = step;
            }
        }
        open
    }

    /// Halves what is left between moves that change no count and those that do, on all sides at once.
    fn halve(&self, open: &mut [Side], breaks: &mut [Breaks], held: Tried) {
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        for _ in 0..HALVINGS {
            let tried: Vec<_> = open
                .iter()
                .map(|of| self.moved(of.direction, of.side, middle(of.between)))
                .collect();
            for (of, found) in open.iter_mut().zip(held(&tried)) {
                let middle = middle(of.between);
                match self.broken(&found) {
                    Some(cell) => {
                        of.between[1] = middle;
                        breaks[of.direction].first[of.side] = Some(cell);
                    }
                    None => of.between[0] = middle,
                }
            }
        }
    }
}

/// All directions at once, down and up.
fn along(directions: &[Direction], here: &[Vec<bool>], held: Tried) -> Vec<Breaks> {
    let cells = (0..here.len()).flat_map(|k| (0..here[k].len()).map(move |level| (k, level)));
    let kept = Kept { directions, cells: cells.filter(|&(k, level)| here[k][level]).collect() };
    let nothing = |direction: &Direction| Breaks {
        piece: direction.piece,
        range: [REACH[1] * direction.unit(); 2],
        first: [None; 2],
        cells: here.iter().map(|row| vec![[None; 2]; row.len()]).collect(),
    };
    let mut breaks: Vec<Breaks> = directions.iter().map(nothing).collect();
    let mut open = kept.scan(&mut breaks, held);
    kept.halve(&mut open, &mut breaks, held);
    for Side { direction, side, between } in open {
        breaks[direction].range[side] = between[0] * directions[direction].unit();
    }
    breaks
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
    let counts: Vec<usize> = evaluator.held(0, &all).iter().map(|held| count(held)).collect();
    let exact = counts.chunks(points.max(1)).map(<[usize]>::to_vec).collect();
    Slice { pieces, x, y, exact }
}
