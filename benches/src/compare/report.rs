//! What a case found: a line of JSON for machines, a row of a table for people.

use std::fmt::Write as _;

use serde_json::{Map, Value, json};

use super::contest::{Contestant, Standings};

/// One row of results.
#[derive(Clone, PartialEq, Debug)]
pub struct ResultRow {
    /// The case.
    pub case: &'static str,
    /// Which of the case's works, if it has several that all stand in a table; else empty.
    pub of: &'static str,
    /// Primitives of the model.
    pub primitives: usize,
    /// Points that were asked for: lattice points for meshes, 0 where none are.
    pub points: usize,
    /// What the times are of: `run`, `primitive`, `primitive and point`, `evaluation`.
    pub unit: &'static str,
    /// How many of those a run has.
    pub units: f64,
    /// Times of whole runs.
    pub standings: Standings,
    /// Further results, such as the number of triangles.
    pub extra: Vec<(&'static str, Value)>,
}

impl ResultRow {
    /// Nanoseconds per unit of a contestant, if it was timed.
    #[must_use]
    pub fn nanoseconds(&self, contestant: Contestant) -> Option<f64> {
        let standing = self.standings.of(contestant)?;
        Some(standing.median.as_secs_f64() * 1e9 / self.units)
    }

    /// Ours as a multiple of the limit: above 1 while there is something to gain.
    #[must_use]
    pub fn ratio_limit(&self) -> Option<f64> {
        Some(self.standings.of(Contestant::Ours)?.ratio(self.standings.of(Contestant::Limit)?))
    }

    /// fidget as a multiple of ours, its faster engine if there are both: above 1 where ours is faster.
    #[must_use]
    pub fn ratio_fidget(&self) -> Option<f64> {
        let engines = [Contestant::FidgetJit, Contestant::FidgetVm].into_iter();
        let fidget =
            engines.filter_map(|engine| self.standings.of(engine)).min_by_key(|engine| engine.median)?;
        Some(fidget.ratio(self.standings.of(Contestant::Ours)?))
    }

    /// Ours on one thread as a multiple of ours: 2 at most on two threads.
    #[must_use]
    pub fn ratio_threads(&self) -> Option<f64> {
        Some(self.standings.of(Contestant::OneThread)?.ratio(self.standings.of(Contestant::Ours)?))
    }

    /// `ok`, or who was not timed and why.
    #[must_use]
    pub fn checksum(&self) -> String {
        if self.standings.disagreements.is_empty() {
            return "ok".to_owned();
        }
        self.standings.disagreements.join("; ")
    }

    /// One object. `what` says what is measured.
    #[must_use]
    pub fn json(&self, what: &str) -> Value {
        let mut object = Map::new();
        object.insert("case".to_owned(), json!(self.case));
        object.insert("what".to_owned(), json!(what));
        if !self.of.is_empty() {
            object.insert("of".to_owned(), json!(self.of));
        }
        object.insert("primitives".to_owned(), json!(self.primitives));
        object.insert("points".to_owned(), json!(self.points));
        object.insert("unit".to_owned(), json!(self.unit));
        for standing in &self.standings.standings {
            let name = standing.contestant.name();
            let time = self.nanoseconds(standing.contestant).expect("it was timed");
            object.insert(format!("{name}_ns"), json!(rounded(time)));
            if !standing.form.is_empty() {
                object.insert(format!("{name}_form"), json!(standing.form));
            }
        }
        let ratios = [
            ("ratio_limit", self.ratio_limit()),
            ("ratio_fidget", self.ratio_fidget()),
            ("ratio_threads", self.ratio_threads()),
        ];
        for (name, ratio) in ratios {
            if let Some(ratio) = ratio {
                object.insert(name.to_owned(), json!(rounded(ratio)));
            }
        }
        for (name, value) in &self.extra {
            object.insert((*name).to_owned(), value.clone());
        }
        object.insert("checksum".to_owned(), json!(self.checksum()));
        Value::Object(object)
    }
}

/// Four digits: more are noise.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

/// Widths of the table's columns: the first ones, then one for each contestant, then the ratios.
const HEAD: [(&str, usize); 4] = [("case", 26), ("primitives", 11), ("points", 11), ("time of a", 21)];
const TIME: usize = 13;
const RATIO: usize = 17;

/// The heading of the table.
#[must_use]
pub fn heading() -> String {
    let mut line = String::new();
    for (index, (name, width)) in HEAD.into_iter().enumerate() {
        let _ = if index == 0 { write!(line, "{name:<width$}") } else { write!(line, "{name:>width$}") };
    }
    for contestant in Contestant::ALL {
        let _ = write!(line, "{:>TIME$}", contestant.name());
    }
    for ratio in ["ours/limit", "fidget/ours", "one thread/ours"] {
        let _ = write!(line, "{ratio:>RATIO$}");
    }
    line.push_str("  check");
    line
}

/// A row of the table.
#[must_use]
pub fn line(row: &ResultRow) -> String {
    let [case, primitives, points, unit] = HEAD.map(|(_, width)| width);
    let mut line = format!(
        "{:<case$}{:>primitives$}{:>points$}{:>unit$}",
        format!("{} {}", row.case, row.of),
        row.primitives,
        row.points,
        row.unit
    );
    for contestant in Contestant::ALL {
        let _ = write!(line, "{:>TIME$}", row.nanoseconds(contestant).map_or("-".to_owned(), time));
    }
    for ratio in [row.ratio_limit(), row.ratio_fidget(), row.ratio_threads()] {
        let _ = write!(line, "{:>RATIO$}", ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.2}")));
    }
    let _ = write!(line, "  {}", row.checksum());
    line
}

/// A time with three digits and its unit.
fn time(nanoseconds: f64) -> String {
    let (number, unit) = match nanoseconds {
        ns if ns < 1e3 => (ns, "ns"),
        ns if ns < 1e6 => (ns / 1e3, "us"),
        ns if ns < 1e9 => (ns / 1e6, "ms"),
        ns => (ns / 1e9, "s"),
    };
    let digits = if number < 10.0 { 3 - usize::from(number >= 1.0) } else { usize::from(number < 100.0) };
    format!("{number:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::contest::Standing;
    use super::*;

    fn row() -> ResultRow {
        let standing = |contestant, form, micros| {
            let median = Duration::from_micros(micros);
            Standing { contestant, form, median, samples: Vec::new() }
        };
        ResultRow {
            case: "dense-field",
            of: "",
            primitives: 200,
            points: 1000,
            unit: "primitive and point",
            units: 200_000.0,
            standings: Standings {
                standings: vec![
                    standing(Contestant::Ours, "", 100),
                    standing(Contestant::Limit, "", 40),
                    standing(Contestant::FidgetJit, "and", 150),
                ],
                disagreements: Vec::new(),
            },
            extra: vec![("level", json!("avx2"))],
        }
    }

    #[test]
    fn json_has_the_documented_keys() {
        let expected = json!({
            "case": "dense-field", "what": "the field of 200 points, no culling", "primitives": 200, "points": 1000, "unit": "primitive and point", "ours_ns": 0.5, "limit_ns": 0.2,
            "fidget_jit_ns": 0.75, "fidget_jit_form": "and", "ratio_limit": 2.5, "ratio_fidget": 1.5, "level": "avx2", "checksum": "ok",
        });
        assert_eq!(row().json("the field of 200 points, no culling"), expected);
    }

    #[test]
    fn a_disagreement_is_said() {
        let mut row = row();
        row.standings.disagreements.push("walk: 1 is not 2".to_owned());
        assert_eq!(row.json("")["checksum"], "walk: 1 is not 2");
        assert!(line(&row).ends_with("  walk: 1 is not 2"));
        assert!(row.json("").get("walk_ns").is_none());
    }

    #[test]
    fn numbers_have_four_digits() {
        for (number, text) in [(832_312_345.6, "832300000.0"), (0.0, "0.0"), (0.000_123_456, "0.0001235")] {
            assert_eq!(json!(rounded(number)).to_string(), text);
        }
    }

    #[test]
    fn times_have_three_digits() {
        let cases = [
            (0.1234, "0.123 ns"),
            (1.234, "1.23 ns"),
            (12.34, "12.3 ns"),
            (123.4, "123 ns"),
            (4e9, "4.00 s"),
        ];
        for (nanoseconds, text) in cases {
            assert_eq!(time(nanoseconds), text);
        }
    }

    #[test]
    fn columns_stand_under_their_names() {
        let (heading, line) = (heading(), line(&row()));
        let end = heading.find("limit").expect("a column") + "limit".len();
        assert!(line[..end].ends_with("0.200 ns"), "{heading}\n{line}");
    }
}
