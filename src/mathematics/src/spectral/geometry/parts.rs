//! Parts of a curve with a value each.

use super::curve::SAME;

/// Part of a curve.
pub(in crate::spectral) struct CurvePart<T> {
    pub span: [f64; 2],
    pub value: T,
}

/// Adds a part of a curve, to the last one if they touch and have the same value.
pub(in crate::spectral) fn append<T: PartialEq>(parts: &mut Vec<CurvePart<T>>, part: CurvePart<T>) {
    match parts.last_mut() {
        Some(last) if last.value == part.value && part.span[0] - last.span[1] < SAME => {
            last.span[1] = part.span[1];
        }
        _ => parts.push(part),
    }
}

/// Joins the last part of a circle to the first if they touch and have the same value.
pub(in crate::spectral) fn close<T: PartialEq>(parts: &mut Vec<CurvePart<T>>, period: f64) {
    if let [first, .., last] = &mut parts[..]
        && first.value == last.value
        && first.span[0] + period - last.span[1] < SAME
    {
        first.span[0] = last.span[0] - period;
        parts.pop();
    }
}
