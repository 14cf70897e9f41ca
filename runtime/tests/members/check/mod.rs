//! What every row is judged by. Each check has one file, and says in its first words what it holds a member
//! to.

mod engines;
mod finite;
mod oracle;
mod ranges;
mod support;
mod text;
mod values;

use rayon::prelude::*;

use crate::row::{Family, Found, Row};
use crate::subject::Subject;

/// The first thing that is wrong, or nothing.
type Verdict = Result<(), String>;

type Check = fn(&Subject) -> Verdict;

/// Every check and its name.
const CHECKS: [(&str, Check); 7] = [
    ("values", values::check),
    ("round trip", text::check),
    ("engines", engines::check),
    ("finite", finite::check),
    ("oracle", oracle::check),
    ("support", support::check),
    ("ranges", ranges::check),
];

/// Judges every row of a family by every check, and panics with all that is wrong.
pub fn judge(family: Family) {
    let Family { name: family, members, found } = family;
    let missing = members.iter().filter(|member| member.rows.is_empty());
    let mut failures: Vec<String> = missing.map(|member| format!("{} has no row", member.name)).collect();
    let rows =
        members.into_iter().flat_map(|member| member.rows.into_iter().map(move |row| (member.name, row)));
    let rows: Vec<(&str, Row)> = rows.collect();
    let wrong = rows.into_par_iter().flat_map_iter(|(member, row)| {
        let name = row.name;
        judge_row(member, row, found).into_iter().map(move |wrong| format!("{member}, {name}: {wrong}"))
    });
    failures.extend(wrong.collect::<Vec<_>>());
    assert!(failures.is_empty(), "{} failures in {family}\n{}", failures.len(), failures.join("\n"));
}

/// All that is wrong with a row.
fn judge_row(member: &str, row: Row, found: Found) -> Vec<String> {
    let subject = match Subject::new(row) {
        Ok(subject) => subject,
        Err(wrong) => return vec![wrong],
    };
    let mut failures = Vec::new();
    if !found(&subject.model, &subject.tree).contains(&member) {
        failures.push("the model does not contain the member".to_owned());
    }
    for (check, run) in CHECKS {
        if let Err(wrong) = run(&subject) {
            failures.push(format!("{check}: {wrong}"));
        }
    }
    if !failures.is_empty() {
        failures.push(format!("in the model `{}`", subject.row.text));
    }
    failures
}

/// What the checks are worth: rows that are wrong are seen.
mod tests {
    use super::*;
    use crate::row::{Member, row};

    fn judged(row: Row) -> String {
        judge_row("Point", row, |_, _| vec!["Point"]).join("\n")
    }

    #[test]
    fn a_good_row_passes() {
        assert_eq!(judged(row("", "point { radius 1 }", &[([0.5, 0.0, 0.0], 0.5)])), "");
    }

    #[test]
    fn wrong_values_are_seen() {
        let wrong = judged(row("", "point { radius 1 }", &[([0.5, 0.0, 0.0], 0.500_000_1)]));
        assert!(
            wrong.contains("the field by the oracle at [0.5, 0.0, 0.0]: expected 0.5000001, got 0.5"),
            "{wrong}"
        );
        let colour = row("", "point { radius 1 }", &[]).attribute("color", [0.0; 3], &[1.0, 1.0, 0.5]);
        assert!(judged(colour).contains("expected 0.5, got 1"));
        assert!(judged(row("", "point { radius 1 }", &[])).contains("knows no value"));
    }

    #[test]
    fn rows_that_are_no_models_are_seen() {
        let unreadable = judged(row("", "point { }", &[]));
        assert!(unreadable.contains(":1:"), "{unreadable}");
        let endless = row("", "point { radius 1 }", &[([0.0; 3], 1.0)]).unbounded([-1.0; 3], [1.0; 3]);
        assert!(judged(endless).contains("says that the support has no end"));
    }

    #[test]
    #[should_panic(expected = "Point has no row")]
    fn a_member_without_rows_is_seen() {
        let members = vec![Member { name: "Point", rows: Vec::new() }];
        judge(Family { name: "skeletons", members, found: |_, _| Vec::new() });
    }

    #[test]
    #[should_panic(expected = "the model does not contain the member")]
    fn a_row_of_another_member_is_seen() {
        let rows = vec![row("", "point { radius 1 }", &[([0.0; 3], 1.0)])];
        let members = vec![Member { name: "Ring", rows }];
        judge(Family { name: "skeletons", members, found: |_, _| vec!["Point"] });
    }
}
