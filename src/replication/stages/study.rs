//! Rows of a study for pages, and its chart.

use super::from_json;
use super::members::{id_in_study, ids};
use super::solve::NUMBERS;
use crate::figures::{Chart, Curve, Picture, Scale, Stroke, axes_alone, charts};
use crate::pipeline::Inputs;
use crate::replication::columns::in_words;
use crate::replication::fields::member::Member;
use crate::replication::fields::table::{Field, field};
use crate::replication::numbers::Numbers;
use crate::replication::scene::Scene;
use crate::replication::study::{Axes, Study, of_axis};
use crate::table::rows::Rows;

/// Returns the rows of the study of a scene, as [`Study::rows`].
pub(super) fn rows(inputs: &Inputs, scene: &str, study: &Study) -> Result<Rows, String> {
    let numbers = |member: &Member| from_json(inputs, &id_in_study(scene, study, member), NUMBERS);
    let all: Result<Vec<Numbers>, _> = study.members.iter().map(numbers).collect();
    Ok(Rows(study.rows(&all?)))
}

/// Draws the chart of a study: a curve for each of the other values that are varied.
pub(super) fn chart(scene: &Scene, inputs: &Inputs) -> Result<Picture, String> {
    let study = &scene.study;
    let axes = study.chart.as_ref().ok_or("the study has no chart")?;
    let mut curves: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    // Reason of the first member without a solution, and number of those with one that are not on the axes.
    let (mut reason, mut left_out) = (None, 0);
    for (member, task) in study.members.iter().zip(ids(scene)) {
        let numbers: Numbers = from_json(inputs, &task, NUMBERS)?;
        let label = axes.label(study, member);
        let place = curves.iter().position(|(known, _)| *known == label);
        let place = place.unwrap_or_else(|| {
            curves.push((label, Vec::new()));
            curves.len() - 1
        });
        let [x, y] = axes.values(study, member, &numbers);
        // Numbers where a solver ended without a solution are none of a solution.
        curves[place].1.extend(x.zip(y).filter(|_| numbers.reason.is_none()));
        left_out += usize::from(x.zip(y).is_none() && numbers.reason.is_none());
        reason = reason.or(numbers.reason);
    }
    for (_, points) in &mut curves {
        points.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    }
    curves.retain(|(_, points)| !points.is_empty());
    let [across, up] = axes.columns.each_ref();
    let mut title = scene.title.clone();
    match reason {
        // The table has the same row by row, and no error either.
        Some(reason) if curves.is_empty() => title += &format!("\nno solution: {reason}"),
        None if curves.is_empty() => {
            return Err(format!(
                "no member has {across} and {up} to be drawn; on a logarithmic axis only what is positive is"
            ));
        }
        _ if left_out > 0 => {
            title += &format!("\nnot on these axes: {left_out} of {} members", study.members.len());
        }
        _ => {}
    }
    let curves =
        curves.into_iter().map(|(label, points)| Curve::new(Stroke::Marked, label, points));
    let names = axes.columns.each_ref().map(|column| match column.as_str() {
        "r" => "duality parameter r".to_owned(),
        column => in_words(column),
    });
    let scales = axes.log.map(|log| if log { Scale::Logarithmic } else { Scale::Linear });
    let chart = Chart::new(title, names.each_ref().map(String::as_str), curves.collect());
    let chart = chart.scaled(scales);
    Ok(if chart.curves.is_empty() { axes_alone(&chart) } else { charts(false, &[chart]) })
}

impl Axes {
    /// Label of the curve to which a member belongs: the values that no axis shows; the nodes show the fineness.
    fn label(&self, study: &Study, member: &Member) -> String {
        let mut others = Vec::new();
        for (name, value) in study.names.iter().zip(study.values(member)) {
            let is_shown = self.columns.iter().map(|column| of_axis(column).0).any(|column| {
                column == name
                    || column == "nodes" && field(name).is_some_and(Field::is_about_fineness)
            });
            if !is_shown {
                others.push(format!("{name} = {value}"));
            }
        }
        match others.is_empty() {
            true => in_words(&self.columns[1]),
            false => others.join(", "),
        }
    }

    /// Values of a member with its numbers across and up; none where it has none on the axis.
    fn values(&self, study: &Study, member: &Member, numbers: &Numbers) -> [Option<f64>; 2] {
        let columns = self.columns.each_ref().map(|column| of_axis(column));
        let found = numbers.numbers(columns.map(|(column, _)| column));
        [0, 1].map(|axis| {
            let (column, is_reciprocal) = columns[axis];
            let is_varied = study.names.iter().any(|name| name == column);
            let value = match member.value(column).filter(|_| is_varied) {
                Some(value) => value.number(),
                None => found[axis],
            };
            let value = value.map(|value| if is_reciprocal { 1.0 / value } else { value });
            value.filter(|value| value.is_finite() && (*value > 0.0 || !self.log[axis]))
        })
    }
}
