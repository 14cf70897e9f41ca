//! Random models hold what the lists of members hold, and keep to their settings.

use std::collections::BTreeSet;

use jbt_frontend::combine::Combinator;
use jbt_frontend::falloff::FalloffKind;
use jbt_frontend::map::MapKind;
use jbt_frontend::skeleton::SkeletonKind;
use jbt_frontend::texture::TextureKind;
use jbt_frontend::traverse::Visit;
use jbt_frontend::warp::WarpKind;
use jbt_frontend::written::Written;

use super::*;

/// The texts of so many models.
fn texts(count: u64, settings: Settings) -> String {
    let texts = (0..count).map(|seed| {
        let model = Random::with_settings(seed, !seed, settings).model(1 + seed as usize % 20);
        jbt_frontend::text::print(&model)
    });
    texts.collect()
}

/// The number of a variant of `Combinator`. A new variant does not compile here: it needs a line in
/// `Random::operator` or `Random::field_map`, and a number.
fn place(combinator: Combinator) -> usize {
    match combinator {
        Combinator::Sum => 0,
        Combinator::Ricci(_) => 1,
        Combinator::Product => 2,
        Combinator::Union => 3,
        Combinator::Intersection => 4,
        Combinator::Difference => 5,
        Combinator::SymmetricDifference => 6,
        Combinator::Smooth(..) => 7,
        Combinator::RFunction(..) => 8,
        Combinator::Complement => 9,
        Combinator::Clamp { .. } => 10,
        Combinator::Shell(_) => 11,
        Combinator::Offset(_) => 12,
    }
}

#[test]
fn every_member_comes_up() {
    for numbers in [Numbers::Ordinary, Numbers::Hostile] {
        let text = texts(600, Settings { numbers, ..Settings::default() });
        let words: BTreeSet<&str> =
            text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()).collect();
        let skeletons = SkeletonKind::ALL.iter().map(|kind| kind.name());
        // The first falloff is that of leaves which name none.
        let falloffs = FalloffKind::ALL[1..].iter().map(|kind| kind.name());
        let warps = WarpKind::ALL.iter().map(|kind| kind.name());
        let maps = MapKind::ALL.iter().map(|kind| kind.name());
        let textures = TextureKind::ALL.iter().map(|kind| kind.name());
        for word in skeletons.chain(falloffs).chain(warps).chain(maps).chain(textures) {
            assert!(words.contains(word), "{word} is in no model of {numbers:?} numbers");
        }
    }
}

#[test]
fn every_combinator_comes_up() {
    let mut found = [false; 13];
    for seed in 0..300 {
        let model = Random::new(seed, !seed).model(12);
        for tree in model.root.prefix(Visit::Nodes) {
            if let Written::Combine { combinator, .. } = tree.node().written() {
                found[place(*combinator)] = true;
            }
        }
    }
    assert_eq!(found, [true; 13]);
}

#[test]
fn ordinary_models_are_good_and_keep_to_their_settings() {
    let none = Settings {
        negative: false,
        walls: false,
        selectors: false,
        parameters: false,
        ..Settings::default()
    };
    for settings in [Settings::default(), none] {
        for seed in 0..600 {
            let model = Random::with_settings(seed, !seed, settings).model(1 + seed as usize % 20);
            assert!(model.check().is_ok(), "seed {seed}\n{}", jbt_frontend::text::print(&model));
        }
    }
    let [all, few] = [Settings::default(), none].map(|settings| texts(300, settings));
    for word in [" within ", "\nselect ", "param ", "strength -"] {
        let has = |text: &str| text.contains(word.trim_start_matches('\n'));
        assert!(has(&all) && !has(&few), "{word}");
    }
}
