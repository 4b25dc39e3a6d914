//! Maps of solutions on domains in the plane: v in bands of colour between isolines, and the boundary by its state.

use super::axes::{Frame, key};
use super::drawn::MOST_CELLS;
use super::isolines::{AtLevel, Loop};
use super::maps::{below, draw_axes, layout};
use super::palette::{CONTACT, ColourScale, INK, RGBColor};
use super::panels::title;
use super::picture::{END, LARGE, NORMAL, Picture, Place, SMALL, fitting, italic, text_width};
use super::plan::square_around;
use super::text::Ticks;
use super::{held, range_with_zero};
use signorini_mathematics::levels::{ClosedCurve, Drawing, Levels};
use signorini_mathematics::mesh::PlaneMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::Pair;

/// Most isolines.
const ISOLINES: usize = 12;
/// Attributes of bands: thin light lines along their borders, of the same colour on either page.
const BAND_LINES: &str =
    "fill-rule=\"evenodd\" stroke=\"#FEFEFE\" stroke-opacity=\"0.6\" stroke-width=\"2\"";
/// Widths of the boundary, and of the part of it that is held, in display pixels.
const BOUNDARY_WIDTHS: [f64; 2] = [1.0, 4.0];
/// Distance in display pixels below which a point is taken to lie on a line.
const ON_LINE: f64 = 0.1;

/// Solution on the mesh of a picture, with the boundary of the finest level.
pub(crate) struct SolutionMap {
    title: String,
    law: Law,
    mesh: PlaneMesh,
    /// v at the nodes of the mesh.
    v: Vec<f64>,
    /// Closed curves of the boundary.
    boundary: Vec<Loop>,
    /// Parts of the boundary with v = 0 by the law, each as the corners of a line.
    held: Vec<Vec<[f64; 2]>>,
}

impl SolutionMap {
    /// Map of a pair of the finest level under a law.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(
        title: String,
        (levels, law): (&dyn Levels, Law),
        pair: &Pair,
    ) -> Result<Self, String> {
        let in_space = "a solution in space has no picture";
        let Drawing { mesh, nodes } = levels.drawing(2 * MOST_CELLS).ok_or(in_space)?;
        let mut is_held = vec![false; pair.y.len()];
        for (contact, holds) in levels.contact().iter().zip(levels.in_contact(law, pair)) {
            is_held[contact.node] = holds;
        }
        let mut held = Vec::new();
        let mut boundary = Vec::new();
        for curve in levels.curves().ok_or(in_space)? {
            add_held(&mut held, &curve, &is_held);
            boundary.push(curve.points);
        }
        let v = nodes.iter().map(|&node| pair.y[node]).collect();
        Ok(Self { title, law, mesh, v, boundary, held })
    }

    /// Draws the map below its title, above a colour bar and the words of the law.
    pub(crate) fn picture(&self) -> Picture {
        let layout = layout(1);
        let (width, height) = layout.size();
        let mut picture = Picture::new(width, height + 22.0);
        picture.refuse_unless_finite(&self.v);
        let [x, y] = square_around(&self.mesh);
        let frame = layout.frame(0, x, y);
        title(&mut picture, &frame, &fitting(&self.title, LARGE, width));
        let bands = Bands::of(&self.v);
        self.draw(&mut picture, &frame, &bands);
        draw_axes(&mut picture, &frame);
        let (across, top) = below(&layout, 420.0);
        bands.draw_bar(&mut picture, across, top);
        picture.group("stroke-linecap=\"round\"", |picture| {
            let words = held(self.law);
            let line = 28.0;
            let (x, y) = (0.5 * (width - line - 10.0 - text_width(words, SMALL)), top + 46.0);
            picture.path([(x, y), (x + line, y)], CONTACT, BOUNDARY_WIDTHS[1]);
            key(picture, (x + line + 10.0, y), words);
        });
        picture
    }

    fn draw(&self, picture: &mut Picture, frame: &Frame, bands: &Bands) {
        picture.group(BAND_LINES, |picture| {
            for (level, color) in bands.levels() {
                let borders = AtLevel { mesh: &self.mesh, values: &self.v, level }.borders();
                let loops = borders.iter().map(|border| places(frame, border));
                picture.region(loops.filter(|places| places.len() > 2), color);
            }
        });
        let [thin, thick] = BOUNDARY_WIDTHS;
        for curve in &self.boundary {
            let mut places = places(frame, curve);
            places.extend(places.first().copied());
            picture.path(places, INK, thin);
        }
        picture.group("stroke-linecap=\"round\"", |picture| {
            for line in &self.held {
                picture.path(places(frame, line), CONTACT, thick);
            }
        });
    }
}

/// Adds the parts of a curve on which nodes are held: where the law holds on an edge, each of its ends stands for the
/// half of the edge beside it.
fn add_held(held: &mut Vec<Vec<[f64; 2]>>, curve: &ClosedCurve, is_held: &[bool]) {
    let count = curve.nodes.len();
    let first = held.len();
    for k in (0..count).filter(|&k| curve.has_law[k]) {
        let ends = [k, (k + 1) % count];
        let [p, q] = ends.map(|end| curve.points[end]);
        let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        let [from, to] = match ends.map(|end| is_held[curve.nodes[end]]) {
            [true, true] => [p, q],
            [true, false] => [p, middle],
            [false, true] => [middle, q],
            [false, false] => continue,
        };
        match held[first..].last_mut() {
            Some(line) if line.last() == Some(&from) => line.push(to),
            _ => held.push(vec![from, to]),
        }
    }
}

/// Returns the places of points in a picture, without those that lie between their neighbours.
fn places(frame: &Frame, points: &[[f64; 2]]) -> Vec<Place> {
    let mut kept: Vec<Place> = Vec::new();
    for (k, &[x, y]) in points.iter().enumerate() {
        let place = frame.at(x, y);
        let next = points.get(k + 1).map(|&[x, y]| frame.at(x, y));
        let is_between = match (kept.last(), next) {
            (Some(&last), Some(next)) => lies_between(place, [last, next]),
            _ => false,
        };
        if !is_between {
            kept.push(place);
        }
    }
    kept
}

/// True if a place lies between two others, up to [`ON_LINE`].
fn lies_between((x, y): Place, [(x0, y0), (x1, y1)]: [Place; 2]) -> bool {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length = (dx * dx + dy * dy).sqrt();
    let along = (x - x0) * dx + (y - y0) * dy;
    let across = (x - x0) * dy - (y - y0) * dx;
    (0.0..=length * length).contains(&along) && across.abs() <= ON_LINE * length
}

/// Bands of colour between isolines.
struct Bands {
    colours: ColourScale,
    /// Values of v on the isolines, ascending.
    isolines: Vec<f64>,
}

impl Bands {
    fn of(v: &[f64]) -> Self {
        let (low, high) = match range_with_zero(v.iter().copied()) {
            range if range.0 < range.1 => range,
            _ => (-1.0, 1.0),
        };
        let ticks = Ticks::inside(low, high, ISOLINES);
        let isolines = ticks.values().filter(|value| low < *value && *value < high).collect();
        Self { colours: ColourScale::Viridis { low, high }, isolines }
    }

    /// Lower end of each band, minus infinity for the first, with the colour of its middle.
    fn levels(&self) -> impl Iterator<Item = (f64, RGBColor)> + '_ {
        let (low, high) = self.colours.range();
        let ends = self.isolines.iter().copied();
        let lower = [f64::NEG_INFINITY].into_iter().chain(ends.clone());
        lower
            .zip(ends.chain([high]))
            .map(move |(lower, upper)| (lower, self.colours.color(0.5 * (lower.max(low) + upper))))
    }

    /// Draws the bands side by side, with numbers below and the name of v to the left.
    fn draw_bar(&self, picture: &mut Picture, across: (f64, f64), top: f64) {
        let range = self.colours.range();
        let frame = Frame { across, down: (top, top + 12.0), x: range, y: (0.0, 1.0) };
        for (lower, color) in self.levels() {
            // Each band reaches to the end: the next covers the rest, and no seam shows.
            frame.band(picture, (lower.max(range.0), range.1), color);
        }
        frame.outline(picture);
        frame.label_below(picture, Ticks::inside(range.0, range.1, ISOLINES / 2).labelled());
        picture.text("v", (across.0 - 10.0, top + 6.0), italic(NORMAL).pos(END));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::samples::svg;
    use signorini_mathematics::levels::Problem;
    use signorini_mathematics::mesh::{AnyMesh, Condition};
    use signorini_mathematics::solvers::{self, Run, Settings, Solver};

    fn map(problem: &Problem) -> SolutionMap {
        let Run { y, judgement, .. } =
            solvers::solve(problem, &Settings::of(Solver::Multigrid)).unwrap();
        let pair = Pair { a: judgement.multiplier(&y), y };
        SolutionMap::of("t".into(), (problem.levels(), problem.law()), &pair).unwrap()
    }

    fn on(name: &str, times: usize, f: &str, law: Law) -> Problem {
        Problem::on_mesh(&AnyMesh::built_in(name).unwrap(), times, f, law).unwrap()
    }

    /// Length of the lines that are held.
    fn length(map: &SolutionMap) -> f64 {
        let edges = map.held.iter().flat_map(|line| line.windows(2));
        edges.map(|edge| libm::hypot(edge[1][0] - edge[0][0], edge[1][1] - edge[0][1])).sum()
    }

    #[test]
    fn every_domain_in_the_plane_has_isolines_and_its_contact() {
        for name in ["square", "disc", "lshape", "annulus"] {
            let all = map(&on(name, 2, "else=-1", Law::SIGNORINI));
            let boundary: f64 = all
                .boundary
                .iter()
                .map(|curve| {
                    let next = curve.iter().cycle().skip(1);
                    let edges = curve.iter().zip(next);
                    edges.map(|([ax, ay], [bx, by])| libm::hypot(bx - ax, by - ay)).sum::<f64>()
                })
                .sum();
            assert!((length(&all) - boundary).abs() < 1e-12 * boundary, "{name}");
            let bands = Bands::of(&all.v);
            assert!(bands.isolines.len() > 3, "{name}");
            let svg = svg(&all.picture());
            assert_eq!(svg.matches("<path").count(), bands.isolines.len() + 1, "{name}");
            assert!(svg.contains(">in contact (multiplier a &gt; 0)</text>"), "{name}");
            assert!(!svg.contains("dimensionless"));
        }
    }

    #[test]
    fn a_part_without_the_law_is_not_held() {
        for condition in [Condition::Free, Condition::Fixed] {
            let mut annulus = AnyMesh::built_in("annulus").unwrap();
            annulus.set_condition("inner", condition).unwrap();
            let problem = Problem::on_mesh(&annulus, 1, "else=-1", Law::SIGNORINI).unwrap();
            let map = map(&problem);
            assert_eq!(map.held.len(), 1, "{condition:?}");
            assert!(map.held[0].iter().all(|[x, y]| libm::hypot(*x, *y) > 0.99), "{condition:?}");
        }
    }

    #[test]
    fn a_single_node_that_sticks_is_drawn_with_the_half_edges_beside_it() {
        let f = "halfplane(1,0,0)=8; else=-8";
        let problem = on("square", 3, f, Law::friction(0.5).unwrap());
        let map = map(&problem);
        let share = length(&map) / problem.levels().width();
        assert!(share > 0.5 && share < 4.0, "{share}");
        assert!(svg(&map.picture()).contains(">sticks (v = 0)</text>"));
    }

    #[test]
    fn a_constant_solution_has_one_colour() {
        let mut flat = map(&on("disc", 1, "else=-1", Law::SIGNORINI));
        flat.v.fill(0.0);
        let svg = svg(&flat.picture());
        assert!(svg.contains("<path"));
        flat.v[0] = f64::NAN;
        assert!(flat.picture().svg("t", "d").is_err());
    }
}
