//! As much YAML as a manifest needs: mappings, lists and quoted strings.

/// A node of a document.
pub(super) enum Yaml {
    Text(String),
    List(Vec<Yaml>),
    Map(Vec<(&'static str, Yaml)>),
}

impl Yaml {
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// The document, in block style, with every string in double quotes.
    pub(super) fn document(&self) -> String {
        let mut out = String::from("%YAML 1.1\n---\n");
        self.write(0, &mut out);
        out
    }

    /// Writes the node at the current place of a line; what follows on further lines is indented.
    fn write(&self, indent: usize, out: &mut String) {
        match self {
            // A JSON string is a double-quoted scalar of YAML.
            Self::Text(text) => *out += &format!("{}\n", serde_json::json!(text)),
            Self::List(items) if items.is_empty() => *out += "[]\n",
            Self::List(items) => {
                for (k, item) in items.iter().enumerate() {
                    *out += &margin(k, indent);
                    *out += "- ";
                    item.write(indent + 2, out);
                }
            }
            Self::Map(entries) => {
                for (k, (key, value)) in entries.iter().enumerate() {
                    *out += &margin(k, indent);
                    *out += &format!("{key}:");
                    match value {
                        Self::Text(_) => *out += " ",
                        Self::List(items) if items.is_empty() => *out += " ",
                        _ => *out += &format!("\n{}", " ".repeat(indent + 2)),
                    }
                    value.write(indent + 2, out);
                }
            }
        }
    }
}

/// The margin of a line; the first item stands where its parent left off.
fn margin(item: usize, indent: usize) -> String {
    " ".repeat(if item == 0 { 0 } else { indent })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_nest_by_indentation_and_strings_are_quoted() {
        let file = |name: &str| Yaml::Map(vec![("file", Yaml::text(name))]);
        let node = Yaml::Map(vec![
            ("manifest", Yaml::List(vec![file("a: \"b\"\n#"), file("Гурвиц")])),
            ("none", Yaml::List(vec![])),
            ("paper", Yaml::Map(vec![("title", Yaml::text("- no")), ("yes", Yaml::text("1"))])),
        ]);
        let want = "%YAML 1.1\n---\nmanifest:\n  - file: \"a: \\\"b\\\"\\n#\"\n  - file: \"Гурвиц\"\n\
            none: []\npaper:\n  title: \"- no\"\n  yes: \"1\"\n";
        assert_eq!(node.document(), want);
    }
}
