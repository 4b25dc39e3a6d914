//! Results of a search as tables to read.

use super::{Answer, Reading};
use crate::cli::output::styled;
use crate::table::Table;
use anstyle::AnsiColor;
use signorini_mathematics::identify::{Found, SearchReport};

pub(super) const LEGEND: &str = "
counts      published counts that come out exactly
Delta a     values that agree to the two printed digits
integral    of f over the square; (2) asks for less than zero
";

/// The f on record and the f found for one table.
pub(super) fn found(answer: &Answer) -> String {
    let report = &answer.report;
    let head = styled(&format!("Problem {}", answer.problem), AnsiColor::Cyan);
    let mut out = format!("{head}\n");
    if !answer.recorded.is_empty() {
        out += &format!("on record\n{}\n", table(&answer.recorded));
    }
    out += &format!("{} candidates tried", report.tried);
    for (level, runs) in report.reached.iter().enumerate().skip(1) {
        out += &format!(", {runs} reach grid {}", level + 1);
    }
    out += if report.complete { "\n" } else { "; stopped early\n" };
    if report.found.is_empty() {
        return out + "none gives all counts; give --values a wider range, or a smaller step\n";
    }
    out + &table(&report.found)
}

fn table(all: &[Found]) -> String {
    let mut table = Table::new(["counts", "Delta a", "integral", "f"], &[3]);
    for Found { f, integral, exact, cells, delta_a, delta_a_exact } in all {
        table.rows.push(vec![
            format!("{exact}/{cells}"),
            format!("{delta_a_exact}/{}", delta_a.len()),
            // No negative zero, from rounding or not.
            format!("{:.4}", if integral.abs() < 5e-5 { 0.0 } else { *integral }),
            f.clone(),
        ]);
    }
    table.text()
}

/// Extent of the search under each reading of the method.
pub(super) fn readings(all: &[Reading], numbers: &[u8]) -> String {
    let problems = numbers.iter().map(|n| format!("problem {n}"));
    let head = problems.chain(["reading of the method".to_owned()]);
    let mut table = Table::new(head, &[numbers.len()]);
    for Reading { searches, description, .. } in all {
        table.rows.push(searches.iter().map(extent).chain([description.clone()]).collect());
    }
    table.text()
        + "per problem: number of f with all counts on all grids, or else on the most grids\n"
}

/// The number of f with all counts, on all grids or on as many as there are such f for.
fn extent(report: &SearchReport) -> String {
    if report.exact > 0 {
        return format!("{} on all grids", report.exact);
    }
    let reached = report.reached.iter().enumerate().skip(1).rfind(|(_, reached)| **reached > 0);
    match reached {
        Some((grids, reached)) => format!("{reached} on {grids} of {} grids", report.reached.len()),
        None => "none on any grid".into(),
    }
}
