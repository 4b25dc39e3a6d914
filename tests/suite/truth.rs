//! Reference values and finite elements against true solutions; contact, iteration by iteration.

use crate::common::paper_problems;
use crate::reference::REFERENCES;
use signorini_mathematics::experiments::truth::{
    ElementsOrders, Numbers, ReferenceValue, Truth, TruthPlan, truth,
};
use std::sync::OnceLock;

fn found() -> &'static Truth {
    static ONCE: OnceLock<Truth> = OnceLock::new();
    ONCE.get_or_init(|| {
        let plan = TruthPlan::new(paper_problems());
        truth(&TruthPlan { cells: vec![16, 32, 64], sampled: 8, ..plan }).unwrap()
    })
}

/// All digits but the last are those of the value computed in quadruple precision.
#[track_caller]
fn agrees(value: &ReferenceValue, known: f64) {
    let decimals = value.digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    assert!((12..=14).contains(&decimals), "{value:?}");
    let printed: f64 = value.digits.parse().unwrap();
    let last = 0.1f64.powi(decimals as i32);
    assert!((printed - known).abs() <= 3.0 * last, "{} is not {known}", value.digits);
}

#[test]
fn printed_digits_are_right() {
    let one = |name: &str| found().references.iter().find(|one| one.name == name).unwrap();
    for name in ["problem 1", "problem 2", "two-discs", "corner-disc"] {
        let one = one(name);
        let known = REFERENCES.iter().find(|known| known.f == one.f).unwrap();
        agrees(&one.numbers.energy, known.energy);
        agrees(&one.numbers.centre, known.centre);
        // The coordinate of the first end that is not that of a side.
        let (from, [known, _]) = (&one.numbers.contact[0].from, known.contact.unwrap());
        let axis = usize::from(from[0].value.abs() == 0.5);
        agrees(&from[axis], known[axis]);
    }
    assert_eq!(one("four-arcs").numbers.contact.len(), 4);
    let corners = &one("problem 1").numbers.corners;
    agrees(&corners[0], REFERENCES[3].corners[3]);
    assert_eq!(corners[2].digits, "0");
}

#[test]
fn the_record_agrees_with_both_programs() {
    let record: toml::Table = include_str!("../../pipeline/truth.toml").parse().unwrap();
    let solutions = record["solution"].as_array().unwrap();
    assert_eq!(solutions.len(), 6);
    for solution in solutions {
        let f = solution["f"].as_str().unwrap();
        let mut theirs: Numbers<String> = solution.clone().try_into().unwrap();
        // Of the second program and of one in quadruple precision: not the last bit of a double apart.
        if let Some(known) = REFERENCES.iter().find(|known| known.f == f) {
            let numbers = [(&theirs.energy, known.energy), (&theirs.centre, known.centre)];
            for (digits, known) in numbers {
                assert!(
                    (digits.parse::<f64>().unwrap() - known).abs() <= 2e-16 * known.abs(),
                    "{f}"
                );
            }
        }
        let ours = found().references.iter().find(|one| one.f == f).unwrap();
        let mut ours = ours.numbers.clone();
        assert_eq!(ours.contact.len(), theirs.contact.len(), "{f}");
        for (ours, theirs) in ours.each().zip(theirs.each()) {
            let error = (ours.value - theirs.parse::<f64>().unwrap()).abs();
            assert!(error <= 2e-14, "{f}: {} is not {theirs}", ours.value);
        }
    }
}

#[test]
fn bounds_hold_and_are_sharp() {
    for one in &found().elements {
        for level in &one.levels {
            let [below, above] = level.effectivity;
            assert!(below <= 1.0 + 1e-9 && above >= 1.0 - 1e-9, "{}: {level:?}", one.name);
            assert!(level.holds != Some(false), "{}: {level:?}", one.name);
        }
        let [below, above] = one.levels[2].effectivity;
        // Cells that a circle cuts add more than those that a straight jump does.
        let most = if one.f.contains("disc") { 1.05 } else { 1.02 };
        assert!(below > 0.98 && above < most, "{}: {:?}", one.name, one.levels[2]);
        // The load of an accuracy is what the flux balances.
        let [below, above] = one.levels[2].bilinear;
        assert!((0.98..=1.0 + 1e-9).contains(&below), "{}: {:?}", one.name, one.levels[2]);
        assert!((1.0 - 1e-9..1.01).contains(&above), "{}: {:?}", one.name, one.levels[2]);
        let ElementsOrders { error, energy, .. } = one.orders;
        assert!((error.unwrap() - 1.0).abs() < 0.1, "{}: {:?}", one.name, one.orders);
        assert!(energy.is_none_or(|order| (order - 2.0).abs() < 0.1), "{:?}", one.orders);
    }
    let summary = found().summary;
    assert_eq!((summary.brackets, summary.held), (21, 21));
    assert!(summary.green < 1e-11 && summary.rellich < 1e-11, "{summary:?}");
}

#[test]
fn values_at_nodes_are_those_of_finite_elements() {
    let [first, second] = &found().samples[..] else { panic!("two problems") };
    assert_eq!((first.len(), second.len()), (81, 81));
    // The corners in contact, the others, and the centre.
    assert_eq!((first[80], second[0]), (0.0, 0.0));
    assert!((first[0] - REFERENCES[3].corners[3]).abs() < 1e-12);
    assert!((second[40] - REFERENCES[4].centre).abs() < 1e-12);
    // The rim never sinks below zero.
    for values in [first, second] {
        let rim = (0..81).filter(|k| k % 9 == 0 || k % 9 == 8 || *k < 9 || *k >= 72);
        assert!(rim.clone().count() == 32 && rim.into_iter().all(|k| values[k] >= 0.0));
    }
}
