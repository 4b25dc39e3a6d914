//! Results of a search as tables to read.

use super::{Answer, Selection};
use crate::cli::output::{columns, styled};
use anstyle::AnsiColor;
use signorini_mathematics::identify::{Found, Target, agrees};

pub(super) const LEGEND: &str = "
counts      published counts that come out exactly
misfit      how far the others are from coming out, in logarithms of the stopping measure
Delta a     values that agree to the two printed digits
complexity  distinct values of f and their decimal places
integral    of f over the square; (2) asks for less than zero
";

/// The ranking for one table, and the best candidate's own table.
pub(super) fn found(answer: &Answer) -> String {
    let report = &answer.report;
    let head = styled(&format!("Problem {}", answer.problem), AnsiColor::Cyan);
    let mut out = format!("{head}: {} candidates tried", report.tried);
    for (level, runs) in report.entered.iter().enumerate().skip(1) {
        out += &format!(", {runs} on grid {}", level + 1);
    }
    out += if report.complete { "\n" } else { "; stopped early\n" };
    if report.found.is_empty() {
        return out + "nothing found; widen --values, or lower --exact-grids\n";
    }
    let rows =
        report.found.iter().enumerate().map(|(k, Found { score, integral, delta_a, f, .. })| {
            vec![
                (k + 1).to_string(),
                format!("{}/{}", score.exact, score.cells),
                format!("{:.3}", score.misfit),
                format!("{}/{}", score.delta_a_exact, delta_a.len()),
                score.complexity.to_string(),
                format!("{:.3}", score.total()),
                // No negative zero, from rounding or not.
                format!("{:.4}", if integral.abs() < 5e-5 { 0.0 } else { *integral }),
                f.clone(),
            ]
        });
    let head = ["rank", "counts", "misfit", "Delta a", "complexity", "total", "integral", "f"];
    out += &columns(&head, &[head.len() - 1], rows.collect());
    out += "the first one's table, with the published value where it differs:\n";
    out + &own(&report.found[0], &answer.target)
}

fn own(found: &Found, target: &Target) -> String {
    let row = |(k, r): (usize, &f64)| {
        let mut row = vec![r.to_string()];
        row.extend(found.counts[k].iter().zip(&target.counts[k]).map(
            |(ours, &published)| match ours {
                Some(n) if *n == published => n.to_string(),
                Some(n) => format!("{n} ({published})"),
                None => format!("- ({published})"),
            },
        ));
        let (ours, published) = (found.delta_a[k], target.delta_a[k]);
        row.push(match agrees(ours, published) {
            true => format!("{ours:.2e}"),
            false => format!("{ours:.2e} ({published:.1e})"),
        });
        row
    };
    let rows: Vec<_> = target.r.iter().enumerate().map(row).collect();
    let last = rows.first().map_or(0, |row| row.len() - 1);
    columns(&[], &[last], rows)
}

/// A variant and its best candidates.
pub(super) fn one_line(selection: &Selection) -> String {
    let best = selection.best.iter().map(|best| match best {
        Some(Found { score, .. }) => {
            format!("{}/{}, misfit {:.2}", score.exact, score.cells, score.misfit)
        }
        None => "nothing".into(),
    });
    format!("{}: {}", selection.description, best.collect::<Vec<_>>().join("; "))
}

pub(super) fn selection(all: &[Selection], numbers: &[u8]) -> String {
    let best = |best: &Option<Found>| match best {
        Some(Found { score, .. }) => format!(
            "{}/{} misfit {:.2} {}",
            score.exact, score.cells, score.misfit, score.delta_a_exact
        ),
        None => "nothing".into(),
    };
    let rows = all.iter().map(|one| {
        let total = std::iter::once(format!("{:.2}", one.total()));
        total.chain(one.best.iter().map(best)).chain([one.description.clone()]).collect()
    });
    let problems: Vec<String> = numbers.iter().map(|n| format!("problem {n}")).collect();
    let mut head = vec!["total"];
    head.extend(problems.iter().map(String::as_str));
    head.push("reading of the method");
    columns(&head, &[head.len() - 1], rows.collect())
        + "per problem: counts exact, misfit, values of Delta a to the two printed digits\n"
}
