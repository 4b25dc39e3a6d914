//! Place of a mesh in its file, and what was read otherwise than it stands there.

/// Place of a mesh in its file, and what was read otherwise than it stands there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MeshOrigin {
    /// Plane in which a mesh in the plane lies.
    pub plane: PlaneInSpace,
    /// Number of cells of higher order, which are read by their corners.
    pub of_higher_order: usize,
    /// Number of quadrangles, which a diagonal cuts.
    pub quadrangles: usize,
    /// Number of triangles that the file writes as quadrangles with a node twice.
    pub collapsed: usize,
    /// Number of elements of a lower dimension that are on no cell, and in no group.
    pub left_out: usize,
    /// True if the file tells of a volume, and has no tetrahedra.
    pub without_volume: bool,
}

/// Plane in space, with two coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PlaneInSpace {
    /// The plane of x and y at this z.
    Horizontal(f64),
    /// Another plane.
    Other {
        /// Point of the plane nearest to that of zero coordinates; both axes are perpendicular to the step there.
        foot: [f64; 3],
        /// Axes of the coordinates, of length one.
        axes: [[f64; 3]; 2],
    },
}

impl Default for PlaneInSpace {
    fn default() -> Self {
        Self::Horizontal(0.0)
    }
}

impl PlaneInSpace {
    /// Place in space of a point of the plane.
    pub(crate) fn in_space(&self, [s, t]: [f64; 2]) -> [f64; 3] {
        match *self {
            Self::Horizontal(z) => [s, t, z],
            Self::Other { foot, axes: [a, b] } => {
                std::array::from_fn(|d| foot[d] + s * a[d] + t * b[d])
            }
        }
    }

    /// Coordinates in the plane of a point in space.
    pub(crate) fn coordinates(&self, point: [f64; 3]) -> [f64; 2] {
        match self {
            Self::Horizontal(_) => [point[0], point[1]],
            Self::Other { axes, .. } => {
                axes.map(|axis| axis.iter().zip(point).map(|(a, x)| a * x).sum())
            }
        }
    }
}

impl MeshOrigin {
    /// Returns, in a line each, what was read otherwise than it stands in the file.
    pub(crate) fn notes(&self) -> Vec<String> {
        let counted = [
            (
                self.of_higher_order,
                "element of higher order is read by its corners, with straight sides",
                "elements of higher order are read by their corners, with straight sides",
            ),
            (
                self.quadrangles,
                "quadrangle is cut into triangles, by its shorter diagonal",
                "quadrangles are cut into triangles, each by its shorter diagonal",
            ),
            (
                self.collapsed,
                "quadrangle with a node twice is read as a triangle",
                "quadrangles with a node twice are read as triangles",
            ),
            (
                self.left_out,
                "element of a lower dimension that is on no cell and in no group is left out",
                "elements of a lower dimension that are on no cell and in no group are left out",
            ),
        ];
        let mut notes = Vec::new();
        for (count, one, several) in counted.into_iter().filter(|(count, ..)| *count > 0) {
            notes.push(format!("{count} {}", if count == 1 { one } else { several }));
        }
        if self.without_volume {
            notes.push(
                "the file tells of a volume and has no tetrahedra: the domain is the surface; to have the volume, mesh \
                 it with `gmsh -3`, in a Physical Volume if there are groups"
                    .into(),
            );
        }
        if let PlaneInSpace::Other { axes, .. } = &self.plane {
            let [x, y] = axes.each_ref().map(in_words);
            notes.push(format!(
                "the mesh lies in a plane that is not z = const: in f and curves, x stands for {x} of the file and y \
                 for {y}"
            ));
        }
        notes
    }
}

/// Coordinate along an axis, in those of the file.
fn in_words(axis: &[f64; 3]) -> String {
    let mut text = String::new();
    for (part, name) in axis.iter().zip(["x", "y", "z"]) {
        let size = (part.abs() * 1e4).round() / 1e4;
        if size == 0.0 {
            continue;
        }
        let is_first = text.is_empty();
        text += match (*part < 0.0, is_first) {
            (true, true) => "-",
            (true, false) => " - ",
            (false, true) => "",
            (false, false) => " + ",
        };
        if size != 1.0 {
            text += &format!("{size} ");
        }
        text += name;
    }
    text
}
