//! Sweeps of Uzawa's algorithm over those of Arrow-Hurwicz, to equal KKT residual.

use super::tally::{ClaimTally, EQUAL};
use super::{Count, Measured, UzawaCell, VARIANTS};
use crate::experiments::Range;
use serde::{Deserialize, Serialize};

/// Sweeps of a variant of Uzawa's algorithm over those of Arrow-Hurwicz, in the cells where the latter
/// converged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratios {
    /// Name of the variant.
    pub name: String,
    /// KKT residual over the largest component of F, if it is the same in all cells.
    pub target: Option<f64>,
    /// Duality parameter, if it is the same in all cells.
    pub r: Option<f64>,
    /// Cells in which Arrow-Hurwicz takes fewer sweeps.
    pub cheaper: ClaimTally,
    /// Cells in which the variant reached the limit of sweeps: their ratio is a lower bound.
    pub capped: usize,
    /// Median of the ratios; none without cells.
    pub median: Option<f64>,
    /// Range of the ratios; none without cells.
    pub range: Option<Range>,
}

/// Method that Arrow-Hurwicz is compared with.
#[derive(Clone, Copy)]
pub(super) enum Rival {
    /// Variant of Uzawa's algorithm with this index in [`VARIANTS`].
    Variant(usize),
    /// Best variant in each cell.
    Best,
}

/// Uzawa's algorithm with exact inner minimisation and without proximal term.
pub(super) const EXACT_INSIDE: Rival = Rival::Variant(0);
impl Rival {
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..VARIANTS.len()).map(Self::Variant).chain([Self::Best])
    }

    fn name(self) -> &'static str {
        match self {
            Self::Variant(k) => VARIANTS[k].name,
            Self::Best => "the best of these",
        }
    }
}

impl UzawaCell {
    /// Count of Arrow-Hurwicz's rival: in no case more than the limit of sweeps.
    fn count(&self, rival: Rival) -> Count {
        match rival {
            Rival::Variant(k) => self.uzawa[k],
            Rival::Best => {
                let counts = self.uzawa.into_iter();
                let best = counts.min_by_key(|count| (count.reached().is_none(), count.iterations));
                best.expect("there are variants")
            }
        }
    }

    /// Sweeps of the rival over those of Arrow-Hurwicz, if the latter converged.
    fn ratio(&self, rival: Rival) -> Option<f64> {
        Some(self.count(rival).iterations as f64 / self.arrow_hurwicz.reached()? as f64)
    }
}

impl Ratios {
    /// Takes the cells with this target and this r, if they are given.
    pub(super) fn of(
        rival: Rival,
        problems: &[Measured],
        target: Option<f64>,
        r: Option<f64>,
    ) -> Self {
        let (mut ratios, mut capped) = (Vec::new(), 0);
        for cell in problems.iter().flat_map(|problem| &problem.cells) {
            let wanted =
                target.is_none_or(|target| cell.target == target) && r.is_none_or(|r| cell.r == r);
            if let Some(ratio) = cell.ratio(rival).filter(|_| wanted) {
                ratios.push(ratio);
                capped += usize::from(cell.count(rival).reached().is_none());
            }
        }
        ratios.sort_by(f64::total_cmp);
        Self {
            name: rival.name().into(),
            target,
            r,
            cheaper: ClaimTally::of(ratios.iter().map(|ratio| *ratio > 1.0)),
            capped,
            median: median(&ratios),
            range: Range::of(ratios),
        }
    }
}

/// Values of r at which methods are compared, ascending.
pub(super) fn compared(problems: &[Measured]) -> Vec<f64> {
    let mut all: Vec<f64> = problems.iter().flat_map(|p| &p.cells).map(|cell| cell.r).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Groups of cells that differ in r only.
fn rows(problem: &Measured) -> impl Iterator<Item = &[UzawaCell]> {
    problem.cells.chunk_by(|a, b| a.cells == b.cells && a.target == b.target)
}

/// True, per grid and target, if the gain over exact inner minimisation varies with r.
pub(super) fn gain_depends_on_r(problem: &Measured) -> Vec<bool> {
    let mut all = Vec::new();
    for cells in rows(problem) {
        let range = Range::of(cells.iter().filter_map(|cell| cell.ratio(EXACT_INSIDE)));
        all.push(range.is_some_and(|range| range.greatest > EQUAL * range.least));
    }
    all
}

/// Median of sorted numbers: of an even number, the mean of the two in the middle; none of none.
fn median(sorted: &[f64]) -> Option<f64> {
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(f64::midpoint(sorted[middle - 1], sorted[middle])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        assert_eq!(median(&[1.0, 2.0, 4.0]), Some(2.0));
        assert_eq!(median(&[1.0, 2.0, 4.0, 8.0]), Some(3.0));
        assert_eq!(median(&[]), None);
    }
}
