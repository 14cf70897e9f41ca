//! Names of variables in printed Rust.

use std::collections::{HashMap, HashSet};

use jbt_model::combine::CombinatorKind;
use jbt_model::falloff::FalloffKind;
use jbt_model::map::MapKind;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::texture::TextureKind;
use jbt_model::warp::WarpKind;

/// Words that no variable may have in any edition, and functions of the builder that are no members.
const TAKEN: &str = "as async await abstract become box break const continue crate do dyn else enum extern \
                     false final fn for gen if impl in let loop macro match mod move mut override priv pub ref \
                     return self static struct super trait true try type typeof unsafe unsized use virtual \
                     where while yield x y z param particles primitive surface surface_particles jbt root";

/// The names that are taken.
pub(super) struct RustNames {
    taken: HashSet<String>,
    /// Of each stem, the number that was taken last.
    last: HashMap<String, usize>,
}

impl RustNames {
    pub(super) fn new() -> Self {
        let members = SkeletonKind::ALL.iter().map(|kind| kind.constructor());
        let members = members.chain(FalloffKind::ALL.iter().map(|kind| kind.constructor()));
        let members = members.chain(TextureKind::ALL.iter().map(|kind| kind.constructor()));
        let members = members.chain(WarpKind::ALL.iter().map(|kind| kind.constructor()));
        let members = members.chain(MapKind::ALL.iter().map(|kind| kind.constructor()));
        let members = members.chain(CombinatorKind::ALL.iter().map(|kind| kind.constructor()));
        let taken = members.chain(TAKEN.split_ascii_whitespace()).map(str::to_owned).collect();
        Self { taken, last: HashMap::new() }
    }

    /// A variable like this name, if that is free, else one with a number behind.
    pub(super) fn like(&mut self, name: &str) -> String {
        // A letter in front of what is no name, and none of a type: variables are small.
        let mut stem = name.to_lowercase();
        if !jbt_model::word::is_identifier(&stem) {
            stem = "node".to_owned();
        }
        if self.taken.insert(stem.clone()) {
            return stem;
        }
        self.numbered(&format!("{stem}_"))
    }

    /// The first free one of a stem and a number.
    pub(super) fn numbered(&mut self, stem: &str) -> String {
        let number = self.last.entry(stem.to_owned()).or_default();
        loop {
            *number += 1;
            let name = format!("{stem}{number}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}
