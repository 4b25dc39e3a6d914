//! Names of parts of the boundary and of regions.

use std::fmt;

/// Names of a part of the boundary or of a region: those of all groups to which its facets or cells belong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names(Vec<String>);

impl Names {
    /// True if this is one of the names.
    pub fn contains(&self, name: &str) -> bool {
        self.0.iter().any(|known| known == name)
    }

    /// Names, in the order of their groups.
    pub fn iter(&self) -> impl Iterator<Item = &String> {
        self.0.iter()
    }

    /// Adds a name, unless it is there.
    pub fn add(&mut self, name: &str) {
        if !self.contains(name) {
            self.0.push(name.into());
        }
    }

    /// Returns all names of a list as text, each once.
    pub(crate) fn all<'a>(list: impl Iterator<Item = &'a Self>) -> String {
        let mut all = Self::default();
        list.flat_map(Self::iter).for_each(|name| all.add(name));
        all.to_string()
    }
}

impl From<&str> for Names {
    fn from(name: &str) -> Self {
        Self(vec![name.into()])
    }
}

impl fmt::Display for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(", "))
    }
}
