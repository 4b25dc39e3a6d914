//! Maps of solutions on domains in the plane: v in bands of colour between isolines, and the boundary by its state.

use super::axes::{Frame, key};
use super::drawn::DrawnSolution;
use super::fixed;
use super::isolines::{AtLevel, Loop};
use super::maps::{BAR, bar_below, draw_maps, layout_around};
use super::palette::{CONTACT, ColourScale, INK, RGBColor};
use super::picture::{NORMAL, Picture, Place, SMALL, italic, text_width};
use super::polyline::simplified;
use super::text::Ticks;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::saddle::Pair;

/// Most isolines.
const ISOLINES: usize = 12;
/// Attributes of bands: thin light lines along their borders, of the same colour on either page.
const BAND_LINES: &str =
    "fill-rule=\"evenodd\" stroke=\"#FEFEFE\" stroke-opacity=\"0.6\" stroke-width=\"2\"";
/// Widths of the boundary, and of the parts of it that are held, in display pixels.
const BOUNDARY_WIDTHS: [f64; 2] = [1.0, 4.0];
/// Height of the key.
const KEY_HEIGHT: f64 = 22.0;
/// Length of a line of the key, and the room behind it and behind its words.
const KEY: [f64; 3] = [28.0, 10.0, 24.0];

/// Solution on the mesh of a picture, with the boundary of the finest level.
pub struct SolutionMap {
    drawn: DrawnSolution,
    /// Closed curves of the boundary.
    boundary: Vec<Loop>,
    /// Parts of the boundary that stick, each as the corners of a line.
    held: Vec<Vec<[f64; 2]>>,
    /// Fixed parts of the boundary.
    fixed: Vec<Vec<[f64; 2]>>,
}

impl SolutionMap {
    /// Map of a pair of the finest level.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub fn of(title: String, problem: &Problem, pair: &Pair) -> Result<Self, String> {
        let drawn = DrawnSolution::of(title, problem, pair, 1)?;
        let is_held = problem.at_nodes(&problem.in_contact(pair), false);
        let (mut held, mut fixed, mut boundary) = (Vec::new(), Vec::new(), Vec::new());
        for curve in problem.levels().boundary() {
            let (points, nodes) = (&curve.points, &curve.nodes);
            for (k, law) in curve.laws.iter().enumerate() {
                let ends = [k, (k + 1) % points.len()];
                let edge = ends.map(|k| points[k]);
                if law.is_fixed() {
                    add(&mut fixed, edge);
                } else if law.may_move() {
                    let part = held_part(edge, ends.map(|k| is_held[nodes[k]]));
                    part.into_iter().for_each(|part| add(&mut held, part));
                }
            }
            boundary.push(curve.points);
        }
        Ok(Self { drawn, boundary, held, fixed })
    }

    /// Draws the map below its title, above a colour bar and the words of the law.
    pub fn picture(&self) -> Picture {
        let (layout, ranges) = layout_around(&self.drawn.mesh, &self.drawn.title);
        let bands = bands(&self.drawn);
        let mut picture =
            draw_maps(&layout, |_| ranges, |picture, frame, _| self.draw(picture, frame, &bands));
        picture.refuse_unless_finite(&self.drawn.y);
        picture.height += KEY_HEIGHT;
        let (bar, range) = (bar_below(&layout, BAR), self.drawn.range_of_colours());
        let numbers = Ticks::inside(range.0, range.1, ISOLINES / 2);
        let lower = bands.iter().map(|&(lower, color)| (lower.max(range.0), color));
        bar.draw(&mut picture, range, lower, numbers.labelled());
        bar.name(&mut picture, "v", italic(NORMAL));
        let middle = 0.5 * picture.width;
        self.draw_key(&mut picture, (middle, bar.top + 46.0));
        picture
    }

    /// Draws the words for the parts of the boundary that are held, centred.
    fn draw_key(&self, picture: &mut Picture, (middle, y): Place) {
        let parts = self.drawn.mesh.parts().iter();
        let fixed = fixed(parts.map(|part| part.law)).filter(|_| !self.fixed.is_empty());
        let fixed = fixed.map(|words| (INK, words));
        let entries: Vec<_> = [(CONTACT, self.drawn.held)].into_iter().chain(fixed).collect();
        let [line, gap, behind] = KEY;
        let widths =
            entries.iter().map(|(_, words)| line + gap + text_width(words, SMALL) + behind);
        let mut x = middle - 0.5 * (widths.sum::<f64>() - behind);
        picture.group("stroke-linecap=\"round\"", |picture| {
            for (color, words) in entries {
                picture.path([(x, y), (x + line, y)], color, BOUNDARY_WIDTHS[1]);
                x = key(picture, (x + line + gap, y), words) + behind;
            }
        });
    }

    fn draw(&self, picture: &mut Picture, frame: &Frame, bands: &[(f64, RGBColor)]) {
        picture.group(BAND_LINES, |picture| {
            for &(level, color) in bands {
                let borders =
                    AtLevel { mesh: &self.drawn.mesh, values: &self.drawn.y, level }.borders();
                // A region is closed by itself.
                let loops = borders.iter().map(|border| {
                    let mut places = places(frame, closed(border));
                    places.pop();
                    places
                });
                picture.region(loops.filter(|places| places.len() > 2), color);
            }
        });
        let [thin, thick] = BOUNDARY_WIDTHS;
        for curve in &self.boundary {
            picture.path(places(frame, closed(curve)), INK, thin);
        }
        picture.group("stroke-linecap=\"round\"", |picture| {
            for (lines, color) in [(&self.fixed, INK), (&self.held, CONTACT)] {
                for line in lines {
                    picture.path(places(frame, line.iter().copied()), color, thick);
                }
            }
        });
    }
}

/// Returns the part of an edge of a curve that sticks: each end stands for the half of the
/// edge beside it.
fn held_part([p, q]: [[f64; 2]; 2], is_held: [bool; 2]) -> Option<[[f64; 2]; 2]> {
    let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
    match is_held {
        [true, true] => Some([p, q]),
        [true, false] => Some([p, middle]),
        [false, true] => Some([middle, q]),
        [false, false] => None,
    }
}

/// Adds a segment to the last line if it goes on from there.
fn add(lines: &mut Vec<Vec<[f64; 2]>>, [from, to]: [[f64; 2]; 2]) {
    match lines.last_mut() {
        Some(line) if line.last() == Some(&from) => line.push(to),
        _ => lines.push(vec![from, to]),
    }
}

/// Returns the places of points in a picture, without those that would not be missed.
fn places(frame: &Frame, points: impl IntoIterator<Item = [f64; 2]>) -> Vec<Place> {
    let places: Vec<Place> = points.into_iter().map(|[x, y]| frame.at(x, y)).collect();
    simplified(&places)
}

/// Returns the points of a closed curve, with the first one again at the end.
fn closed(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    points.iter().chain(points.first()).copied()
}

/// Returns the bands of colour between isolines: the lower end of each, minus infinity for the first, with the colour
/// of its middle.
fn bands(drawn: &DrawnSolution) -> Vec<(f64, RGBColor)> {
    let (low, high) = drawn.range_of_colours();
    let colours = ColourScale::Viridis { low, high };
    let ticks = Ticks::inside(low, high, ISOLINES);
    let isolines = ticks.values().filter(|value| low < *value && *value < high);
    let isolines: Vec<f64> = isolines.collect();
    let lower = [f64::NEG_INFINITY].into_iter().chain(isolines.clone());
    let bands = lower.zip(isolines.into_iter().chain([high]));
    bands.map(|(from, to)| (from, colours.color(0.5 * (from.max(low) + to)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FIXED;
    use crate::polyline::farthest;
    use crate::samples::svg;
    use signorini_mathematics::mesh::AnyMesh;
    use signorini_mathematics::problem::law::Law;
    use signorini_mathematics::solvers::{self, Run, Settings, Solver};

    fn map(problem: &Problem) -> SolutionMap {
        let Run { y, judgement, .. } =
            solvers::solve(problem, &Settings::of(Solver::Multigrid)).unwrap();
        let pair = Pair { a: judgement.multiplier(&y), y };
        SolutionMap::of("t".into(), problem, &pair).unwrap()
    }

    fn on(name: &str, times: usize, f: &str, law: Law) -> Problem {
        Problem::on_mesh(&AnyMesh::built_in(name).unwrap().with_law(law), times, f).unwrap()
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
            let bands = bands(&all.drawn);
            assert!(bands.len() > 4, "{name}");
            let svg = svg(&all.picture());
            assert_eq!(svg.matches("<path").count(), bands.len(), "{name}");
            assert!(svg.contains(">in contact (multiplier a &gt; 0)</text>"), "{name}");
            assert!(!svg.contains("dimensionless"));
        }
    }

    #[test]
    fn a_part_without_the_law_is_not_held() {
        for law in [Law::FREE, Law::FIXED] {
            let mut annulus = AnyMesh::built_in("annulus").unwrap();
            annulus.set_law("inner", law).unwrap();
            let problem = Problem::on_mesh(&annulus, 1, "else=-1").unwrap();
            let map = map(&problem);
            assert_eq!(map.held.len(), 1, "{law:?}");
            assert!(map.held[0].iter().all(|[x, y]| libm::hypot(*x, *y) > 0.99), "{law:?}");
        }
    }

    #[test]
    fn a_single_node_that_sticks_is_drawn_with_the_half_edges_beside_it() {
        let f = "halfplane(1,0,0)=8; else=-8";
        let problem = on("square", 3, f, Law::friction(0.5).unwrap());
        let map = map(&problem);
        let share = length(&map) / problem.levels().facts().width;
        assert!(share > 0.5 && share < 4.0, "{share}");
        assert!(svg(&map.picture()).contains(">sticks (v = 0)</text>"));
    }

    /// Places of the lines of a picture with this colour and width, in display pixels.
    fn lines(svg: &str, RGBColor(r, g, b): RGBColor, width: f64) -> Vec<Vec<Place>> {
        let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\" stroke-width=\"{}\"", 4.0 * width);
        let drawn =
            svg.lines().filter(|line| line.starts_with("<polyline") && line.contains(&stroke));
        let points = drawn.map(|line| line.split("points=\"").nth(1).unwrap().split('"').next());
        points.map(|points| points.unwrap().split_whitespace().map(place).collect()).collect()
    }

    /// Place from its coordinates in pixels of the canvas.
    fn place(point: &str) -> Place {
        let (x, y) = point.split_once(',').unwrap();
        [x, y].map(|number| 0.25 * number.parse::<f64>().unwrap()).into()
    }

    /// Points of an ellipse, as many as a disc refined so many times has nodes on its boundary.
    fn ellipse(times: u32, [a, b]: [f64; 2]) -> Loop {
        let count = 8 << times;
        let angles =
            (0..count).map(|k| 2.0 * std::f64::consts::PI * f64::from(k) / f64::from(count));
        angles.map(|angle| [a * libm::cos(angle), b * libm::sin(angle)]).collect()
    }

    #[test]
    fn every_node_of_the_boundary_is_within_half_a_pixel_of_what_is_drawn_however_fine_the_mesh() {
        let [thin, thick] = BOUNDARY_WIDTHS;
        for times in 4..=9 {
            let mut map = map(&on("annulus", 1, "else=-1", Law::SIGNORINI));
            let [outer, inner] = [[1.0, 1.0], [0.5, 0.4]].map(|axes| ellipse(times, axes));
            map.held = vec![outer[..outer.len() / 2].to_vec()];
            map.fixed = vec![inner.clone()];
            map.boundary = vec![outer, inner];
            let (layout, [x, y]) = layout_around(&map.drawn.mesh, "t");
            let frame = layout.frame(0, x, y);
            let svg = svg(&map.picture());
            for (given, color, width) in
                [(&map.boundary, INK, thin), (&map.held, CONTACT, thick), (&map.fixed, INK, thick)]
            {
                for (points, line) in given.iter().zip(lines(&svg, color, width)) {
                    let places: Vec<Place> = points.iter().map(|&[x, y]| frame.at(x, y)).collect();
                    let off = farthest(&places, &line);
                    assert!(
                        off < 0.5 && line.len() < 150,
                        "{times}: {off}, {} corners",
                        line.len()
                    );
                }
            }
        }
    }

    #[test]
    fn a_straight_domain_keeps_its_few_corners() {
        for (name, corners) in [("square", 4), ("lshape", 6)] {
            let svg = svg(&map(&on(name, 5, "else=-1", Law::SIGNORINI)).picture());
            let outline = &lines(&svg, INK, BOUNDARY_WIDTHS[0])[0];
            // The line begins at a node, and returns to it.
            assert!([corners + 1, corners + 2].contains(&outline.len()), "{name}: {outline:?}");
        }
    }

    #[test]
    fn a_round_domain_has_its_contact_on_its_boundary() {
        let map = map(&on("disc", 6, "halfplane(0,1,0)=-3; else=1.5", Law::SIGNORINI));
        let (layout, [x, y]) = layout_around(&map.drawn.mesh, "t");
        let [centre, edge] = [0.0, 1.0].map(|at| layout.frame(0, x, y).at(at, 0.0));
        let contact = &lines(&svg(&map.picture()), CONTACT, BOUNDARY_WIDTHS[1])[0];
        for pair in contact.windows(2) {
            let middle = (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
            let radius = libm::hypot(middle.0 - centre.0, middle.1 - centre.1);
            assert!((radius - (edge.0 - centre.0)).abs() < 0.5, "{radius}");
        }
    }

    #[test]
    fn fixed_parts_are_marked_and_named() {
        let mut annulus = AnyMesh::built_in("annulus").unwrap();
        let contact = Problem::on_mesh(&annulus, 1, "else=-1").unwrap();
        assert!(!svg(&map(&contact).picture()).contains(FIXED[0]));
        annulus.set_law("inner", Law::FIXED).unwrap();
        let fixed = Problem::on_mesh(&annulus, 1, "else=-1").unwrap();
        let svg = svg(&map(&fixed).picture());
        assert!(svg.contains(&format!(">{}</text>", FIXED[0])));
        // The part itself, and its key.
        assert_eq!(lines(&svg, INK, BOUNDARY_WIDTHS[1]).len(), 2);
    }

    #[test]
    fn a_contact_shorter_than_a_pixel_is_a_dot() {
        let mut map = map(&on("square", 1, "else=-1", Law::SIGNORINI));
        map.held = vec![vec![[0.5, 0.0], [0.5, 1e-6], [0.5, 2e-6]]];
        let dot = lines(&svg(&map.picture()), CONTACT, BOUNDARY_WIDTHS[1]).swap_remove(0);
        assert!(dot.len() == 2 && dot[0] == dot[1], "{dot:?}");
    }

    #[test]
    fn a_constant_solution_has_one_colour() {
        let mut flat = map(&on("disc", 1, "else=-1", Law::SIGNORINI));
        flat.drawn.y.fill(0.0);
        let svg = svg(&flat.picture());
        assert!(svg.contains("<path"));
        flat.drawn.y[0] = f64::NAN;
        assert!(flat.picture().svg("t", "d").is_err());
    }
}
