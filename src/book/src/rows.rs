//! Template filters for rows, which have their values under keys, dotted where a value has values of its own.

use tera::{Kwargs, State, Tera, TeraResult, Value};

pub(super) fn register(tera: &mut Tera) {
    tera.register_filter("where", rows_where);
    tera.register_filter("column", |rows: Vec<Value>, kwargs: Kwargs, _: &State| {
        column(&rows, kwargs.must_get::<&str>("key")?)
    });
    tera.register_filter("least", |x: Vec<f64>, _: Kwargs, _: &State| extreme(x, f64::min));
    tera.register_filter("greatest", |x: Vec<f64>, _: Kwargs, _: &State| extreme(x, f64::max));
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
        let context = serde_json::json!({ "rows": rows });
        let context = tera::Context::from_serialize(&context).unwrap();
        tera.render_str(template, &context, false)
    }

    #[test]
    fn filters_of_rows_ask_for_columns_that_are_there() {
        for (template, expected) in [
            ("{{ rows | where(key=\"of\", value=\"a\") | column(key=\"x\") | greatest }}", "3.0"),
            ("{{ rows | where(key=\"x\", least=2) | column(key=\"y\") | least }}", "12.0"),
            ("{{ rows | where(key=\"x\", most=2) | length }}", "3"),
        ] {
            assert_eq!(shown(template).unwrap(), expected, "{template}");
        }
        for filter in ["where(key=\"z\", value=1)", "column(key=\"z\")"] {
            let error = shown(&format!("{{{{ rows | {filter} | length }}}}")).unwrap_err();
            let said = format!("{error:?}");
            assert!(said.contains("no column `z`; there are of, x, y"), "{said}");
        }
    }
}
