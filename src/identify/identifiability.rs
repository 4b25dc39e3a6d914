//! How sharply a table fixes f: how far each value moves before a count changes, and which one does.

use super::IdentifyError;
use super::Target;
use super::evaluate::Evaluator;
use super::space::Geometry;
use super::variant::Variant;
use serde::{Deserialize, Serialize};

/// Per row and grid, how far a published count is from coming out.
type Misfit = Vec<Vec<f64>>;

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
    let evaluator = Evaluator::new(target, variant, std::slice::from_ref(geometry))?;
    let misfits = |all: &[Vec<f64>]| evaluator.misfits(0, all);
    let here = misfits(&[values.to_vec()]).remove(0);
    let size = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let pieces = (0..values.len()).map(Some).chain([None]);
    let directions = pieces.map(|piece| Direction { piece, values, size }).collect::<Vec<_>>();
    let exact = here.iter().flatten().filter(|&&m| m == 0.0).count();
    let directions = along(&directions, &here, &misfits);
    Ok(Identifiability { values: values.to_vec(), exact, directions })
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

/// All directions at once, down and up: first the same moves in all, then the halvings, step by step.
fn along(
    directions: &[Direction],
    here: &[Vec<f64>],
    misfits: &dyn Fn(&[Vec<f64>]) -> Vec<Misfit>,
) -> Vec<Breaks> {
    let held = |m: &[Vec<f64>], (k, level): Cell| m[k][level] == 0.0;
    let all: Vec<Cell> = (0..here.len())
        .flat_map(|k| (0..here[k].len()).map(move |level| (k, level)))
        .filter(|&cell| held(here, cell))
        .collect();
    let broken = |m: &[Vec<f64>]| all.iter().copied().find(|&cell| !held(m, cell));
    let sides = || directions.iter().enumerate().flat_map(|(d, _)| [(d, 0, -1.0), (d, 1, 1.0)]);
    let moves = || {
        std::iter::successors(Some(REACH[0]), |step| Some(step * RATIO))
            .take_while(|step| *step <= REACH[1])
    };
    let moved =
        |d: usize, sign: f64, step: f64| directions[d].moved(sign * step * directions[d].unit());
    let tried: Vec<_> =
        sides().flat_map(|(d, _, sign)| moves().map(move |step| (d, sign, step))).collect();
    let tried: Vec<_> = tried.into_iter().map(|(d, sign, step)| moved(d, sign, step)).collect();
    let found = misfits(&tried);
    let mut breaks: Vec<Breaks> = directions
        .iter()
        .map(|direction| Breaks {
            piece: direction.piece,
            room: [REACH[1] * direction.unit(); 2],
            first: [None; 2],
            cells: here.iter().map(|row| vec![[None; 2]; row.len()]).collect(),
        })
        .collect();
    // The sides on which a count changes, each with the last move before and the first one after.
    let mut open = Vec::new();
    for ((d, side, sign), found) in sides().zip(found.chunks(moves().count())) {
        let (breaks, mut before) = (&mut breaks[d], 0.0);
        for (now, step) in found.iter().zip(moves()) {
            if breaks.first[side].is_none()
                && let Some(cell) = broken(now)
            {
                breaks.first[side] = Some(cell);
                open.push((d, side, sign, before, step));
            }
            for &(k, level) in &all {
                let room = &mut breaks.cells[k][level][side];
                if room.is_none() && !held(now, (k, level)) {
                    *room = Some(before * directions[d].unit());
                }
            }
            before = step;
        }
    }
    for _ in 0..HALVINGS {
        let middles: Vec<_> = open
            .iter()
            .map(|&(d, _, sign, low, high)| moved(d, sign, 0.5 * (low + high)))
            .collect();
        for ((d, side, _, low, high), found) in open.iter_mut().zip(misfits(&middles)) {
            let middle = 0.5 * (*low + *high);
            match broken(&found) {
                Some(cell) => (*high, breaks[*d].first[*side]) = (middle, Some(cell)),
                None => *low = middle,
            }
        }
    }
    for (d, side, _, low, _) in open {
        breaks[d].room[side] = low * directions[d].unit();
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
    let evaluator = Evaluator::new(target, variant, std::slice::from_ref(geometry))?;
    let axis = |k: usize| -> Vec<f64> {
        let (middle, reach) = (values[pieces[k]], reach[k]);
        let step = 2.0 * reach / points.saturating_sub(1).max(1) as f64;
        (0..points).map(|i| middle - reach + step * i as f64).collect()
    };
    let (x, y) = (axis(0), axis(1));
    let moved = |v: f64, u: f64| {
        let mut moved = values.to_vec();
        moved[pieces[1]] = v;
        moved[pieces[0]] = u;
        moved
    };
    let all: Vec<_> = y.iter().flat_map(|&v| x.iter().map(move |&u| (v, u))).collect();
    let all: Vec<_> = all.into_iter().map(|(v, u)| moved(v, u)).collect();
    let count = |misfit: &Vec<Vec<f64>>| misfit.iter().flatten().filter(|&&m| m == 0.0).count();
    let counts: Vec<usize> = evaluator.misfits(0, &all).iter().map(count).collect();
    let exact = counts.chunks(points.max(1)).map(<[usize]>::to_vec).collect();
    Ok(Slice { pieces, x, y, exact })
}
