//! Names of choices in files and options.

/// Gives an enumeration without fields the list of its choices, and their names in files and options.
macro_rules! choices {
    ($type:ident, $count:literal: $($choice:ident = $name:literal),+ $(,)?) => {
        impl $type {
            /// All choices.
            pub const ALL: [Self; $count] = [$(Self::$choice),+];

            /// Name in files and options.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$choice => $name),+
                }
            }

            /// Choice of this name.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|choice| choice.name() == name)
            }
        }
    };
}

pub(crate) use choices;
