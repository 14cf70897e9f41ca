//! Random models hold what the lists of members hold, and keep to their settings.

use std::collections::BTreeSet;

use jbt_model::combine::CombinatorKind;
use jbt_model::falloff::FalloffKind;
use jbt_model::map::MapKind;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::texture::TextureKind;
use jbt_model::traverse::Visit;
use jbt_model::warp::WarpKind;
use jbt_model::written::Written;

use super::*;

/// The texts of so many models.
fn texts(count: u64, settings: Settings) -> String {
    let texts = (0..count).map(|seed| {
        let model = Random::with_settings(seed, !seed, settings).model(1 + seed as usize % 20);
        jbt_text::print(&model)
    });
    texts.collect()
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
        for mixing in ["blend", "dominant"] {
            let has = |line: &str| line.contains(" direction ") && line.ends_with(mixing);
            assert!(text.lines().any(has), "no model of {numbers:?} numbers has directions that {mixing}");
        }
    }
}

#[test]
fn every_operator_comes_up() {
    let mut missing: Vec<CombinatorKind> = CombinatorKind::ALL.to_vec();
    for seed in 0..600 {
        let model = Random::new(seed, !seed).model(12);
        for tree in model.root.prefix(Visit::Nodes) {
            if let Written::Combine { combinator, .. } = tree.node().written() {
                missing.retain(|kind| kind != combinator);
            }
        }
    }
    assert_eq!(missing, []);
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
            assert!(model.check().is_ok(), "seed {seed}\n{}", jbt_text::print(&model));
        }
    }
    let [all, few] = [Settings::default(), none].map(|settings| texts(300, settings));
    for word in [" within ", "\nselect ", "param ", "strength -"] {
        let has = |text: &str| text.contains(word.trim_start_matches('\n'));
        assert!(has(&all) && !has(&few), "{word}");
    }
}
