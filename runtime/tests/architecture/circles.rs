//! Circles of files: sets of files that import each other in a loop.

use std::collections::BTreeMap;

use crate::imports::Import;

/// Files that import each other in a loop: every such set of files, in order, as large as it is.
pub fn circles(imports: &[Import]) -> Vec<Vec<String>> {
    let mut reach: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for import in imports {
        reach.entry(&import.from).or_default().push(&import.to);
    }
    let names: Vec<&str> = reach.keys().copied().collect();
    let reached: BTreeMap<&str, Vec<&str>> =
        names.iter().map(|&name| (name, all_from(&reach, name))).collect();
    let mut circles: Vec<Vec<String>> = Vec::new();
    for &name in &names {
        if circles.iter().flatten().any(|known| known == name) {
            continue;
        }
        let back = |other: &&str| reached.get(*other).is_some_and(|from| from.contains(&name));
        let circle: Vec<String> =
            reached[name].iter().filter(|other| back(other)).map(|&s| s.to_owned()).collect();
        if circle.len() > 1 {
            circles.push(circle);
        }
    }
    circles
}

/// Every file that one imports, directly or not, in order.
fn all_from<'a>(reach: &BTreeMap<&'a str, Vec<&'a str>>, name: &str) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    let mut list: Vec<&str> = reach.get(name).cloned().unwrap_or_default();
    while let Some(next) = list.pop() {
        if let Err(place) = found.binary_search(&next) {
            found.insert(place, next);
            list.extend(reach.get(next).into_iter().flatten());
        }
    }
    found
}
