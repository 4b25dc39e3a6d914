//! `certificate.md`: one page to attach to a review.

use super::{AUTHOR, COMMANDS, COMPILER, Check, TITLE};
use crate::replication::paper::{RowComparison, TableComparison};

/// The page.
pub(super) fn page(check: &Check) -> String {
    let mut out = format!(
        "# Certificate of reproduction\n\n{AUTHOR}, *{TITLE}*\n\n\
        Checked {} UTC by {} with signorini {}{}.\n\n{}\n\n",
        check.time,
        check.codechecker,
        env!("CARGO_PKG_VERSION"),
        check.commit.as_ref().map(|c| format!(", commit {c}")).unwrap_or_default(),
        summary(check)
    );
    out += "## Tables\n\n| | counts exact | counts within tolerance | Δa to the printed digits | Δa within tolerance |\n\
        |---|---:|---:|---:|---:|\n";
    for table in &check.tables {
        let (cells, rows) = (table.cells, table.rows.len());
        out += &format!(
            "| Table {} (`{}`) | {} of {cells} | {} of {cells} | {} of {rows} | {} of {rows} |\n",
            table.table,
            table.scene,
            table.exact,
            table.within_tolerance,
            table.delta_a_exact,
            table.delta_a_within
        );
    }
    let differing: String = check.tables.iter().flat_map(differing).collect();
    if differing.is_empty() {
        out += "\nNo cell differs from the print.\n\n";
    } else {
        out += "\nCells that differ from the print:\n\n\
            | cell | paper | ours | verdict |\n|---|---:|---:|---|\n";
        out += &differing;
        out.push('\n');
    }
    if let Some(first) = check.tables.first() {
        out += &format!("Declared tolerance: {}.", first.tolerance);
    }
    for reason in &check.reservations {
        out += &format!(" {reason}");
    }
    out += "\n\n## Files\n\n| file | shows | blake3 |\n|---|---|---|\n";
    for file in &check.files {
        out += &format!("| `{}` | {} | `{}` |\n", file.path, cell(&file.comment), file.hash);
    }
    out += "\n## Inputs\n\n| file | blake3 |\n|---|---|\n";
    for (name, hash) in &check.inputs {
        out += &format!("| `{name}` | `{hash}` |\n");
    }
    out += &format!(
        "\n## The run\n\nAll {} tasks are up to date: their inputs have today's hashes, and their artifacts were read \
        and hashed again. All {} hashes of tasks and of exported files agree with `pipeline/lock.toml` (blake3 `{}`){}.\n\n",
        check.tasks,
        check.hashes,
        check.lock_hash,
        match check.lock_is_committed {
            Some(true) =>
                ", which is the committed one: this run is identical to the authors' to the bit",
            Some(false) =>
                ", which is **not** the committed one: `git diff pipeline/lock.toml` shows what differs",
            None => "",
        }
    );
    out += "| command | does |\n|---|---|\n";
    for (command, does) in COMMANDS {
        out += &format!("| `{command}` | {does} |\n");
    }
    out += "\n| | |\n|---|---|\n";
    for (name, value) in &check.machine {
        out += &format!("| {name} | {} |\n", cell(value));
    }
    out += &format!("| compiler | {COMPILER} |\n");
    let libraries: Vec<_> = check.libraries.iter().map(|(n, v)| format!("{n} {v}")).collect();
    out + &format!("| libraries | {} |\n", libraries.join(", "))
}

/// What matched, in one sentence per table.
pub(super) fn summary(check: &Check) -> String {
    let sentence = |table: &TableComparison| {
        format!(
            "Table {}: {} of {} iteration counts come out exactly, {} of {} values of Delta a to the printed digits, and {}.",
            table.table,
            table.exact,
            table.cells,
            table.delta_a_exact,
            table.rows.len(),
            match table.cells - table.within_tolerance + table.rows.len() - table.delta_a_within {
                0 => "every value within the declared tolerance".to_owned(),
                1 => "one value is outside the declared tolerance".to_owned(),
                n => format!("{n} values are outside the declared tolerance"),
            }
        )
    };
    check.tables.iter().map(sentence).collect::<Vec<_>>().join(" ")
}

/// A line for each cell that is not as printed.
fn differing(table: &TableComparison) -> Vec<String> {
    let mut lines = Vec::new();
    let place = |row: &RowComparison| format!("Table {}, r = {}", table.table, row.r);
    for row in &table.rows {
        for (level, (ours, paper)) in row.ours.iter().zip(&row.paper).enumerate() {
            if ours != paper {
                let verdict = if row.within[level] { "within" } else { "**outside**" };
                let by = ours.abs_diff(*paper);
                lines.push(format!(
                    "| {}, grid {} | {paper} | {ours} | {verdict} tolerance: off by {by} |\n",
                    place(row),
                    level + 1
                ));
            }
        }
        if !row.delta_a_exact() {
            let verdict = if row.delta_a_within { "within" } else { "**outside**" };
            let ratio = row.delta_a_ours / row.delta_a_paper;
            lines.push(format!(
                "| {}, Δa | {:.1e} | {:.2e} | {verdict} tolerance: a factor of {:.2} |\n",
                place(row),
                row.delta_a_paper,
                row.delta_a_ours,
                ratio.max(1.0 / ratio)
            ));
        }
    }
    lines
}

/// Text that does not end the cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
