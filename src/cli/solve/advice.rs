//! Warnings of an answer, and the advice that mends all that they warn of.

/// A doubt about an answer, or the reason why it is none, with advice.
pub(super) struct Warning {
    /// Sentence without the advice.
    pub fact: String,
    /// Empty where nothing can be done.
    pub remedies: Vec<Remedy>,
}

/// Advice to a user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remedy {
    /// Advice in words.
    pub words: &'static str,
    /// Options that follow it, to be added to the command; empty if there are none.
    pub options: &'static str,
}

impl Remedy {
    pub(super) const fn new(words: &'static str, options: &'static str) -> Self {
        Self { words, options }
    }
}

impl Warning {
    pub(super) fn new(fact: String, remedy: Remedy) -> Self {
        Self { fact, remedies: vec![remedy] }
    }

    /// Warning without advice.
    pub(super) fn fact(fact: String) -> Self {
        Self { fact, remedies: Vec::new() }
    }

    /// Returns the warning in a sentence, with the advice.
    pub(super) fn sentence(&self) -> String {
        match &self.remedies[..] {
            [] => self.fact.clone(),
            remedies => format!("{}; {}", self.fact, combined(remedies)),
        }
    }
}

/// Returns the warnings a line each; where several have a remedy, the last line has one remedy for all. If the answer
/// has `failed`, the error has the remedy.
pub(super) fn lines(warnings: &[Warning], failed: bool) -> String {
    let remedies = remedies(warnings);
    let (alone, mut text) = (remedies.len() < 2 && !failed, String::new());
    for warning in warnings {
        let shown = if alone { warning.sentence() } else { warning.fact.clone() };
        text += &format!("warning: {shown}\n");
    }
    if !alone && !failed {
        text += &format!("remedy for all: {}\n", combined(&remedies));
    }
    text
}

/// Returns the remedies of warnings, in their order.
pub(super) fn remedies(warnings: &[Warning]) -> Vec<Remedy> {
    warnings.iter().flat_map(|warning| warning.remedies.clone()).collect()
}

/// Returns one remedy in place of several: all options that they give, each once; then, in words, those without.
pub(super) fn combined(remedies: &[Remedy]) -> String {
    let (mut options, mut words) = (Vec::new(), Vec::new());
    for remedy in remedies {
        let (list, text) = match remedy.options {
            "" => (&mut words, remedy.words),
            options_of => (&mut options, options_of),
        };
        if !list.contains(&text) {
            list.push(text);
        }
    }
    match remedies {
        [first, others @ ..] if others.iter().all(|other| other == first) => first.words.into(),
        _ if options.is_empty() => words.join("; "),
        _ => {
            // The load before the solver, as in the help.
            options.sort_unstable();
            words.insert(0, "");
            format!("use {}{}", options.join(" "), words.join("; "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: Remedy = Remedy::new("use --load exact", "--load exact");
    const SOLVER: Remedy = Remedy::new("use this, or --solver multigrid", "--solver multigrid");
    const FINER: Remedy = Remedy::new("refine the grid", "");

    #[test]
    fn several_remedies_become_one_line_with_all_options() {
        assert_eq!(combined(&[SOLVER, SOLVER]), "use this, or --solver multigrid");
        assert_eq!(combined(&[SOLVER, LOAD, SOLVER]), "use --load exact --solver multigrid");
        assert_eq!(combined(&[FINER, LOAD]), "use --load exact; refine the grid");
        let warnings = [Warning::new("a".into(), SOLVER), Warning::fact("b".into())];
        assert_eq!(
            lines(&warnings, false),
            "warning: a; use this, or --solver multigrid\nwarning: b\n"
        );
        let more = [Warning::new("c".into(), LOAD), Warning::fact("d".into())];
        let warnings: Vec<_> = warnings.into_iter().chain(more).collect();
        let remedy = "remedy for all: use --load exact --solver multigrid\n";
        assert_eq!(
            lines(&warnings, false),
            format!("warning: a\nwarning: b\nwarning: c\nwarning: d\n{remedy}")
        );
        assert_eq!(lines(&warnings[..1], true), "warning: a\n");
    }
}
