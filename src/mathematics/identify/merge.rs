//! The report of a whole search, from the last states of its parts.

use super::plan::Plan;
use super::request::Request;
use super::search::{Checkpoint, Report};
use super::{IdentifyError, Target};

/// Merges the checkpoints of all parts of one search, in any order. The report is that of the whole
/// search, made at once, to the last bit.
///
/// # Errors
/// [`IdentifyError::Merge`] if they are of different searches, or a part is missing, there twice or
/// not at its end.
pub fn merge(parts: &[Checkpoint]) -> Result<(Target, Report), IdentifyError> {
    let refuse = |why: String| Err(IdentifyError::Merge(why));
    let whole = |state: &Checkpoint| Request { part: None, ..state.request.clone() };
    let Some(first) = parts.first() else { return refuse("no part is given".into()) };
    let (request, target) = (whole(first), first.target.clone());
    let Some(of) = first.request.part.map(|part| part.of) else {
        return refuse("a checkpoint is of no part; make one with --part K/N".into());
    };
    let mut there = Vec::new();
    let mut all = first.clone();
    for state in parts {
        let part = state.request.part.filter(|part| part.of == of);
        let (Some(part), true) = (part, whole(state) == request && state.target == target) else {
            return refuse("the checkpoints are of different searches; give those of one".into());
        };
        if state.next < Plan::new(&state.request, &target)?.items.end {
            return refuse(format!("part {part} is not at its end; repeat its command to go on"));
        }
        if there.contains(&part.number) {
            return refuse(format!("part {part} is given twice"));
        }
        if !there.is_empty() {
            all.best.merge(state.best.clone());
            all.tried += state.tried;
            all.entered.iter_mut().zip(&state.entered).for_each(|(sum, n)| *sum += n);
        }
        there.push(part.number);
    }
    if let Some(missing) = (1..=of).find(|number| !there.contains(number)) {
        return refuse(format!(
            "part {missing}/{of} is missing; make it with --part {missing}/{of}"
        ));
    }
    let found = Plan::new(&request, &target)?.explain(&all.best);
    let Checkpoint { tried, entered, .. } = all;
    Ok((target.clone(), Report { schema: 1, request, complete: true, tried, entered, found }))
}
