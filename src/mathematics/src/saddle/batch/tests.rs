//! Every engine gives the same numbers to the last bit.

use super::*;
use crate::discrete::grid::Grid;
use crate::discrete::load::LoadRule;
use crate::discrete::network::Network;
use crate::problem::law::Law;
use crate::saddle::network::OnNetwork;
use crate::saddle::{Engine, GradientMeasure, Method, Pair, RunStart};
use crate::square::load::load;

fn setting() -> (Grid, Vec<f64>, Pair) {
    let grid = Grid::new(16).unwrap();
    let f = "quadrant(ll)=-6; else=1.998".parse().unwrap();
    (grid, load(grid, &f, LoadRule::Bilinear {}), Pair::zero((grid, Law::SIGNORINI)))
}

fn laws() -> [Law; 2] {
    [Law::SIGNORINI, Law::friction(0.6).unwrap()]
}

#[test]
fn all_engines_have_the_same_pairs_and_measures_to_the_last_bit() {
    let (grid, load, start) = setting();
    for law in laws() {
        let network = Network::of_square(grid, law);
        let run = RunStart { load: &load, method: Method::ArrowHurwicz, r: 3.0, pair: &start };
        let mut square = Lanes::<1, f64>::new(grid, law, Order::Lexicographic, 1.0);
        square.enter(0, &run);
        let mut definition = OnNetwork::new(&network, &run);
        let mut lanes: Lanes = Lanes::new(grid, law, Order::Lexicographic, 1.0);
        lanes.enter(5, &run);
        for _ in 0..20 {
            square.sweep();
            definition.sweep();
            lanes.sweep();
            let change = square.dual_step([true])[0];
            assert_eq!(definition.dual_step([true]), [change]);
            assert_eq!(lanes.dual_step([true; LANES])[5], change);
            for measure in GradientMeasure::ALL {
                let worst = square.worst(measure)[0];
                assert_eq!(definition.worst(measure), [worst], "{measure:?}");
                assert_eq!(lanes.worst(measure)[5], worst, "{measure:?}");
                assert!(lanes.within(measure, [Some(worst); LANES])[5]);
                let below = [Some(worst - 1e-9); LANES];
                assert!(!lanes.within(measure, below)[5], "{measure:?}");
                assert_eq!(square.within(measure, [Some(worst)]), [true]);
                assert_eq!(definition.within(measure, [Some(worst)]), [true]);
            }
        }
        assert_eq!(square.pair(0), definition.pair(0));
        assert_eq!(lanes.pair(5), square.pair(0));
    }
}
