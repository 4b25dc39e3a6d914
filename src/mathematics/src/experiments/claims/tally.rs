//! Number of cases in which a claim holds, and the verdict that follows.

use serde::{Deserialize, Serialize};

/// Counts that differ by less than this factor count as equal.
pub(super) const EQUAL: f64 = 1.1;

/// Verdict of the measurement on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// The claim holds in all cases.
    Confirmed,
    /// The claim holds in some cases.
    Partly,
    /// The claim holds in no case.
    Refuted,
}

/// Number of cases in which a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimTally {
    /// Cases in which the claim holds.
    pub holds: usize,
    /// All cases.
    pub cases: usize,
    /// Verdict on the claim.
    pub verdict: ClaimVerdict,
}

impl ClaimTally {
    pub(super) fn of(cases: impl IntoIterator<Item = bool>) -> Self {
        let (mut holds, mut all) = (0, 0);
        for case in cases {
            holds += usize::from(case);
            all += 1;
        }
        let verdict = match holds {
            0 => ClaimVerdict::Refuted,
            _ if holds == all => ClaimVerdict::Confirmed,
            _ => ClaimVerdict::Partly,
        };
        Self { holds, cases: all, verdict }
    }
}
