//! Colours on white that readers with any colour vision can distinguish.

pub(super) use plotters::style::RGBColor;

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Secondary text.
pub(super) const MUTED: RGBColor = RGBColor(0x59, 0x59, 0x59);
/// Grid lines.
pub(super) const RULE: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
/// Shaded ground.
pub(super) const SHADE: RGBColor = RGBColor(0xee, 0xee, 0xee);
/// Paper.
pub(super) const WHITE: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// Part of the boundary in contact, in a hue that viridis does not contain.
pub(super) const CONTACT: RGBColor = RGBColor(0xd5, 0x2b, 0x00);

/// Pairs (colour on a light page, colour on a dark page) of text, rules, grounds and series.
///
/// The ink and the white of [`legible_on`] are not among them, because they are on coloured ground on either page.
pub(super) const DARK: [(u32, u32); 13] = [
    (0x222222, 0xe6e6e6),
    (0x595959, 0xb0b4bd),
    (0xdddddd, 0x464c5c),
    (0xeeeeee, 0x2a3040),
    (0xffffff, 0x161a22),
    (0xd52b00, 0xff6a45),
    (0x0072b2, 0x4fa8e8),
    (0xd55e00, 0xff8a3d),
    (0x009e73, 0x35c495),
    (0xcc79a7, 0xe79cc6),
    (0xe69f00, 0xf5c04a),
    (0x56b4e9, 0x9fdcff),
    (0x000000, 0xfefefe),
];

/// Returns the colour that a solver has in every picture, as an index of [`series`], by the beginning of its name.
pub(super) fn solver(label: &str) -> Option<usize> {
    const SOLVERS: [(&str, usize); 7] = [
        ("multigrid", 0),
        ("Arrow-Hurwicz", 1),
        ("Uzawa", 2),
        ("proximal", 3),
        ("active set", 6),
        ("best of", 4),
        ("spectral", 5),
    ];
    SOLVERS.iter().find(|(name, _)| label.starts_with(name)).map(|(_, place)| *place)
}

/// Returns colour `k` of the palette of Okabe and Ito without its yellow, which is hard to see on white; the palette
/// repeats.
pub(super) fn series(k: usize) -> RGBColor {
    const OKABE_ITO: [RGBColor; 7] = [
        RGBColor(0x00, 0x72, 0xb2),
        RGBColor(0xd5, 0x5e, 0x00),
        RGBColor(0x00, 0x9e, 0x73),
        RGBColor(0xcc, 0x79, 0xa7),
        RGBColor(0xe6, 0x9f, 0x00),
        RGBColor(0x56, 0xb4, 0xe9),
        RGBColor(0x00, 0x00, 0x00),
    ];
    OKABE_ITO[k % OKABE_ITO.len()]
}

/// Returns a light shade of colour `k` of [`series`], with the same ink legible on it on either page.
pub(super) fn light(k: usize) -> RGBColor {
    let RGBColor(red, green, blue) = series(k);
    let [red, green, blue] = [red, green, blue].map(|channel| 255 - (255 - channel) / 5);
    RGBColor(red, green, blue)
}

/// Scale of colours for values in a range.
#[derive(Clone, Copy, Debug)]
pub(super) enum ColourScale {
    /// Viridis: perceptually uniform, lightness rising with the value.
    Viridis { low: f64, high: f64 },
    /// Blue through white, for 0, to red, from -`limit` to `limit` (Brewer's RdBu, reversed).
    Diverging { limit: f64 },
}

impl ColourScale {
    /// Returns the colour of a value.
    pub(super) fn color(self, value: f64) -> RGBColor {
        match self {
            Self::Viridis { low, high } => {
                let span = if high > low { high - low } else { 1.0 };
                viridis((value - low) / span)
            }
            Self::Diverging { limit } => diverging(value / limit),
        }
    }

    /// Least and greatest value.
    pub(super) fn range(self) -> (f64, f64) {
        match self {
            Self::Viridis { low, high } => (low, high),
            Self::Diverging { limit } => (-limit, limit),
        }
    }
}

fn viridis(t: f64) -> RGBColor {
    const STOPS: [u32; 11] = [
        0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151,
        0xbddf26, 0xfde725,
    ];
    between(&STOPS, t)
}

fn diverging(t: f64) -> RGBColor {
    const STOPS: [u32; 9] =
        [0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b];
    between(&STOPS, 0.5 * (t + 1.0))
}

/// Interpolates linearly between equally spaced stops, with t clamped to [0, 1].
fn between(stops: &[u32], t: f64) -> RGBColor {
    let last = stops.len() - 1;
    let place = t.clamp(0.0, 1.0) * last as f64;
    let k = (place as usize).min(last - 1);
    let s = place - k as f64;
    let [red, green, blue] = [16, 8, 0].map(|shift| {
        let [low, high] = [stops[k], stops[k + 1]].map(|c| f64::from(c >> shift & 0xff));
        (low + s * (high - low)).round() as u8
    });
    RGBColor(red, green, blue)
}

/// Multiplies the light of a colour by `factor`, and clamps it.
pub(super) fn lit(color: RGBColor, factor: f64) -> RGBColor {
    let [red, green, blue] = [color.0, color.1, color.2]
        .map(|channel| (f64::from(channel) * factor).round().clamp(0.0, 255.0) as u8);
    RGBColor(red, green, blue)
}

/// Returns nearly white or nearly ink, whichever contrasts more with `ground`.
pub(super) fn legible_on(ground: RGBColor) -> RGBColor {
    let luma =
        0.299 * f64::from(ground.0) + 0.587 * f64::from(ground.1) + 0.114 * f64::from(ground.2);
    if luma < 140.0 { RGBColor(0xfe, 0xfe, 0xfe) } else { RGBColor(0x21, 0x21, 0x21) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diverging_colours_are_neutral_at_zero_and_viridis_brightens() {
        assert_eq!(diverging(0.0), RGBColor(0xf7, 0xf7, 0xf7));
        assert!(diverging(-1.0).2 > diverging(-1.0).0 && diverging(1.0).0 > diverging(1.0).2);
        let green: Vec<u8> = (0..=20).map(|k| viridis(f64::from(k) / 20.0).1).collect();
        assert!(green.is_sorted());
        assert_eq!(viridis(7.0), RGBColor(0xfd, 0xe7, 0x25));
    }
}
