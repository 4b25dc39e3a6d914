//! f on a mesh as text: by named regions, by shapes, by a formula, or as a known solution's.
//!
//! `region(name)=v` is f on all cells of that region, whatever the shapes say; v is a number or a formula. A name with
//! `=` or `;` stands in quotes. The rest of the text is that of a [`Source`].

use super::Names;
use super::cut::ConstantPieces;
use super::load::{MeshLoad, OnCells};
use crate::problem::error::SourceError;
use crate::problem::exact::Known;
use crate::problem::source::{Source, check_sizes};

/// f on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MeshSource<const D: usize> {
    /// f on each region; none where the rest says it.
    regions: Vec<Option<Source<D>>>,
    /// f where no region has a value.
    rest: Source<D>,
    /// Text, in one line.
    text: String,
}

impl<const D: usize> MeshSource<D> {
    /// Reads a text for a mesh with these regions, whose largest coordinate has this size.
    ///
    /// # Errors
    /// [`SourceError`].
    pub(crate) fn read(text: &str, region_names: &[Names], size: f64) -> Result<Self, SourceError> {
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
        let complete = rest.is_empty() && without.is_none();
        let rest =
            if complete { Source::constant(0.0) } else { Source::read(&rest.join("; "), size)? };
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        Ok(Self { regions, rest, text })
    }

    /// Text from which f was read, in one line.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Problem with a known solution whose f this is, if it is one.
    pub(crate) fn known(&self) -> Option<Known> {
        match &self.rest {
            Source::Exact(known) if self.regions.iter().all(Option::is_none) => Some(*known),
            _ => None,
        }
    }

    /// The pieces that lie outside the unit square or cube.
    pub(crate) fn outside(&self) -> Vec<String> {
        self.rest.outside()
    }

    /// f on the cells of a region.
    pub(crate) fn on(&self, region: u16) -> &Source<D> {
        self.regions[region as usize].as_ref().unwrap_or(&self.rest)
    }

    /// Checks that f is of a size to compute with, as [`Source::check_scale`] does.
    ///
    /// # Errors
    /// [`SourceError::Scale`].
    pub(crate) fn check_scale(&self, load: &MeshLoad) -> Result<(), SourceError> {
        if load.size == 0.0 && load.cells.mean.iter().any(|mean| *mean != 0.0) {
            return Err(SourceError::Scale { what: "the integral of |f|", size: 0.0 });
        }
        let parts = self.regions.iter().flatten().chain([&self.rest]);
        check_sizes(parts.filter_map(Source::largest).reduce(f64::max), load.size)
    }
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

impl<const D: usize> OnCells<D> for MeshSource<D> {
    fn pieces(&self, region: u16) -> Option<ConstantPieces<'_, D>> {
        OnCells::pieces(self.on(region), region)
    }

    fn at(&self, region: u16, point: [f64; D]) -> f64 {
        self.on(region).at(point)
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
        let f = MeshSource::<2>::read("region(core)=-1/4;  disc(0,0,1)=2; else=-1", &names, 1.0)
            .unwrap();
        assert_eq!([f.at(0, [0.0; 2]), f.at(1, [0.0; 2]), f.at(1, [2.0; 2])], [-0.25, 2.0, -1.0]);
        assert_eq!(f.text(), "region(core)=-1/4; disc(0,0,1)=2; else=-1");
        assert!(MeshSource::<2>::read("region(core)=1; region(shell)=2", &names, 1.0).is_ok());
        let f = MeshSource::<2>::read("region(core)=formula(x*y); else=-1", &names, 1.0).unwrap();
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
            assert_eq!(MeshSource::<2>::read(text, &names, 1.0).unwrap_err().to_string(), said);
        }
        let odd = names_of(&["a=b; c", "d"]);
        for text in [
            "region(\"a=b; c\")=1; else=2",
            "else=2;; region(\"a=b; c\") = 1\n",
            "region(d)=2;else=1",
        ] {
            let f = MeshSource::<2>::read(text, &odd, 1.0).unwrap();
            assert_eq!([f.at(0, [0.0; 2]), f.at(1, [0.0; 2])], [1.0, 2.0], "{text}");
        }
        for text in ["region(a=b; c)=1; else=2", "region(d); else=1"] {
            let said = MeshSource::<2>::read(text, &odd, 1.0).unwrap_err().to_string();
            assert!(said.contains("a name with = or ; in quotes"), "{said}");
        }
        let said = MeshSource::<2>::read("region(core)=1; region(shell)=2", &both, 1.0);
        assert_eq!(said.unwrap_err(), SourceError::TwoValues("core, shell".into()));
        assert!(MeshSource::<2>::read("region(core)=1; region(shell)=1", &both, 1.0).is_ok());
        for wrong in ["region(core)=1", "region(x)=1; else=2", "region(core)=x; else=1", "hello"] {
            let message = MeshSource::<2>::read(wrong, &names, 1.0).unwrap_err().to_string();
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn loads_sum_to_the_integral_and_constants_are_exact() {
        let mesh = BuiltIn::LShape.plane().unwrap();
        let f = |text: &str| MeshSource::<2>::read(text, mesh.region_names(), 1.0).unwrap();
        let made = mesh_load(&mesh, &f("rect(-1,0,-1,0)=3; else=-2")).unwrap();
        assert_eq!((made.integral, made.size, made.cells.deviation), (-1.0, 7.0, None));
        assert!((made.load.iter().sum::<f64>() + 1.0).abs() < 1e-15);
        let cut = mesh_load(&mesh, &f("disc(0,0,0.5)=3; else=-2")).unwrap();
        assert!(cut.cells.deviation.is_some());
    }
}
