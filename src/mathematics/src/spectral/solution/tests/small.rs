//! Strong f on small shapes: brackets against closed forms, and against those of other sizes.

use super::*;
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::geometry::panels::gauss;

/// Guaranteed bracket where all sticks.
fn bracket_of(domain: &PlaneDomain, source: PlaneSource) -> [f64; 2] {
    let start = PlaneStart { contact: vec![RingContact::default()], spacing: 1e-3 };
    let problem = PlaneProblem { domain: domain.clone(), source };
    let found = solve(&problem, &start, &mut Effort::default()).unwrap();
    let [lower, upper] = found.bracket.unwrap();
    assert!(lower <= found.energy && found.energy <= upper, "{lower} {} {upper}", found.energy);
    [lower, upper]
}

/// Checks that a bracket holds an energy, but for rounding of that, and is narrow.
fn check(name: &str, bracket: [f64; 2], energy: f64) {
    check_width(name, bracket, energy, 1e-10);
}

fn check_width(name: &str, [lower, upper]: [f64; 2], energy: f64, width: f64) {
    let rounding = 4e-15 * energy.abs();
    let text = format!("{name}: [{lower}, {upper}] {energy}");
    assert!(lower - rounding <= energy && energy <= upper + rounding, "{text}");
    assert!(upper - lower < width * energy.abs(), "{text}");
}

fn disc() -> PlaneDomain {
    PlaneDomain::new(vec![circle(1.0, Law::SIGNORINI, true)]).unwrap()
}

#[test]
fn the_energy_of_a_disc_depends_on_its_radius_as_newton_says() {
    let cases = [
        (lshape(), [-0.41, 0.37], 1.7, -3.0),
        (triangle(), [0.52, 0.41], -1.7, -3.0),
        (disc(), [-0.3, 0.6], 0.7, -3.0),
        (disc(), [0.0, 0.0], -2.0, 0.0),
    ];
    for (domain, [x, y], weight, background) in cases {
        let mut constant: Option<f64> = None;
        for k in 2..10 {
            let radius = libm::pow(10.0, -f64::from(k));
            let area = PI * radius * radius;
            let f = background + weight / area;
            let source = format!("disc({x},{y},{radius})={f}; else={background}");
            // W^2 / 4 pi ln e + b W e^2 / 8, with W as it is rounded.
            let weight = (f - background) * area;
            let own = weight * weight / (4.0 * PI) * libm::log(radius);
            let with = own + background * weight * radius * radius / 8.0;
            let ends = bracket_of(&domain, pieces(&source));
            let first = constant.get_or_insert(0.5 * (ends[0] + ends[1]) - with);
            let width = ends[1] - ends[0];
            let text = format!("{source}: {ends:?} {}", *first + with);
            // The constant is that of a bracket as wide.
            assert!(ends[0] - width <= *first + with && *first + with <= ends[1] + width, "{text}");
            assert!(width < 2e-11 * ends[0].abs(), "{text}");
        }
    }
}

/// Weight, radius, and place of a disc in the unit disc.
type Weighted = (f64, f64, [f64; 2]);

/// `-1/2 int f v` on the unit disc with f = b but for discs apart from each other, or one inside of the next and with
/// its middle, by Green's function and the mean values of harmonic functions.
fn with_discs(b: f64, discs: &[Weighted]) -> f64 {
    let mut sum = b * b * PI / 8.0;
    for (k, &(weight, radius, [x, y])) in discs.iter().enumerate() {
        let rest = 1.0 - x * x - y * y;
        sum += 0.5 * weight * b * (rest - 0.5 * radius * radius);
        sum += weight * weight / (2.0 * PI) * (libm::log(rest / radius) + 0.25);
        for &(other, outer, [s, t]) in &discs[k + 1..] {
            let away = libm::hypot(x - s, y - t);
            let image = libm::hypot(1.0 - x * s - y * t, x * t - y * s);
            let inside = 0.5 - 0.25 * radius * radius / (outer * outer);
            let log = if away == 0.0 { inside - libm::log(outer) } else { -libm::log(away) };
            sum += weight * other / PI * (libm::log(image) + log);
        }
    }
    -0.5 * sum
}

#[test]
fn discs_beside_and_inside_each_other_have_the_energy_of_greens_function() {
    let cases: [(f64, &[Weighted]); 6] = [
        (-1.0, &[(-2.0, 1e-9, [0.5, 0.0])]),
        (-1.0, &[(-2.0, 1e-7, [0.5, 0.0]), (-2.0, 1e-7, [-0.3, 0.2])]),
        (-1.0, &[(-2.0, 1e-9, [0.5, 0.0]), (-1.0, 3e-5, [0.5, 0.0])]),
        (-1.0, &[(-2.0, 1e-8, [0.5, 0.1]), (3.0, 1e-4, [0.5, 0.1]), (-4.0, 0.1, [0.5, 0.1])]),
        (0.0, &[(-2.0, 1e-5, [0.5, 0.0]), (-2.0, 1e-5, [0.5, 3e-5])]),
        (-4.0, &[(-2.0, 1e-6, [0.1, 0.0]), (1.0, 0.2, [0.1, 0.0]), (1.0, 1e-3, [-0.7, 0.0])]),
    ];
    for (b, discs) in cases {
        let (mut f, mut exact) = (format!("else={b}"), discs.to_vec());
        // The last that holds a point counts.
        for (k, &(weight, radius, [x, y])) in discs.iter().enumerate() {
            let own = weight / (PI * radius * radius);
            let around = discs[k + 1..].iter().filter(|(_, _, place)| *place == [x, y]);
            let around: f64 = around.map(|(w, r, _)| w / (PI * r * r)).sum::<f64>() + b;
            let value = around + own;
            exact[k].0 = (value - around) * (PI * radius * radius);
            f = format!("disc({x},{y},{radius})={value}; {f}");
        }
        check(&f, bracket_of(&disc(), pieces(&f)), with_discs(b, &exact));
    }
}

/// `-1/2 int f v` on the unit disc with f = b but for a rectangle with sides a and c, where it is larger by a jump, by
/// Green's function.
fn with_rectangle(b: f64, jump: f64, [left, right, low, high]: [f64; 4]) -> f64 {
    let (long, short) = ((right - left).max(high - low), (right - left).min(high - low));
    let rule = gauss(48);
    // Integral of the logarithms of all distances: along the longer sides in closed form.
    let mut logs = 0.0;
    for node in rule {
        // Short steps where it is least smooth.
        let t = short * node.x.powi(3);
        let square = long * long + t * t;
        let along = long * (long * libm::log(square) - 2.0 * long + 2.0 * t * libm::atan(long / t))
            - 0.5 * (square * libm::log(square) - t * t * libm::log(t * t) - long * long);
        logs += 6.0 * short * node.x * node.x * node.weight * (short - t) * along;
    }
    let rule = gauss(14);
    let mut points = Vec::new();
    for one in rule {
        for other in rule {
            let [x, y] = [left + (right - left) * one.x, low + (high - low) * other.x];
            points.push((Complex::new(x, y), one.weight * other.weight));
        }
    }
    let area = long * short;
    let (mut images, mut rest) = (0.0, 0.0);
    for &(z, weight) in &points {
        rest += weight * area * 0.25 * (1.0 - z.norm2());
        for &(w, other) in &points {
            let image = (Complex::new(1.0, 0.0) - z * w.conj()).norm();
            images += weight * other * area * area * libm::log(image);
        }
    }
    let own = jump * jump / (2.0 * PI) * (images - logs);
    -0.5 * (b * b * PI / 8.0 + 2.0 * b * jump * rest + own)
}

#[test]
fn rectangles_of_all_widths_have_the_energy_of_greens_function() {
    for [left, length, low, width] in [
        [-0.5, 0.75, 0.25, 1e-2],
        [-0.5, 0.75, 0.25, 1e-4],
        [-0.5, 0.75, 0.25, 1e-6],
        [-0.5, 0.75, 0.25, 1e-9],
        [0.3, 1e-2, -0.2, 1e-2],
        [0.3, 1e-4, -0.2, 3e-4],
        [0.3, 1e-6, -0.2, 1e-6],
        [0.3, 1e-9, -0.2, 2e-9],
    ] {
        let place = [left, left + length, low, low + width];
        let area = (place[1] - place[0]) * (place[3] - place[2]);
        let f = -1.0 - 2.0 / area;
        let [x, to, y, up] = place;
        let text = format!("rect({x},{to},{y},{up})={f}; else=-1");
        check(&text, bracket_of(&disc(), pieces(&text)), with_rectangle(-1.0, f + 1.0, place));
    }
}

#[test]
fn shapes_across_a_weak_jump_have_the_energy_of_its_even_and_odd_parts() {
    // The odd part, 1 on the right and -1 on the left, but for the cube of the width of the shape: St. Venant.
    let odd = -0.5 * (PI / 4.0 - 2.0 / PI);
    for e in [1e-5, 1e-7] {
        // Points of the weak jump are off by rounding, next to the shape.
        let width = 1e-15 / e;
        let f = -2.0 - 2.0 / (PI * e * e);
        let text = format!("halfplane(1,0,0)=-3; disc(0,0.3,{e})={f}; else=-1");
        let even = with_discs(-2.0, &[((f + 2.0) * PI * e * e, e, [0.0, 0.3])]);
        check_width(&text, bracket_of(&disc(), pieces(&text)), even + odd, width);
        let place = [-e, e, 0.3, 0.3 + 2.0 * e];
        let [x, to, y, up] = place;
        let f = -2.0 - 2.0 / ((to - x) * (up - y));
        let text = format!("halfplane(1,0,0)=-3; rect({x},{to},{y},{up})={f}; else=-1");
        let even = with_rectangle(-2.0, f + 2.0, place);
        check_width(&text, bracket_of(&disc(), pieces(&text)), even + odd, width);
    }
}

/// Borders of a region, in the unit disc beside another one, between corners.
fn region(corners: &[Complex], f: f64) -> PlaneSource {
    let (many, mut borders) = (corners.len(), Vec::new());
    for k in 0..many {
        let ends = [corners[k], corners[(k + 1) % many]].map(Complex::coordinates);
        let side = PlaneSide::segment(ends, Law::FREE, 0);
        borders.push(RegionBorder { side, regions: [Some(0), Some(1)] });
    }
    let boundary = &circle(1.0, Law::SIGNORINI, true)[0];
    borders.push(RegionBorder { side: *boundary, regions: [Some(1), None] });
    let pieces = [format!("else={f}"), "else=-1".into()].map(|f| f.parse().unwrap()).to_vec();
    PlaneSource::Pieces(Regions { borders, pieces })
}

#[test]
fn turned_regions_have_the_energy_of_rectangles() {
    for width in [1e-2, 1e-3, 1e-4, 1e-6] {
        let place = [0.3, 0.3 + width, -0.2, -0.2 + 2.0 * width];
        let [x, to, y, up] = place;
        let f = -1.0 - 2.0 / (2.0 * width * width);
        let turn = Complex::new(0.8, 0.6);
        let corners = [[x, y], [to, y], [to, up], [x, up]];
        let corners = corners.map(|[x, y]| turn * Complex::new(x, y));
        let [lower, upper] = bracket_of(&disc(), region(&corners, f));
        let energy = with_rectangle(-1.0, f + 1.0, place);
        // Corners are off by rounding.
        check_width("turned", [lower, upper], energy, 1e-10 + 1e-13 / width);
    }
}

/// The energy, where all sticks, is a quadratic polynomial in the value of f on a shape: its third difference is zero.
#[test]
fn shapes_across_a_jump_may_lie_between_its_values() {
    for shape in ["rect(0.13,0.17,-0.2,0.25)", "disc(0.2,0.01,0.04)"] {
        let [mut low, mut high, mut size] = [0.0f64; 3];
        // -7 differs from f on both sides of the jump by as much, with both signs.
        for (value, factor) in [(-19.0, 1.0), (-13.0, -3.0), (-7.0, 3.0), (-1.0, -1.0)] {
            let f = format!("{shape}={value}; halfplane(0.1,1,0.03)=-4; else=-10");
            let [a, b] = bracket_of(&disc(), pieces(&f)).map(|end| factor * end);
            low += a.min(b);
            high += a.max(b);
            size += a.abs();
        }
        assert!(low <= 0.0 && 0.0 <= high, "{shape}: [{low}, {high}]");
        assert!(high - low < 1e-9 * size, "{shape}: [{low}, {high}]");
    }
}
