//! f on a mesh as text: by named regions, by shapes, by a formula, or as a known solution's.
//!
//! `region(name)=v` is f on all cells of that region, whatever the shapes say; v is a number or a formula. A name with
//! `=` or `;` stands in quotes. The rest of the text is that of a [`Source`].

use super::Names;
use super::cut::ConstantPieces;
use super::load::{MeshLoad, OnCells};
use crate::problem::error::{SCALE, SourceError};
use crate::problem::source::{Source, check_sizes};
use crate::problem::text::Written;

/// Reads f on each of these regions of a mesh whose largest coordinate has this size.
///
/// # Errors
/// [`SourceError`].
pub(crate) fn on_regions<const D: usize>(
    text: &str,
    region_names: &[Names],
    size: f64,
) -> Result<Vec<Source<D>>, SourceError> {
    let mut regions = vec![None; region_names.len()];
    let mut rest = Vec::new();
    for item in items(text) {
        let Some((name, value)) = region(item) else {
            if item.starts_with(REGION) {
                return Err(SourceError::Region(item.into()));
            }
            rest.push(item);
            continue;
        };
        // A value alone, `else=v`, is a constant.
        let is_formula = value.starts_with("formula(");
        let text = if is_formula { value.to_owned() } else { format!("else={value}") };
        set_named(&mut regions, region_names, name, &Source::read(&text, size)?)?;
    }
    let without = regions.iter().position(Option::is_none);
    if let (true, true, Some(region)) =
        (rest.is_empty(), regions.iter().any(Option::is_some), without)
    {
        return Err(SourceError::NoValueOn(region_names[region].to_string()));
    }
    if !rest.is_empty() || without.is_some() {
        let rest = Source::read(&rest.join("; "), size)?;
        regions.iter_mut().filter(|f| f.is_none()).for_each(|f| *f = Some(rest.clone()));
    }
    Ok(regions.into_iter().flatten().collect())
}

impl MeshLoad {
    /// Checks that f, on each region of the mesh, is of a size to compute with, as [`Source::check_scale`] does.
    ///
    /// # Errors
    /// [`SourceError::Scale`].
    pub(crate) fn check_scale<const D: usize>(&self, f: &[Source<D>]) -> Result<(), SourceError> {
        if self.size == 0.0 && self.cells.mean.iter().any(|mean| *mean != 0.0) {
            return Err(SourceError::Scale { what: "the integral of |f|", size: 0.0 });
        }
        check_sizes(f.iter().filter_map(Source::largest).reduce(f64::max), self.size)
    }
}

/// Reads k on each of these regions: a number of all of them, or numbers as f has them.
///
/// # Errors
/// A sentence.
pub(super) fn k_on_regions(text: &str, region_names: &[Names]) -> Result<Vec<f64>, String> {
    let example = "write a number, or one of each region as 'region(core)=5; else=1'";
    let text = if text.contains('=') { text.to_owned() } else { format!("else={text}") };
    let read = on_regions::<2>(&text, region_names, 1.0).map_err(|e| {
        let of_f = e.to_string();
        of_f.strip_prefix("f ").map_or_else(|| example.to_owned(), |rest| format!("k {rest}"))
    })?;
    let mut k = Vec::new();
    for (source, names) in read.iter().zip(region_names) {
        match source {
            Source::Pieces { background, pieces } if pieces.is_empty() => k.push(*background),
            _ => return Err(example.to_owned()),
        }
        let value = k[k.len() - 1];
        if !SCALE.contains(&value) {
            let [value, least, most] = [value, SCALE.start, SCALE.end].map(Written);
            return Err(format!(
                "{names} = {value} must be a positive number, of a size from {least} to {most}"
            ));
        }
    }
    Ok(k)
}

/// Gives f a value on all regions of this name.
fn set_named<const D: usize>(
    regions: &mut [Option<Source<D>>],
    region_names: &[Names],
    name: &str,
    value: &Source<D>,
) -> Result<(), SourceError> {
    let mut is_known = false;
    for (region, names) in regions.iter_mut().zip(region_names) {
        if !names.contains(name) {
            continue;
        }
        is_known = true;
        if region.as_ref().is_some_and(|other| other != value) {
            return Err(SourceError::TwoValues(names.to_string()));
        }
        *region = Some(value.clone());
    }
    is_known.then_some(()).ok_or_else(|| SourceError::UnknownRegion {
        name: name.into(),
        regions: Names::all(region_names.iter()),
    })
}

/// Beginning of a region.
const REGION: &str = "region(";
/// Beginning of a region with its name in quotes, and the end of the name.
const QUOTED: [&str; 2] = ["region(\"", "\")"];

/// Pieces of a text between semicolons or ends of lines, but for those in quotes around the name of a region.
fn items(text: &str) -> Vec<&str> {
    let [begin, end] = QUOTED;
    let (mut items, mut rest) = (Vec::new(), text.trim_start());
    while !rest.is_empty() {
        let name = rest.strip_prefix(begin).and_then(|name| name.find(end));
        let after = name.map_or(0, |length| begin.len() + length + end.len());
        let length = rest[after..].find([';', '\n']).map_or(rest.len(), |length| after + length);
        items.push(rest[..length].trim());
        rest = rest[length..].trim_start_matches([';', '\n']).trim_start();
    }
    items.retain(|item| !item.is_empty());
    items
}

/// Reads `region(name)=value`.
fn region(item: &str) -> Option<(&str, &str)> {
    let [begin, end] = QUOTED;
    if let Some((name, rest)) = item.strip_prefix(begin).and_then(|rest| rest.split_once(end)) {
        return Some((name, rest.trim_start().strip_prefix('=')?.trim()));
    }
    let (left, value) = item.split_once('=')?;
    let name = left.trim().strip_prefix(REGION)?.strip_suffix(')')?;
    Some((name.trim(), value.trim()))
}

impl<const D: usize> OnCells<D> for Source<D> {
    fn pieces(&self, _region: u16) -> Option<ConstantPieces<'_, D>> {
        match self {
            Self::Pieces { background, pieces } => {
                Some(ConstantPieces { background: *background, pieces })
            }
            Self::Exact(_) | Self::Formula(_) => None,
        }
    }

    fn at(&self, _region: u16, point: [f64; D]) -> f64 {
        Source::at(self, point)
    }
}

/// f on each region.
impl<const D: usize> OnCells<D> for [Source<D>] {
    fn pieces(&self, region: u16) -> Option<ConstantPieces<'_, D>> {
        OnCells::pieces(&self[usize::from(region)], region)
    }

    fn at(&self, region: u16, point: [f64; D]) -> f64 {
        self[usize::from(region)].at(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BuiltIn, mesh_load};

    fn names_of(names: &[&str]) -> Vec<Names> {
        names.iter().map(|name| (*name).into()).collect()
    }

    #[test]
    fn regions_and_shapes_are_read_together() {
        let names = names_of(&["core", "shell"]);
        let f = on_regions::<2>("region(core)=-1/4;  disc(0,0,1)=2; else=-1", &names, 1.0).unwrap();
        assert_eq!([f.at(0, [0.0; 2]), f.at(1, [0.0; 2]), f.at(1, [2.0; 2])], [-0.25, 2.0, -1.0]);
        assert!(on_regions::<2>("region(core)=1; region(shell)=2", &names, 1.0).is_ok());
        let f = on_regions::<2>("region(core)=formula(x*y); else=-1", &names, 1.0).unwrap();
        assert_eq!([f.at(0, [2.0, 3.0]), f.at(1, [2.0, 3.0])], [6.0, -1.0]);
        let mut both = Names::from("core");
        both.add("shell");
        let both = [both];
        for (text, said) in [
            (
                "region(core)=1",
                "f has no value on the region `shell`; give it one as on the others, or add `else=value`",
            ),
            (
                "region(core)=1; region(core)=2; else=0",
                "f has two values on the region `core`; give it one",
            ),
        ] {
            assert_eq!(on_regions::<2>(text, &names, 1.0).unwrap_err().to_string(), said);
        }
        let odd = names_of(&["a=b; c", "d"]);
        for text in [
            "region(\"a=b; c\")=1; else=2",
            "else=2;; region(\"a=b; c\") = 1\n",
            "region(d)=2;else=1",
        ] {
            let f = on_regions::<2>(text, &odd, 1.0).unwrap();
            assert_eq!([f.at(0, [0.0; 2]), f.at(1, [0.0; 2])], [1.0, 2.0], "{text}");
        }
        for text in ["region(a=b; c)=1; else=2", "region(d); else=1"] {
            let said = on_regions::<2>(text, &odd, 1.0).unwrap_err().to_string();
            assert!(said.contains("a name with = or ; in quotes"), "{said}");
        }
        let said = on_regions::<2>("region(core)=1; region(shell)=2", &both, 1.0);
        assert_eq!(said.unwrap_err(), SourceError::TwoValues("core, shell".into()));
        assert!(on_regions::<2>("region(core)=1; region(shell)=1", &both, 1.0).is_ok());
        for wrong in ["region(core)=1", "region(x)=1; else=2", "region(core)=x; else=1", "hello"] {
            let message = on_regions::<2>(wrong, &names, 1.0).unwrap_err().to_string();
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn loads_sum_to_the_integral_and_constants_are_exact() {
        let mesh = BuiltIn::LShape.plane().unwrap();
        let f = |text: &str| on_regions::<2>(text, mesh.region_names(), 1.0).unwrap();
        let made = mesh_load(&mesh, &f("rect(-1,0,-1,0)=3; else=-2")[..]).unwrap();
        assert_eq!((made.integral, made.size, made.cells.deviation), (-1.0, 7.0, None));
        assert!((made.load.iter().sum::<f64>() + 1.0).abs() < 1e-15);
        let cut = mesh_load(&mesh, &f("disc(0,0,0.5)=3; else=-2")[..]).unwrap();
        assert!(cut.cells.deviation.is_some());
    }
}
