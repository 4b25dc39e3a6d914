//! Fields that are varied, and names in f: the members of a study.
//!
//! Central is [`Vary`]: the same lists are the key `vary` of a scene, lists of `r` and `stop` there, and the option
//! `--vary` of `solve`, and each value of a field is read as its option reads it.

use super::Fields;
use super::lists::{MOST_MEMBERS, Varied, product_of};
use super::member::{Member, Varying, in_words};
use super::names::{NAMED, with_numbers};
use super::parts::{is_name, names};
use super::table::{FIELDS, Reading, Refused, Voice, field, text};
use crate::replication::columns::{COLUMNS, END};
use crate::replication::limits;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::statement::Statement;
use std::collections::{BTreeMap, BTreeSet};
use toml::Value;

/// Key of a scene whose lists are varied, and option of `solve`.
pub(crate) const VARY: &str = "vary";

/// Values that are varied, as they are given.
#[derive(Clone, Debug)]
pub(crate) struct Vary {
    /// Names of fields and names in f, in the order of the columns.
    pub(crate) names: Vec<String>,
    /// Values of each member, in the order of the names.
    members: Vec<Vec<Value>>,
    /// Key of the scene that varies them: `vary`, or one whose list is short for it.
    key: String,
}

impl Vary {
    /// Returns the members of products of lists, one product after the other; of a product without lists, one that
    /// varies nothing. The key of the scene that has the lists is named by refusals.
    ///
    /// # Errors
    /// Reason, with the remedy.
    pub(crate) fn of(products: &[Vec<Varied>], key: &str) -> Result<Self, String> {
        let names = products.first().into_iter().flatten().map(|list| list.name.clone());
        let names: Vec<String> = names.collect();
        if let Some(name) = names.iter().find(|name| !is_name(name)) {
            return Err(format!("`{name}` is no name; take letters, digits and _"));
        }
        let mut seen = BTreeSet::new();
        if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
            return Err(format!("`{name}` is there twice; give all its values in one list"));
        }
        // That a solver is varied says its own column.
        let mut own = names.iter().filter(|name| field(name).is_none());
        if let Some(name) = own.find(|name| is_taken(name)) {
            return Err(format!("`{name}` is a column of the answer; choose another name"));
        }
        let mut members: Vec<Vec<Value>> = Vec::new();
        for product in products {
            let lists: Option<Vec<&Varied>> =
                names.iter().map(|name| product.iter().find(|list| list.name == *name)).collect();
            let lists = lists.filter(|_| product.len() == names.len()).ok_or_else(|| {
                format!("each table has the same names; give each {}", names.join(", "))
            })?;
            if let Some(list) = lists.iter().find(|list| list.values.is_empty()) {
                return Err(format!("`{}` has no values; add some, or leave it out", list.name));
            }
            let counts = lists.iter().map(|list| list.values.len());
            let count = counts.fold(1, usize::saturating_mul).saturating_add(members.len());
            if count > MOST_MEMBERS {
                return Err(format!(
                    "there are {count} members, more than {MOST_MEMBERS}; leave out values, or divide the study"
                ));
            }
            members.extend(product_of(&lists));
        }
        Ok(Self { names, members, key: key.to_owned() })
    }

    /// Returns the members, whose statements `state` makes of these fields with the values of each.
    ///
    /// # Errors
    /// [`Refused`] if a name is neither a field nor in f, is given as well, has a value that it cannot have or the same
    /// value twice, and what `state` refuses.
    pub(crate) fn members(
        &self,
        base: &Fields,
        voice: Voice,
        mut state: impl FnMut(&Fields) -> Reading<Statement>,
    ) -> Reading<Vec<Member>> {
        for field in self.names.iter().filter_map(|name| field(name)) {
            if base.has(field.name) {
                let text =
                    format!("{} is given as well; leave one of them out", voice.name(field.name));
                return Err(refused(voice, field.name, None, &text));
            }
        }
        let (mut members, mut seen) = (Vec::with_capacity(self.members.len()), BTreeSet::new());
        for values in &self.members {
            let (fields, numbers) = self.read(base, voice, values)?;
            let statement = state(&fields).map_err(|refused| {
                let is_varied = self.names.contains(&refused.field);
                let field = if is_varied { &self.key } else { &refused.field };
                // Lists of rules and r are mostly what all members have in common, and the only name says its value.
                let is_told = self.key != VARY || is_varied && self.names.len() == 1;
                let words = match is_told || self.names.is_empty() {
                    true => String::new(),
                    false => format!("with {}: ", in_words(&self.names, values.iter().map(text))),
                };
                Refused::new(field, words + &refused.text)
            })?;
            let member = Member { numbers, statement };
            let found: Option<Vec<Varying>> =
                self.names.iter().map(|name| member.value(name)).collect();
            let Some(found) = found else {
                let words = in_words(&self.names, values.iter().map(text));
                return Err(Refused::new(
                    &self.key,
                    format!("{words}: not all of them go together; leave one out"),
                ));
            };
            let meanings = self.names.iter().zip(&found).map(|(name, value)| value.meaning(name));
            if !seen.insert(meanings.collect::<Vec<_>>()) {
                let words = in_words(&self.names, &found);
                return Err(Refused::new(&self.key, format!("{words} is there twice; remove one")));
            }
            members.push(member);
        }
        Ok(members)
    }

    /// Returns the fields with these values of a member in them, and the numbers of its names in f.
    fn read(
        &self,
        base: &Fields,
        voice: Voice,
        values: &[Value],
    ) -> Reading<(Fields, BTreeMap<String, f64>)> {
        let (mut fields, mut own) = (base.clone(), Vec::new());
        for (name, value) in self.names.iter().zip(values) {
            match (field(name), value) {
                (Some(field), Value::Table(_)) if field.name == "domain" => {
                    let text = "in `vary` a domain is its name alone; what is said of it varies beside it, as in vary \
                        = [{ domain = \"disc\", refine = 2 }, { domain = \"lshape\", refine = 3 }]";
                    return Err(refused(voice, name, Some(value), text));
                }
                (Some(field), value) => fields.insert(field, value)?,
                (None, value) => own.push((name, value)),
            }
        }
        let in_laws = fields.names_in_laws();
        let in_texts = NAMED.iter().filter_map(|field| fields.text(field));
        let named: BTreeSet<&str> =
            in_texts.flat_map(names).chain(in_laws.iter().map(|name| &**name)).collect();
        let mut numbers = BTreeMap::new();
        for (name, value) in own {
            if !named.contains(name.as_str()) {
                let known: Vec<_> = FIELDS.iter().map(|field| field.name).collect();
                let known = known.join(", ");
                let text = limits::of_word(name).unwrap_or_else(|| {
                    format!(
                        "no such field, and neither f, k nor a law has ${name}; the fields are {known}"
                    )
                });
                return Err(refused(voice, name, None, &text));
            }
            numbers.insert(name.clone(), number_of(voice, name, value)?);
        }
        fields.put_into_laws(&numbers);
        for field in NAMED {
            if let Some(text) = fields.text(field) {
                let text = with_numbers(field, text, &numbers)?;
                fields.0.insert(field, vec![text]);
            }
        }
        Ok((fields, numbers))
    }
}

/// Refusal of a name, or of one of its values.
fn refused(voice: Voice, name: &str, value: Option<&Value>, reason: &str) -> Refused {
    let given = match (voice, value) {
        (Voice::Keys, None) => format!("`vary`: {name}"),
        (Voice::Keys, Some(value)) => format!("`vary`: {name} = {}", text(value)),
        (_, None) => format!("--vary {name}"),
        (_, Some(value)) => format!("--vary {name}={}", text(value)),
    };
    Refused::new("vary", format!("{given}: {reason}"))
}

/// Reads the number of a name in f.
fn number_of(voice: Voice, name: &str, value: &Value) -> Reading<f64> {
    let read = match value {
        Value::Float(_) | Value::Integer(_) | Value::String(_) => text(value).parse().ok(),
        _ => None,
    };
    // A negative zero is zero.
    read.map(|Written(number)| number + 0.0).ok_or_else(|| {
        let reason = "a name in f is a number, such as 0.25 or 1/4; what is no number varies as a field, as f does";
        refused(voice, name, Some(value), reason)
    })
}

/// True if a row has a key of this name besides what is varied.
fn is_taken(name: &str) -> bool {
    ["schema", END].contains(&name) || COLUMNS.contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::fields::lists::Products;

    /// Texts of f of the members with this f and these other keys, what varies among them.
    fn with(f: &str, keys: &str) -> Result<Vec<String>, String> {
        #[derive(serde::Deserialize)]
        struct Given {
            vary: Products,
        }
        let given: Given = toml::from_str(keys).map_err(|e| e.to_string())?;
        let vary = Vary::of(&given.vary.0, VARY)?;
        let mut keys: toml::Table = toml::from_str(keys).unwrap();
        keys.insert("f".to_owned(), f.into());
        keys.remove("vary");
        let base = Fields::of_keys(keys.into_iter().collect(), &[]);
        let base = base.map_err(|refused| refused.text)?;
        let members = vary.members(&base, Voice::Keys, |fields| fields.stated(Voice::Keys));
        let members = members.map_err(|refused| refused.text)?;
        Ok(members.into_iter().map(|member| member.statement.f).collect())
    }

    #[test]
    fn names_in_f_are_numbers() {
        let f = "disc($x,0,$R1)=$R; else=-1";
        let members = with(f, "vary = { R = [1e-7, \"-1/2\"], R1 = 0.5, x = 0 }").unwrap();
        let expected = ["1e-7", "-0.5"].map(|r| format!("disc(0,0,0.5)={r}; else=-1"));
        assert_eq!(members, expected);
        for (f, vary, words) in [
            ("else=-$S", "vary = { R = [1] }", "nor a law has $R"),
            ("else=-$R", "vary = { R = [\"x\"] }", "R = x: a name in f is a number"),
            ("else=-$R", "vary = { R = [[1, 2]] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [inf] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [true] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [0.1, \"0.10\"] }", "R = 0.1 is there twice"),
            ("else=-$R", "vary = { R = [\"1/4\", 0.25] }", "R = 0.25 is there twice"),
            ("else=-$h", "vary = { h = [4, 5] }", "`h` is a field; choose another name in f"),
            ("else=-$R", "vary = { R = 1, friction = [1, 1.0] }", "friction = 1 is there twice"),
            ("else=-1", "law.gap = \"$G\"\nvary = { G = [0.1, 1e-1] }", "G = 0.1 is there twice"),
        ] {
            let refused = with(f, vary).unwrap_err();
            assert!(refused.contains(words), "{vary}: {refused}");
        }
    }
}
