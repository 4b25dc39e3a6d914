//! Which functions are fitted: at corners, ends of contact and crossings, at mirror images, in holes, behind sides.

use crate::problem::complex::Complex;
use crate::spectral::functions::{Family, Functions, Hole, Power};
use crate::spectral::geometry::boundary::{Split, State, Walk};
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::images::{Image, MedialDisc, images_across};
use crate::spectral::geometry::way_out::middle;
use crate::spectral::setup::{Level, Setup};
use std::f64::consts::PI;

/// Power below which a singular function counts.
const WEAKEST: f64 = 4.5;
/// Most powers of a corner.
const MOST: usize = 4;
/// Longest cut of an end beside a corner, in distances from it: farther away both look like the corner.
const BESIDE: f64 = 100.0;

impl Functions {
    /// Functions for one contact set.
    pub(crate) fn chosen(setup: &Setup, walk: &Walk, level: &Level) -> Self {
        let splits = 0..walk.splits.len();
        let mut families: Vec<Family> =
            splits.filter_map(|k| at_split(setup, walk, k, level)).collect();
        families.extend(setup.images.iter().map(|image| at_image(setup, image, level)));
        families.extend(walk.splits.iter().flat_map(|split| corner_images(setup, split, level)));
        if level.poles > 0.0 {
            families.extend(poles(setup, level.poles));
        }
        families.retain(|family| !family.lengths.is_empty());
        Self { families, holes: holes(setup, level), arnoldi: Vec::new() }
    }
}

/// Functions at a split, none if the solution is smooth there.
fn at_split(setup: &Setup, walk: &Walk, k: usize, level: &Level) -> Option<Family> {
    let (split, size) = (&walk.splits[k], setup.diameter);
    let mut powers = powers(split);
    if powers.is_empty() {
        return None;
    }
    let near = split.lengths[0].min(split.lengths[1]);
    let plain = powers.iter().all(|power| power.log || power.power == 1.0);
    let (least, to) = if plain { (level.weak, 0.5) } else { (level.strong, 3.0) };
    let is_seen = walk.corner_beside(k).is_some() && BESIDE * near < to * size;
    let inner = near.min(clearance(&setup.domain, split.z));
    let ladder = Ladder {
        from: 0.5 * inner,
        ratio: level.ratio,
        to: if is_seen { BESIDE * near } else { to * size },
        least,
        most: usize::MAX,
    };
    let lengths = ladder.lengths(&setup.domain, split.z, split.inwards());
    if split.end.is_some() && !is_seen && lengths.iter().all(|&d| d < 0.5 * size) {
        // Cuts are short: more powers in their place.
        powers.extend([2.0, 2.5, 3.0, 3.5].map(Power::plain));
    }
    Some(Family { point: split.z, split: Some(k), inwards: split.inwards(), lengths, powers })
}

/// Functions at an image of a point where psi is singular.
fn at_image(setup: &Setup, image: &Image, level: &Level) -> Family {
    let powers = vec![
        Power::with_log(0.0),
        Power::plain(1.0),
        Power::with_log(1.0),
        Power::plain(2.0),
        Power::with_log(2.0),
    ];
    behind_boundary(setup, image, level, powers)
}

/// Functions with these powers at a point behind the boundary.
fn behind_boundary(setup: &Setup, image: &Image, level: &Level, powers: Vec<Power>) -> Family {
    let Image { point, inwards, distance } = *image;
    let (ratio, to) = (3.5, 0.3 * setup.diameter);
    let ladder = Ladder { from: distance, ratio, to, least: 1, most: level.image };
    let lengths = ladder.lengths(&setup.domain, point, inwards);
    Family { point, split: None, inwards, lengths, powers }
}

/// Powers and logarithms round the middle of each hole.
fn holes(setup: &Setup, level: &Level) -> Vec<Hole> {
    let holes = setup.domain.rings.iter().skip(1).map(|ring| {
        let middle = middle(ring);
        let radius =
            ring.sides.iter().map(|side| side.distance(middle)).fold(f64::INFINITY, f64::min);
        Hole { middle, radius, powers: level.hole }
    });
    holes.collect()
}

/// Powers at a split.
fn powers(split: &Split) -> Vec<Power> {
    let mut powers = if split.end.is_some() {
        [0.5, 1.0, 1.5].map(Power::plain).to_vec()
    } else if split.corner {
        corner_powers(split)
    } else {
        Vec::new()
    };
    if split.crossing {
        for power in [Power::plain(1.0), Power::with_log(2.0), Power::with_log(3.0)] {
            if !powers.contains(&power) {
                powers.push(power);
            }
        }
    }
    powers
}

/// Powers at a corner: multiples of pi over its angle, halves of odd ones where v = 0 on one side alone; logarithms
/// where these meet the whole powers of psi, and where the flux, or the slope of the value, differs from side to side.
fn corner_powers(split: &Split) -> Vec<Power> {
    let is_held = split.states.map(|state| state == State::Held);
    let mixed = is_held[0] != is_held[1];
    let (mut powers, mut resonant) = (Vec::new(), false);
    for k in 1..=40 {
        let power = PI / split.angle * (f64::from(k) - if mixed { 0.5 } else { 0.0 });
        let whole = power.round();
        resonant |= (whole == 2.0 || whole == 3.0) && (power - whole).abs() < 0.02;
        if power < WEAKEST && (power - whole).abs() > 1e-9 && powers.len() < MOST {
            powers.push(Power::plain(power));
        }
    }
    let [before, after] = split.formulas;
    let differs = match split.states {
        [State::Flux(a), State::Flux(b)] => a != b,
        [State::Flux(q), State::Held] => q != 0.0 || after.is_some(),
        [State::Held, State::Flux(q)] => q != 0.0 || before.is_some(),
        [State::Held, State::Held] => before != after,
    };
    if differs {
        powers.extend([Power::plain(1.0), Power::with_log(1.0)]);
    }
    if resonant {
        powers.extend([Power::with_log(2.0), Power::with_log(3.0)]);
    }
    powers
}

/// Lengths of cuts from a point outwards.
struct Ladder {
    from: f64,
    ratio: f64,
    to: f64,
    /// Least and greatest number.
    least: usize,
    most: usize,
}

impl Ladder {
    /// Lengths that keep the cut outside of the domain: below 0.55 of the way to the boundary, with an end that is
    /// away from it.
    fn lengths(&self, domain: &PlaneDomain, point: Complex, inwards: Complex) -> Vec<f64> {
        let longest = 0.55 * domain.exit(point, -inwards);
        let is_clear = |d: &f64| domain.distance(point - inwards.scaled(*d)) > 0.3 * d;
        let (mut lengths, first) = (Vec::new(), self.from.min(0.99 * longest));
        let mut d = first;
        while (d < self.to || lengths.len() < self.least)
            && lengths.len() < self.most
            && d < longest
        {
            lengths.extend(Some(d).filter(is_clear));
            d *= self.ratio;
        }
        d = first;
        for _ in 0..20 {
            d /= self.ratio.min(3.0);
            if lengths.len() < self.least && d < longest {
                lengths.extend(Some(d).filter(is_clear));
            }
        }
        lengths
    }
}

/// Functions at the images of a re-entrant corner behind the sides that it sees across the domain.
fn corner_images(setup: &Setup, split: &Split, level: &Level) -> Vec<Family> {
    /// Largest distance of such a side, in diameters.
    const NEAR: f64 = 0.25;
    if !split.corner || split.angle < 1.01 * PI {
        return Vec::new();
    }
    let images = images_across(&setup.domain, split.z, NEAR * setup.diameter).into_iter();
    images.map(|image| behind_boundary(setup, &image, level, powers(split))).collect()
}

/// Poles on the medial axis outside of the domain, `density` of them on the radius of each disc; fewer, or none, where
/// that is so long and narrow that they would be too many.
fn poles(setup: &Setup, mut density: f64) -> Vec<Family> {
    /// Most poles, and least density.
    const MOST_POLES: usize = 400;
    const LEAST: f64 = 1.5;
    while density >= LEAST {
        if let Some(discs) = thinned(&setup.medial, density, MOST_POLES) {
            let poles = discs.into_iter().map(|disc| Family {
                point: disc.foot,
                split: None,
                inwards: -disc.outwards,
                lengths: vec![disc.radius],
                powers: vec![Power::plain(1.0)],
            });
            return poles.collect();
        }
        density *= 0.7;
    }
    Vec::new()
}

/// Discs whose centres are no nearer to each other than a part of their radii; none if there are more than `most`.
fn thinned(discs: &[MedialDisc], density: f64, most: usize) -> Option<Vec<MedialDisc>> {
    let mut kept: Vec<MedialDisc> = Vec::new();
    for disc in discs {
        let apart = disc.radius / density;
        if kept.iter().all(|other| (other.centre() - disc.centre()).norm() >= apart) {
            kept.push(*disc);
        }
        if kept.len() > most {
            return None;
        }
    }
    Some(kept)
}

/// Distance of a point of the boundary from the sides that it sees across the domain.
fn clearance(domain: &PlaneDomain, z: Complex) -> f64 {
    let mut least = f64::INFINITY;
    for side in domain.sides() {
        let to = side.point(side.nearest(z)) - z;
        if to.norm() > 1e-9 && domain.holds(z + to.scaled(0.5)) {
            least = least.min(to.norm());
        }
    }
    least
}
