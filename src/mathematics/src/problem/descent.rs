//! Way along a direction to the least energy, where values that change their sign bend the energy.

/// Derivatives of the energy along a direction at its beginning, as long as no value changes its sign.
#[derive(Clone, Copy)]
pub(crate) struct Slope {
    /// First derivative, negative.
    pub(crate) first: f64,
    /// Second derivative, positive.
    pub(crate) second: f64,
}

/// Step length at which a value changes its sign.
pub(crate) struct Bend {
    pub(crate) at: f64,
    /// Increase of the first derivative of the energy there.
    pub(crate) slope: f64,
}

impl Slope {
    /// Step length of least energy.
    pub(crate) fn least(self, mut bends: Vec<Bend>) -> f64 {
        bends.sort_by(|a, b| a.at.total_cmp(&b.at));
        // Derivative of the energy along the direction, less the part that grows with the length.
        let mut slope = self.first;
        let mut length = -slope / self.second;
        for bend in bends {
            if bend.at >= length {
                break;
            }
            slope += bend.slope;
            length = (-slope / self.second).max(bend.at);
        }
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_energy_is_before_at_or_behind_a_bend() {
        let slope = Slope { first: -2.0, second: 1.0 };
        let length = |at: f64, increase: f64| slope.least(vec![Bend { at, slope: increase }]);
        assert_eq!(length(3.0, 1.0), 2.0);
        assert_eq!(length(1.0, 1.5), 1.0);
        assert_eq!(length(0.25, 1.0), 1.0);
    }
}
