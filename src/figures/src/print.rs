//! Pictures for print: their width, and whether they have titles.

use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Picture as a page in print has it; the caption is there in place of the title.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { width = \"85mm\", title = false }")]
pub struct Print {
    /// Width; none for that of the screen.
    #[serde(default)]
    pub width: Option<Width>,
    /// False if titles are left out.
    #[serde(default = "yes")]
    pub title: bool,
}

/// Width of a picture, with its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Width {
    number: f64,
    unit: String,
}

/// Units that SVG knows; a number alone counts pixels.
const UNITS: [&str; 6] = ["mm", "cm", "in", "pt", "px", ""];

impl Width {
    /// Returns the attributes of width and height of a picture whose height is this part of its width.
    pub(super) fn attributes(&self, part: f64) -> [String; 2] {
        let Self { number, unit } = self;
        // To a hundredth, of inches as well.
        let height = (100.0 * number * part).round() / 100.0;
        [number, &height].map(|length| format!("{length}{unit}"))
    }
}

impl FromStr for Width {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unit = UNITS.iter().find(|unit| text.ends_with(**unit)).copied().unwrap_or_default();
        let number = text[..text.len() - unit.len()].trim().parse::<f64>().ok();
        let number = number.filter(|number| (1e-2..=1e5).contains(number));
        let remedy = "write a length with mm, cm, in, pt or px, such as 85mm";
        number
            .map(|number| Self { number, unit: unit.into() })
            .ok_or_else(|| format!("`{text}`: {remedy}"))
    }
}

impl TryFrom<String> for Width {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Width> for String {
    fn from(Width { number, unit }: Width) -> Self {
        format!("{number}{unit}")
    }
}

/// True, the usual value.
fn yes() -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_have_units_and_the_height_follows() {
        let shape = |text: &str| text.parse::<Width>().map(|width| width.attributes(0.5));
        assert_eq!(shape("85mm").unwrap(), ["85mm", "42.5mm"]);
        assert_eq!(shape("400").unwrap(), ["400", "200"]);
        for wrong in ["", "mm", "-1cm", "5 ells", "nan", "1e9in"] {
            assert!(shape(wrong).is_err(), "{wrong}");
        }
    }
}
