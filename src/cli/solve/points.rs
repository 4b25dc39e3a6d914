//! Points at which `solve` shows v and its gradient.

use crate::cli::output::in_columns;
use crate::pipeline::error::{Error, Result};
use crate::table::Table;
use clap::Args;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::PointValue;
use signorini_mathematics::problem::text::plain;

/// Intervals between the points of a line.
const INTERVALS: u32 = 100;

#[derive(Args)]
pub(super) struct PointArgs {
    /// v and its gradient at a point, as 0.1,0.2; several times
    ///
    /// In space a point has three numbers.
    #[arg(long, value_name = "X,Y", hide_short_help = true, allow_hyphen_values = true)]
    at: Vec<String>,
    /// v and its gradient at 101 points, as -0.5,0,0.5,0
    #[arg(long, value_name = "X0,Y0,X1,Y1", hide_short_help = true, allow_hyphen_values = true)]
    line: Vec<String>,
}

impl PointArgs {
    /// True if there is no point.
    pub(super) fn is_empty(&self) -> bool {
        self.at.is_empty() && self.line.is_empty()
    }

    /// Returns all points, those of lines last.
    ///
    /// # Errors
    /// [`Error::Input`] for what are not as many numbers as the domain has dimensions, or twice as many.
    pub(super) fn points(&self, problem: &Problem) -> Result<Vec<Vec<f64>>> {
        let dimensions = usize::from(problem.levels().facts().dimension);
        let mut points = Vec::new();
        for text in &self.at {
            points.push(numbers("--at", text, dimensions)?);
        }
        for text in &self.line {
            let ends = numbers("--line", text, 2 * dimensions)?;
            let (from, to) = ends.split_at(dimensions);
            for k in 0..=INTERVALS {
                let part = f64::from(k) / f64::from(INTERVALS);
                // Both ends are met to the last bit.
                let point = from.iter().zip(to).map(|(a, b)| (1.0 - part) * a + part * b);
                points.push(point.collect());
            }
        }
        Ok(points)
    }
}

/// Reads so many numbers with commas between them.
fn numbers(option: &str, text: &str, count: usize) -> Result<Vec<f64>> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    let form = match count {
        2 => "x,y",
        3 => "x,y,z",
        4 => "x0,y0,x1,y1",
        _ => "x0,y0,z0,x1,y1,z1",
    };
    let numbers = numbers.filter(|all| all.len() == count && all.iter().all(|x| x.is_finite()));
    numbers.ok_or_else(|| {
        Error::input(format!("{option} {text}: not {count} numbers; write {option} {form}"))
    })
}

/// Returns v and its gradient at points, with so many digits, or all of them.
fn table(values: &[PointValue], digits: Option<usize>) -> Table {
    let dimensions = values.first().map_or(2, |value| value.point.len());
    let names = &["x", "y", "z"][..dimensions];
    let slopes = names.iter().map(|name| format!("dv_d{name}"));
    let head = names.iter().map(|&name| name.to_owned()).chain(["v".into()]).chain(slopes);
    let mut table = Table::new(head, &[]);
    for PointValue { point, v, gradient } in values {
        let numbers = point.iter().chain(v).chain(gradient.iter().flatten());
        let written = numbers.map(|x| digits.map_or(x.to_string(), |digits| plain(*x, digits)));
        let mut row: Vec<_> = written.collect();
        row.resize(table.head.len(), String::new());
        table.rows.push(row);
    }
    table
}

/// Returns v and its gradient at points in lines, with so many digits.
pub(super) fn text(values: &[PointValue], digits: usize) -> String {
    if values.is_empty() {
        return String::new();
    }
    let outside = values.iter().filter(|value| value.v.is_none()).count();
    let mut text = in_columns(&table(values, Some(digits)));
    if outside > 0 {
        text += &format!("{outside} of {} points lie outside the domain\n", values.len());
    }
    text
}

/// Returns v and its gradient at points as CSV, with all digits.
pub(super) fn csv(values: &[PointValue]) -> Vec<u8> {
    table(values, None).csv().into_bytes()
}
