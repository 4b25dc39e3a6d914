//! How sharply a table fixes f: how far each value moves before a count changes, and which one does.

use super::IdentifyError;
use super::Target;
use super::evaluate::{Evaluator, Limit};
use super::space::Geometry;
use super::variant::Variant;
use serde::{Deserialize, Serialize};

/// Smallest and largest move tried, relative to the largest value of f.
const REACH: [f64; 2] = [1e-5, 1.0];
/// Ratio of one move to the next, hence the resolution of what single cells allow.
const RATIO: f64 = 1.25;
/// Halvings that refine the first break of a direction.
const HALVINGS: usize = 10;

/// A count of the table: row and grid, both counted from 0.
pub type Cell = (usize, usize);

/// What happens along one direction in the space of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Breaks {
    /// Piece whose value moves; `None` if all are multiplied by one factor.
    pub piece: Option<usize>,
    /// How far the value, or the factor from 1, may move down and up with every count that came
    /// out still coming out. The set of such f need not be convex: this is the part around f.
    pub room: [f64; 2],
    /// Count that changes first, down and up; `None` if none did within reach.
    pub first: [Option<Cell>; 2],
    /// `cells[k][level]`: the room that this count alone leaves, down and up, to within a factor
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
    /// `exact[j][i]`: counts that come out at (x[i], y[j]).
    pub exact: Vec<Vec<usize>>,
}

/// Maps the neighbourhood of the f with these `values` on the pieces of `geometry`.
///
/// # Errors
/// [`IdentifyError`] if the target is not a table.
///
/// # Panics
/// If there is not one value per piece.
pub fn identifiability(
    target: &Target,
    variant: &Variant,
    geometry: &Geometry,
    values: &[f64],
) -> Result<Identifiability, IdentifyError> {
    let mut evaluator = Evaluator::new(target, variant, std::slice::from_ref(geometry))?;
    let here = evaluator.forced(0, values, Limit::NONE).misfit;
    let size = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let pieces = (0..values.len()).map(Some).chain([None]);
    let directions = pieces
        .map(|piece| {
            let unit = if piece.is_some() { size } else { 1.0 };
            let mut misfit = |by: f64| {
                let mut moved = values.to_vec();
                match piece {
                    Some(p) => moved[p] += by,
                    None => moved.iter_mut().for_each(|v| *v *= 1.0 + by),
                }
                evaluator.forced(0, &moved, Limit::NONE).misfit
            };
            along(piece, unit, &here, &mut misfit)
        })
        .collect();
    let exact = here.iter().flatten().filter(|&&m| m == 0.0).count();
    Ok(Identifiability { values: values.to_vec(), exact, directions })
}

fn along(
    piece: Option<usize>,
    unit: f64,
    here: &[Vec<f64>],
    misfit: &mut dyn FnMut(f64) -> Vec<Vec<f64>>,
) -> Breaks {
    let rows = here.len();
    let held = |m: &[Vec<f64>], (k, level): Cell| m[k][level] == 0.0;
    let all: Vec<Cell> = (0..rows)
        .flat_map(|k| (0..here[k].len()).map(move |level| (k, level)))
        .filter(|&cell| held(here, cell))
        .collect();
    let mut breaks = Breaks {
        piece,
        room: [REACH[1] * unit; 2],
        first: [None; 2],
        cells: here.iter().map(|row| vec![[None; 2]; row.len()]).collect(),
    };
    for (side, sign) in [(0, -1.0), (1, 1.0)] {
        let (mut before, mut step) = (0.0, REACH[0]);
        while step <= REACH[1] {
            let now = misfit(sign * step * unit);
            let broken = |m: &[Vec<f64>]| all.iter().copied().find(|&cell| !held(m, cell));
            if let (None, Some(mut cell)) = (breaks.first[side], broken(&now)) {
                let (mut low, mut high) = (before, step);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    match broken(&misfit(sign * middle * unit)) {
                        Some(first) => (high, cell) = (middle, first),
                        None => low = middle,
                    }
                }
                breaks.first[side] = Some(cell);
                breaks.room[side] = low * unit;
            }
            for &(k, level) in &all {
                let room = &mut breaks.cells[k][level][side];
                if room.is_none() && !held(&now, (k, level)) {
                    *room = Some(before * unit);
                }
            }
            (before, step) = (step, step * RATIO);
        }
    }
    breaks
}

/// Counts that come out when the values of two pieces vary by up to `reach`, each its own, either way.
///
/// # Errors
/// [`IdentifyError`] if the target is not a table.
///
/// # Panics
/// If a piece does not exist.
pub fn slice(
    target: &Target,
    variant: &Variant,
    geometry: &Geometry,
    values: &[f64],
    pieces: [usize; 2],
    reach: [f64; 2],
    points: usize,
) -> Result<Slice, IdentifyError> {
    use rayon::prelude::*;
    let evaluator = Evaluator::new(target, variant, std::slice::from_ref(geometry))?;
    let axis = |k: usize| -> Vec<f64> {
        let (middle, reach) = (values[pieces[k]], reach[k]);
        let step = 2.0 * reach / points.saturating_sub(1).max(1) as f64;
        (0..points).map(|i| middle - reach + step * i as f64).collect()
    };
    let (x, y) = (axis(0), axis(1));
    let row = |evaluator: &mut Evaluator<'_>, &v: &f64| -> Vec<usize> {
        let mut moved = values.to_vec();
        moved[pieces[1]] = v;
        let mut count = |&u: &f64| {
            moved[pieces[0]] = u;
            let misfit = evaluator.forced(0, &moved, Limit::NONE).misfit;
            misfit.iter().flatten().filter(|&&m| m == 0.0).count()
        };
        x.iter().map(&mut count).collect()
    };
    let exact = y.par_iter().map_init(|| evaluator.clone(), row).collect();
    Ok(Slice { pieces, x, y, exact })
}
