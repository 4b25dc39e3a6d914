//! Warnings of an answer, and the advice that mends all that they warn of.

/// A doubt about an answer, or the reason why it is none, with advice.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Warning {
    /// Sentence without the advice.
    pub fact: String,
    /// Empty where nothing can be done.
    pub remedies: Vec<Remedy>,
}

/// Advice to a user.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Remedy {
    /// Advice in words.
    pub words: String,
    /// Options or keys that follow it, to be added to what was asked; empty if there are none.
    pub options: String,
}

impl Remedy {
    pub(crate) fn new(words: impl Into<String>, options: impl Into<String>) -> Self {
        Self { words: words.into(), options: options.into() }
    }

    /// Advice without an option.
    pub(crate) fn of_words(words: impl Into<String>) -> Self {
        Self::new(words, "")
    }
}

impl Warning {
    pub(crate) fn new(fact: String, remedy: Remedy) -> Self {
        Self { fact, remedies: vec![remedy] }
    }

    /// Warning without advice.
    pub(crate) fn fact(fact: String) -> Self {
        Self { fact, remedies: Vec::new() }
    }

    /// Returns the warning in a sentence, with the advice.
    pub(crate) fn sentence(&self) -> String {
        match &self.remedies[..] {
            [] => self.fact.clone(),
            remedies => format!("{}; {}", self.fact, combined(remedies)),
        }
    }
}

/// Returns the warnings a line each; where several have a remedy, the last line has one remedy for all. If the answer
/// has `failed`, the error has the remedy.
pub(crate) fn lines(warnings: &[Warning], failed: bool) -> String {
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
pub(crate) fn remedies(warnings: &[Warning]) -> Vec<Remedy> {
    warnings.iter().flat_map(|warning| warning.remedies.clone()).collect()
}

/// Returns one remedy in place of several: all options that they give, each once; then, in words, those without.
pub(crate) fn combined(remedies: &[Remedy]) -> String {
    let (mut options, mut words): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for remedy in remedies {
        let (list, text) = match &*remedy.options {
            "" => (&mut words, &*remedy.words),
            options_of => (&mut options, options_of),
        };
        if !list.contains(&text) {
            list.push(text);
        }
    }
    match remedies {
        [first, others @ ..] if others.iter().all(|other| other == first) => first.words.clone(),
        _ if options.is_empty() => words.join("; "),
        _ => {
            // The load before the solver, as in the help.
            options.sort_unstable();
            words.insert(0, "");
            // Keys have values with spaces.
            let between = if options[0].starts_with("--") { " " } else { ", " };
            format!("use {}{}", options.join(between), words.join("; "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_remedies_become_one_line_with_all_options() {
        let load = || Remedy::new("use --load exact", "--load exact");
        let solver = || Remedy::new("use this, or --solver multigrid", "--solver multigrid");
        let finer = Remedy::of_words("refine the grid");
        assert_eq!(combined(&[solver(), solver()]), "use this, or --solver multigrid");
        assert_eq!(combined(&[solver(), load(), solver()]), "use --load exact --solver multigrid");
        assert_eq!(combined(&[finer, load()]), "use --load exact; refine the grid");
        let warnings = [Warning::new("a".into(), solver()), Warning::fact("b".into())];
        assert_eq!(
            lines(&warnings, false),
            "warning: a; use this, or --solver multigrid\nwarning: b\n"
        );
        let more = [Warning::new("c".into(), load()), Warning::fact("d".into())];
        let warnings: Vec<_> = warnings.into_iter().chain(more).collect();
        let remedy = "remedy for all: use --load exact --solver multigrid\n";
        assert_eq!(
            lines(&warnings, false),
            format!("warning: a\nwarning: b\nwarning: c\nwarning: d\n{remedy}")
        );
        assert_eq!(lines(&warnings[..1], true), "warning: a\n");
    }
}
