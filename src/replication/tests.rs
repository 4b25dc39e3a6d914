//! Statements go through both voices and come back as they were.

use crate::replication::fields::Fields;
use crate::replication::fields::described::described;
use crate::replication::fields::table::{FIELDS, Voice};
use crate::replication::fields::write::{arguments, scene};
use crate::replication::scene::{Output, Scene};
use clap::Parser;
use proptest::prelude::{Just, ProptestConfig, Strategy, any, prop_oneof, proptest};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::formula::Formula;
use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::problem::source::Tie;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SOLVERS, SaddleSettings, Solver};
use signorini_mathematics::statement::{Boundary, Domain, Fineness, Statement};
use std::collections::BTreeMap;

/// The options of `solve` that are fields, and the scene that some of them exclude.
#[derive(Parser)]
struct Options {
    scene: Option<String>,
    #[command(flatten)]
    fields: Fields,
}

/// A positive number of any size.
fn positive() -> impl Strategy<Value = f64> {
    (-9.0..9.0f64).prop_map(libm::exp10)
}

/// Name of a part of a boundary, with what shells and TOML give a meaning, and what may look like its number.
fn part() -> impl Strategy<Value = String> {
    "[a-zA-Z0-9_.é'\"$#\\\\ =-]{0,7}([a-zé]|=1)"
}

fn domain() -> impl Strategy<Value = Domain> {
    let name = prop_oneof![
        Just("square"),
        Just("cube"),
        Just("disc"),
        Just("ball"),
        Just("meshes/a gear.msh")
    ];
    let numbers = proptest::collection::vec(-2.0..2.0f64, 1..7);
    let curve = proptest::collection::btree_map("[a-z=.é][a-z=. é]{0,4}[a-z]", numbers, 0..3);
    (name, curve).prop_map(|(name, curve)| match name {
        "square" => Domain::square(),
        name => Domain { curve, ..Domain::named(name) },
    })
}

/// A value or a flux.
fn number() -> impl Strategy<Value = Formula> {
    prop_oneof![Just(0.0), -2.0..2.0f64].prop_map(Formula::from)
}

/// A number or a formula.
fn value() -> impl Strategy<Value = Formula> {
    let formulas = ["x", "0.1*x - y", "-x", "min(x, 1)^2/3", "1 - cos(pi*x)"];
    let formula = (0..formulas.len()).prop_map(move |k| Formula::read(formulas[k], 3).unwrap());
    prop_oneof![number(), formula]
}

/// Numbers of a law: none, or one with a gap.
fn law() -> impl Strategy<Value = Vec<(LawNumber, Formula)>> {
    let of = prop_oneof![Just(LawNumber::Friction), Just(LawNumber::Limit)];
    prop_oneof![
        Just(Vec::new()),
        value().prop_map(|gap| vec![(LawNumber::Gap, gap)]),
        (of, positive(), value())
            .prop_map(|(of, g, gap)| vec![(of, g.into()), (LawNumber::Gap, gap)])
    ]
}

/// Numbers of a law on a part.
fn law_of_part() -> impl Strategy<Value = Vec<(LawNumber, Formula)>> {
    let below = |(most, flux)| vec![(LawNumber::Below, most), (LawNumber::Flux, flux)];
    prop_oneof![
        law(),
        value().prop_map(|flux| vec![(LawNumber::Free, flux)]),
        value().prop_map(|value| vec![(LawNumber::Fixed, value)]),
        (value(), number()).prop_map(below)
    ]
}

/// Laws on all parts that are not named, and on parts.
fn boundary() -> impl Strategy<Value = Boundary> {
    // A part has one law: in a list it could have two that do not go together.
    let parts = proptest::collection::btree_map(part(), law_of_part(), 0..4);
    (law(), parts).prop_map(|(others, parts)| {
        let mut boundary = Boundary::default();
        for (part, numbers) in [(String::new(), others)].into_iter().chain(parts) {
            for (of, number) in numbers {
                boundary = boundary.with(&part, of, number);
            }
        }
        boundary
    })
}

fn load() -> impl Strategy<Value = LoadRule> {
    let diagonal = || prop_oneof![Just(Diagonal::Rising), Just(Diagonal::Falling)];
    let tie = (0..4usize).prop_map(|k| Tie::ALL[k]);
    prop_oneof![
        Just(LoadRule::Bilinear {}),
        diagonal().prop_map(|diagonal| LoadRule::Exact { diagonal }),
        (tie, proptest::option::of(diagonal()))
            .prop_map(|(tie, diagonal)| LoadRule::Nodal { tie, diagonal })
    ]
}

fn saddle() -> impl Strategy<Value = SaddleSettings> {
    (0..3usize, positive(), 0..4usize, 1..10_000_000usize).prop_map(|(rule, r, stop, limit)| {
        let (prolongation, stop) = (Prolongation::ALL[rule], StopRule::ALL[stop]);
        SaddleSettings { prolongation, r, stop, max_iterations: limit }
    })
}

fn fineness() -> impl Strategy<Value = Fineness> {
    let grids = (2..9usize, 1..5usize)
        .prop_map(|(first, count)| Fineness::Grids((0..count).map(|k| first << k).collect()));
    let accuracy = || (1e-9..1.0f64).prop_filter("below one", |wanted| *wanted < 1.0);
    prop_oneof![
        Just(Fineness::Usual),
        grids,
        (1..300usize).prop_map(Fineness::Width),
        (0..20u8).prop_map(Fineness::Refined),
        accuracy().prop_map(|wanted| Fineness::Within(Accuracy::Error(wanted))),
        accuracy().prop_map(|wanted| Fineness::Within(Accuracy::Energy(wanted)))
    ]
}

/// Texts of f on the square, in the form in which it is kept, and elsewhere.
fn f() -> impl Strategy<Value = [String; 2]> {
    let text = ["else=-1", "disc(0.1,0,0.2)=3; else=-0.7", "formula(3*x*y - 1.1)"];
    let region = ["region(\"a  b; c\")=-1", "halfplane(1,0,0)=2; else=-3"];
    (0..3usize, 0..2usize).prop_map(move |(k, l)| {
        let on_square: signorini_mathematics::problem::source::Source = text[k].parse().unwrap();
        [on_square.to_string(), region[l].to_owned()]
    })
}

/// k and a reaction.
fn operator() -> impl Strategy<Value = (Option<String>, Option<f64>)> {
    let k = ["2", "region(core)=5; else=1/3", "region(\"a  b; c\")=1e-3; region(d)=2"];
    prop_oneof![
        Just((None, None)),
        (0..3usize, 0..3u8).prop_map(move |(number, reaction)| {
            (Some(k[number].to_owned()), Some(f64::from(reaction)).filter(|c| *c > 0.0))
        })
    ]
}

/// Statements whose fields go with each other.
fn statement() -> impl Strategy<Value = Statement> {
    let solver = (0..SOLVERS.len()).prop_map(|k| SOLVERS[k].solver);
    let of_solver = (solver, saddle(), proptest::option::of(positive()));
    let of_boundary = (boundary(), operator());
    (domain(), f(), of_boundary, load(), fineness(), of_solver).prop_map(
        |(
            domain,
            [on_grids, elsewhere],
            of_boundary,
            load,
            fineness,
            (solver, saddle, tolerance),
        )| {
            let (boundary, (k, reaction)) = of_boundary;
            let usual = Statement { boundary, k, reaction, ..Statement::usual(domain, "") };
            let has_grids = usual.has_grids();
            let Statement { domain, boundary, k, reaction, .. } = usual;
            let (is_square, is_cube) = (domain.is_square(), domain.is_cube());
            let takes = (solver.entry().in_space || is_square) && k.is_none();
            let solver = if takes { solver } else { Solver::Uzawa };
            let fits = match fineness {
                Fineness::Usual => true,
                Fineness::Grids(_) => has_grids,
                Fineness::Width(_) => is_square || is_cube,
                Fineness::Refined(_) => !is_square,
                Fineness::Within(_) => solver == Solver::Multigrid,
            };
            let fineness = if fits { fineness } else { Fineness::Usual };
            let is_within = matches!(fineness, Fineness::Within(_));
            let prolongation =
                if has_grids { saddle.prolongation } else { Prolongation::default() };
            Statement {
                f: if has_grids { on_grids } else { elsewhere },
                with_truth: is_within,
                load: (has_grids && solver != Solver::Spectral).then_some(load),
                saddle: solver.is_nested().then_some(SaddleSettings { prolongation, ..saddle }),
                tolerance: tolerance.filter(|_| solver == Solver::Multigrid && !is_within),
                boundary,
                k,
                reaction,
                domain,
                fineness,
                solver,
            }
        },
    )
}

/// The keys of a scene that state its problem.
fn without_titles(mut keys: toml::Table) -> toml::Table {
    keys.retain(|key, _| !["title", "outputs"].contains(&key));
    keys
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn a_statement_is_the_same_in_options_and_in_a_scene(stated in statement(), title in any::<bool>()) {
        let words = [vec!["solve".to_owned()], arguments(&stated)].concat();
        let parsed = Options::try_parse_from(&words).unwrap_or_else(|e| panic!("{words:?}: {e}"));
        assert!(parsed.scene.is_none());
        let by_options = parsed.fields.stated(Voice::Options).unwrap();
        assert_eq!(by_options, stated, "{words:?}");
        let title = if title { "A \"title\" \\ é" } else { "t" };
        let text = scene(title, &by_options, &[Output::Table]);
        // What a scene asks of its grids and its r is checked when it is read.
        let keys = toml::from_str(&text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let by_keys = Fields::of_keys(without_titles(keys), &[]);
        let by_keys = by_keys.and_then(|fields| fields.stated(Voice::Keys));
        let by_keys = by_keys.unwrap_or_else(|e| panic!("{text}: {}", e.text));
        assert_eq!(by_keys, stated, "{text}");
        if let Ok(scene) = Scene::parse("s", &text) {
            assert_eq!(scene.statement, stated, "{text}");
            assert_eq!(scene.title, title);
        }
        // So do the parameters of a task.
        let json = serde_json::to_string(&stated).unwrap();
        assert_eq!(serde_json::from_str::<Statement>(&json).unwrap(), stated, "{json}");
    }
}

#[test]
fn a_formula_without_coordinates_states_its_number() {
    let stated = ["bottom=0.25", "bottom=1/4", "bottom=0.5^2 + 0*pi"].map(|gap| {
        let options = Options::try_parse_from(["solve", "--f", "else=-1", "--gap", gap]).unwrap();
        serde_json::to_string(&options.fields.stated(Voice::Options).unwrap()).unwrap()
    });
    assert!(stated[0].contains("{\"bottom\":{\"gap\":0.25}}"), "{}", stated[0]);
    assert!(stated.iter().all(|other| *other == stated[0]), "{stated:?}");
}

#[test]
fn pages_have_each_field_with_its_key_its_values_and_what_it_goes_with() {
    let fields = serde_json::to_value(described()).unwrap();
    let all = fields["all"].as_array().unwrap();
    assert_eq!(all.len(), FIELDS.len());
    for field in all {
        let meaning = field["meaning"].as_str().unwrap();
        assert!(meaning.len() > 5 && !meaning.contains("default"), "{field}");
    }
    let named = |key: &str| all.iter().find(|field| field["key"] == key).unwrap();
    let [domain, refine, solver] = ["domain", "domain.refine", "solver"].map(named);
    for name in AnyMesh::built_in_names() {
        assert!(domain["meaning"].as_str().unwrap().contains(name), "the help lacks {name}");
    }
    assert_eq!(refine["option"], "--refine K");
    assert_eq!(domain["option"], "--domain NAME\\|FILE");
    assert_eq!(refine["more"], ". *For* meshes");
    assert_eq!(refine["default"], "up to 20 000 nodes");
    assert_eq!(solver["default"], "`\"multigrid\"`");
    for entry in &SOLVERS {
        assert!(solver["more"].as_str().unwrap().contains(entry.name), "{solver}");
    }
    let of_load = named("load")["more"].as_str().unwrap();
    assert!(of_load.ends_with(". *For* all but spectral; the square"), "{of_load}");
    assert_eq!(named("r")["more"], ". *For* the saddle-point methods");
    let exclusive = fields["exclusive"].as_array().unwrap();
    let keys = "`accuracy`, `accuracy_energy`, `grids`, `h`, `domain.refine`";
    assert!(exclusive.iter().any(|group| group["says"] == "how fine" && group["keys"] == keys));
}

#[test]
fn each_field_is_an_option_and_a_key() {
    let command = <Options as clap::CommandFactory>::command();
    let mut options: Vec<_> = command.get_arguments().filter_map(clap::Arg::get_long).collect();
    options.retain(|option| *option != "help");
    let names = FIELDS.iter().map(|field| field.name);
    let mut of_table: Vec<_> = names.clone().map(|name| name.replace('_', "-")).collect();
    options.sort_unstable();
    of_table.sort_unstable();
    assert_eq!(options, of_table);
    let unknown = Fields::of_keys(toml::from_str("nothing = 1").unwrap(), &[]).unwrap_err().text;
    let tables: BTreeMap<_, _> = FIELDS.iter().map(|field| (field.name, field.table)).collect();
    for (name, table) in tables {
        let key = table.unwrap_or(name);
        assert!(unknown.split([' ', ',']).any(|word| word == key), "{key}: {unknown}");
    }
}
