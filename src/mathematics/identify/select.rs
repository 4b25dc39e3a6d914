//! Model selection: the same search under every reading of the method, for every table.

use super::rank::Found;
use super::request::Request;
use super::search::{Budget, Report, search};
use super::variant::Variant;
use super::{IdentifyError, Target};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};

/// The best a variant can do for each table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Selection {
    /// Reading of the method.
    pub variant: Variant,
    /// The same in words.
    pub description: String,
    /// First candidate of the search per table, in the order of the targets; `None` if the search was stopped before
    /// it had one.
    pub best: Vec<Option<Found>>,
    /// Candidates tried.
    pub tried: u64,
}

impl Selection {
    /// Sum of the objectives over the tables: one variant must explain all of them.
    pub fn total(&self) -> f64 {
        let one = |best: &Option<Found>| best.as_ref().map_or(f64::INFINITY, |f| f.score.total());
        self.best.iter().map(one).sum()
    }
}

/// Repeats each request under each variant; the best variant comes first.
///
/// `tables` pairs every target with a request, whose own variant is not used. `observe` is called
/// after each variant. Setting `stop` cuts the search under way short and leaves out the variants not yet tried.
///
/// # Errors
/// [`IdentifyError`] if a request makes no sense.
pub fn select(
    variants: &[Variant],
    tables: &[(Target, Request)],
    budget: Budget,
    stop: &AtomicBool,
    observe: &mut dyn FnMut(&Selection),
) -> Result<Vec<Selection>, IdentifyError> {
    let mut all = Vec::new();
    for &variant in variants {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let mut selection =
            Selection { variant, description: variant.to_string(), best: Vec::new(), tried: 0 };
        for (target, request) in tables {
            let request = Request { variant, top: 1, ..request.clone() };
            let report = search(&request, target, budget, None, stop, &mut |_, _| ())?;
            let Report { found, tried, .. } = report;
            selection.best.push(found.into_iter().next());
            selection.tried += tried;
        }
        observe(&selection);
        all.push(selection);
    }
    all.sort_by(|a, b| a.total().total_cmp(&b.total()));
    Ok(all)
}
