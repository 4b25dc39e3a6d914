//! Lines of settings in TOML, for messages on values that are read but cannot be taken.

use toml::de::{DeTable, DeValue};

/// Returns the line of a setting, given by the keys of its tables and the numbers of its items from 0 on; of the
/// innermost one that the text names.
pub(super) fn line(text: &str, keys: &[&str]) -> usize {
    let Ok(table) = DeTable::parse(text) else { return 1 };
    let mut here = &DeValue::Table(table.into_inner());
    let mut start = 0;
    for key in keys {
        let next = match here {
            DeValue::Table(table) => {
                table.get_key_value(*key).map(|(key, value)| (key.span().start, value.get_ref()))
            }
            DeValue::Array(items) => key
                .parse()
                .ok()
                .and_then(|k: usize| items.get(k))
                .map(|item| (item.span().start, item.get_ref())),
            _ => None,
        };
        let Some((at, value)) = next else { break };
        (start, here) = (at, value);
    }
    1 + text[..start].matches('\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_is_found_however_it_is_written() {
        let text = "[a]\nb = 1\nc = [\n  1,\n  2]\n[a.\"d.e\"]\n'/f' = { g = 2 }\n";
        for (keys, at) in [
            (&["a", "b"][..], 2),
            (&["a", "c"], 3),
            (&["a", "c", "1"], 5),
            (&["a", "d.e"], 6),
            (&["a", "d.e", "/f", "g"], 7),
            (&["a", "c", "7", "none"], 3),
            (&["none"], 1),
        ] {
            assert_eq!(line(text, keys), at, "{keys:?}");
        }
    }
}
