//! Template filters for rows, which have their values under keys, dotted where a value has values of its own.

use tera::{Kwargs, State, Tera, TeraResult, Value};

pub(super) fn register(tera: &mut Tera) {
    tera.register_filter("where", rows_where);
    tera.register_filter("column", |rows: Vec<Value>, kwargs: Kwargs, _: &State| {
        column(&rows, kwargs.must_get::<&str>("key")?)
    });
    tera.register_filter("also", |rows: Vec<Value>, kwargs: Kwargs, _: &State| -> TeraResult<_> {
        Ok([rows, kwargs.must_get::<Vec<Value>>("rows")?].concat())
    });
    tera.register_filter("order", |rows: Vec<Value>, kwargs: Kwargs, _: &State| {
        order(&rows, [kwargs.must_get::<&str>("x")?, kwargs.must_get::<&str>("y")?])
    });
    tera.register_filter("rate", |rows: Vec<Value>, kwargs: Kwargs, _: &State| {
        rate(&rows, [kwargs.must_get::<&str>("x")?, kwargs.must_get::<&str>("y")?])
    });
    tera.register_filter("least", |x: Vec<f64>, _: Kwargs, _: &State| extreme(x, f64::min));
    tera.register_filter("greatest", |x: Vec<f64>, _: Kwargs, _: &State| extreme(x, f64::max));
    tera.register_filter("median", |x: Vec<f64>, _: Kwargs, _: &State| median(x));
    tera.register_filter("total", |n: Vec<usize>, _: Kwargs, _: &State| n.iter().sum::<usize>());
}

/// Filter `{{ ROWS | where(key="a.b", value=VALUE) }}`: the rows with this value; with `least=NUMBER` or
/// `most=NUMBER` instead, those with a number that is not less, or not greater.
fn rows_where(rows: Vec<Value>, kwargs: Kwargs, _: &State) -> TeraResult<Vec<Value>> {
    let key = kwargs.must_get::<&str>("key")?;
    refuse_unknown(&rows, key)?;
    let (least, most) = (kwargs.get::<f64>("least")?, kwargs.get::<f64>("most")?);
    let value = match (least, most) {
        (None, None) => Some(kwargs.must_get::<Value>("value")?),
        _ => kwargs.get::<Value>("value")?,
    };
    let mut wanted = rows;
    wanted.retain(|row| {
        let Some(there) = row.get_from_path(key) else { return false };
        let number = there.as_f64();
        value.as_ref().is_none_or(|value| there == value)
            && least.is_none_or(|least| number >= Some(least))
            && most.is_none_or(|most| number.is_some_and(|number| number <= most))
    });
    Ok(wanted)
}

/// Refuses a key that no row has.
fn refuse_unknown(rows: &[Value], key: &str) -> TeraResult<()> {
    match rows.first() {
        Some(row) if rows.iter().all(|row| row.get_from_path(key).is_none()) => {
            let mut names: Vec<String> = Vec::new();
            if let Some(map) = row.as_map() {
                names.extend(map.keys().map(ToString::to_string));
            }
            names.sort_unstable();
            let names = names.join(", ");
            Err(tera::Error::message(format!("no column `{key}`; there are {names}")))
        }
        _ => Ok(()),
    }
}

/// Returns the values of the rows under this key, for rows that have one.
fn column(rows: &[Value], key: &str) -> TeraResult<Vec<Value>> {
    refuse_unknown(rows, key)?;
    let values = rows.iter().filter_map(|row| row.get_from_path(key)).cloned();
    Ok(values.filter(|value| !value.is_none()).collect())
}

/// Returns the number of a row under a key.
fn number(row: &Value, key: &str) -> Option<f64> {
    row.get_from_path(key)?.as_f64()
}

/// Exponent p of the power law `y = c x^p` that fits best: least squares in logarithms.
///
/// `None` if there are fewer than two different x, or if a number is not positive.
fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> = points.iter().map(|&(x, y)| (libm::log(x), libm::log(y))).collect();
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / logs.len() as f64;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / logs.len() as f64;
    let covariance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.0 - mean_x)).sum();
    Some(covariance / variance).filter(|exponent| exponent.is_finite())
}

/// Returns the exponent of the power law of y over x, of the rows with both; nothing if there is none.
fn order(rows: &[Value], names: [&str; 2]) -> TeraResult<Value> {
    let exponent = exponent(&points(rows, names)?);
    Ok(exponent.map_or_else(Value::none, Value::from))
}

/// Returns the constant k of the law `y = C exp(-k / x)` that fits best: least squares in logarithms.
fn rate(rows: &[Value], names: [&str; 2]) -> TeraResult<Value> {
    let points = points(rows, names)?.into_iter().map(|(x, y)| (libm::exp(-1.0 / x), y));
    let exponent = exponent(&points.collect::<Vec<_>>());
    Ok(exponent.map_or_else(Value::none, Value::from))
}

/// Returns the numbers under two keys, of the rows with both.
fn points(rows: &[Value], [x, y]: [&str; 2]) -> TeraResult<Vec<(f64, f64)>> {
    refuse_unknown(rows, x)?;
    refuse_unknown(rows, y)?;
    Ok(rows.iter().filter_map(|row| Some((number(row, x)?, number(row, y)?))).collect())
}

/// Returns the median of some numbers, of an even number of them the mean of the two in the middle.
fn median(mut numbers: Vec<f64>) -> TeraResult<f64> {
    numbers.sort_by(f64::total_cmp);
    match numbers.len() {
        0 => Err(tera::Error::message("no numbers")),
        n if n % 2 == 1 => Ok(numbers[n / 2]),
        n => Ok(f64::midpoint(numbers[n / 2 - 1], numbers[n / 2])),
    }
}

/// Returns the least or the greatest of some numbers.
fn extreme(numbers: Vec<f64>, of_two: fn(f64, f64) -> f64) -> TeraResult<f64> {
    numbers.into_iter().reduce(of_two).ok_or_else(|| tera::Error::message("no numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Text that a template makes of rows.
    fn shown(template: &str) -> TeraResult<String> {
        let mut tera = Tera::new();
        register(&mut tera);
        let rows = serde_json::json!([
            { "of": "a", "x": 1.0, "y": 3.0 }, { "of": "b", "x": 2.0, "y": null },
            { "of": "a", "x": 2.0, "y": 12.0 }, { "of": "a", "x": 3, "y": 27.0 },
        ]);
        let powers =
            [1.0, 0.5, 0.25].map(|x| serde_json::json!({ "x": x, "y": libm::exp(-3.0 / x) }));
        let context = serde_json::json!({ "rows": rows, "powers": powers });
        let context = tera::Context::from_serialize(&context).unwrap();
        tera.render_str(template, &context, false)
    }

    #[test]
    fn filters_of_rows_ask_for_columns_that_are_there() {
        for (template, expected) in [
            ("{{ rows | where(key=\"of\", value=\"a\") | column(key=\"x\") | median }}", "2.0"),
            ("{{ rows | where(key=\"x\", least=2) | column(key=\"y\") | median }}", "19.5"),
            ("{{ rows | where(key=\"x\", most=2) | length }}", "3"),
            ("{{ rows | order(x=\"x\", y=\"y\") | round(precision=9) }}", "2.0"),
            ("{{ powers | rate(x=\"x\", y=\"y\") | round(precision=9) }}", "3.0"),
            (
                "{{ rows | where(key=\"of\", value=\"b\") | order(x=\"x\", y=\"y\") is none }}",
                "true",
            ),
        ] {
            assert_eq!(shown(template).unwrap(), expected, "{template}");
        }
        for filter in ["where(key=\"z\", value=1)", "column(key=\"z\")", "order(x=\"x\", y=\"z\")"]
        {
            let error = shown(&format!("{{{{ rows | {filter} | length }}}}")).unwrap_err();
            let said = format!("{error:?}");
            assert!(said.contains("no column `z`; there are of, x, y"), "{said}");
        }
    }

    #[test]
    fn exponents_are_those_of_power_laws() {
        let law: Vec<_> = (1..6).map(|k| (f64::from(k), 7.0 * f64::from(k).powi(3))).collect();
        assert!((exponent(&law).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(exponent(&law[..1]), None);
    }
}
