//! `.csv`, and other tables of numbers as text: a line for each point, with commas, semicolons, tabs or
//! blanks between columns, and perhaps a head line with their names. Lines that begin with `#` are
//! comments.

use super::cloud::{Cloud, linear_colors};
use super::options::{ParticleOptions, ParticleUse};
use super::scan::{TextLine, TextLines, TextWord, fault};
use crate::import::format::SceneFormatRow;
use crate::import::imported::ReadModel;
use jbt_ir::limits::MAX_TABLE_COLUMNS;
use jbt_ir::watch;
use jbt_model::diagnostic::Diagnostic;

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow::of_particles(
    &["csv", "tsv"],
    ("a table of points", &[ParticleUse::Columns]),
    |_| false,
    |bytes, options| table(bytes, options, 3),
);

/// What a column is.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum ColumnRole {
    Axis(usize),
    Radius,
    Strength,
    Color(usize),
    /// A number of an attribute.
    Value(String),
    Nothing,
}

impl ColumnRole {
    /// By its name.
    fn named(name: &str, options: &ParticleOptions) -> Self {
        match name.to_ascii_lowercase().as_str() {
            "x" => Self::Axis(0),
            "y" => Self::Axis(1),
            "z" => Self::Axis(2),
            "radius" => Self::Radius,
            "strength" => Self::Strength,
            "r" | "red" => Self::Color(0),
            "g" | "green" => Self::Color(1),
            "b" | "blue" => Self::Color(2),
            _ if options.values.iter().any(|wanted| wanted == name) => Self::Value(name.to_owned()),
            _ => Self::Nothing,
        }
    }

    /// By what an option says of it, which names attributes too.
    fn told(word: &str, options: &ParticleOptions) -> Self {
        match Self::named(word, options) {
            Self::Nothing if word != "-" => Self::Value(word.to_owned()),
            role => role,
        }
    }
}

/// The columns of a table, and the numbers that have been read.
pub(super) struct PointTable {
    roles: Vec<ColumnRole>,
    positions: Vec<f64>,
    radii: Vec<f64>,
    strengths: Vec<f64>,
    colors: Vec<f32>,
    values: Vec<Vec<f64>>,
    /// Where in a row: coordinates, colours, other numbers with what they are.
    axes: [usize; 3],
    rgb: Option<[usize; 3]>,
    radius: Option<usize>,
    strength: Option<usize>,
    others: Vec<(usize, String)>,
    /// Whether colours are bytes whatever their numbers.
    pub(super) colors_are_bytes: bool,
}

impl PointTable {
    /// Columns with these names. `Err`: no column is an axis.
    pub(super) fn named<'a>(
        names: impl Iterator<Item = &'a str>,
        options: &ParticleOptions,
    ) -> Result<Self, &'static str> {
        if options.columns.is_empty() {
            return Self::new(names.map(|name| ColumnRole::named(name, options)).collect());
        }
        Self::told(options)
    }

    /// Columns as an option tells them.
    pub(super) fn told(options: &ParticleOptions) -> Result<Self, &'static str> {
        Self::new(options.columns.iter().map(|word| ColumnRole::told(word, options)).collect())
    }

    pub(super) fn new(roles: Vec<ColumnRole>) -> Result<Self, &'static str> {
        let place = |role: ColumnRole| roles.iter().position(|known| *known == role);
        let three = |of: fn(usize) -> ColumnRole| -> Option<[usize; 3]> {
            Some([place(of(0))?, place(of(1))?, place(of(2))?])
        };
        let axes = three(ColumnRole::Axis).ok_or("expected columns x, y and z")?;
        let others: Vec<(usize, String)> = (roles.iter().enumerate())
            .filter_map(|(place, role)| match role {
                ColumnRole::Value(name) => Some((place, name.clone())),
                _ => None,
            })
            .collect();
        Ok(Self {
            axes,
            rgb: three(ColumnRole::Color),
            radius: place(ColumnRole::Radius),
            strength: place(ColumnRole::Strength),
            values: vec![Vec::new(); others.len()],
            others,
            roles,
            positions: Vec::new(),
            radii: Vec::new(),
            strengths: Vec::new(),
            colors: Vec::new(),
            colors_are_bytes: false,
        })
    }

    /// How many columns there are.
    pub(super) fn len(&self) -> usize {
        self.roles.len()
    }

    /// Whether nobody reads a column.
    pub(super) fn ignores(&self, column: usize) -> bool {
        self.roles[column] == ColumnRole::Nothing
    }

    /// One more row: a number for each column, whatever for those that nobody reads.
    pub(super) fn push(&mut self, row: &[f64]) {
        append(&mut self.positions, self.axes.map(|place| row[place]));
        self.radius.into_iter().for_each(|place| append(&mut self.radii, [row[place]]));
        self.strength.into_iter().for_each(|place| append(&mut self.strengths, [row[place]]));
        if let Some(rgb) = self.rgb {
            append(&mut self.colors, rgb.map(|place| row[place] as f32));
        }
        for (values, (place, _)) in self.values.iter_mut().zip(&self.others) {
            append(values, [row[*place]]);
        }
    }

    /// The points.
    pub(super) fn cloud(self) -> Cloud {
        let mut cloud = Cloud::at(self.positions);
        cloud.radii = self.radius.map(|_| self.radii.into());
        cloud.strengths = self.strength.map(|_| self.strengths.into());
        cloud.colors = self.rgb.map(|_| linear_colors(self.colors, self.colors_are_bytes));
        let others = self.others.into_iter().zip(self.values);
        cloud.values = others.map(|((_, name), values)| (name, 1, values.into())).collect();
        cloud
    }
}

/// Appends numbers, if there is memory for them.
fn append<T, const N: usize>(list: &mut Vec<T>, numbers: [T; N]) {
    watch::take_for(list, N);
    list.extend(numbers);
}

/// A cloud of `x y z` or of `x y z r g b`.
pub(super) fn cloud(bytes: &[u8], options: &ParticleOptions) -> ReadModel {
    table(bytes, options, 6)
}

/// A table whose columns have no names from so many on.
fn table(bytes: &[u8], options: &ParticleOptions, unnamed: usize) -> ReadModel {
    let mut lines = TextLines::from(bytes, 0).filter(|line| !line.is_blank() && !line.text.starts_with(b"#"));
    let Some(first) = lines.next() else {
        return Err(vec![Diagnostic::error(None, "the file has no lines")]);
    };
    let separator = Separator::of(first);
    let head: Vec<TextWord<'_>> = separator.split(first).take(MAX_TABLE_COLUMNS + 1).collect();
    if let Some(beyond) = head.get(MAX_TABLE_COLUMNS) {
        let message = format!("the line has more than {MAX_TABLE_COLUMNS} columns");
        return Err(vec![Diagnostic::limit(Some(beyond.span()), message)]);
    }
    let has_names = head.iter().any(|word| word.number().is_none());
    let mut warnings = Vec::new();
    let made = if has_names {
        let names: Vec<String> =
            head.iter().map(|word| String::from_utf8_lossy(word.text).into_owned()).collect();
        let made = PointTable::named(names.iter().map(String::as_str), options);
        if let Ok(table) = &made
            && options.columns.is_empty()
        {
            warnings.extend(left_out(
                names.iter().enumerate().filter(|(place, _)| table.ignores(*place)).map(|it| it.1),
            ));
        }
        made
    } else if !options.columns.is_empty() {
        PointTable::told(options)
    } else {
        let names = if head.len() >= 6 && unnamed == 6 { &NAMES[..] } else { &NAMES[..3] };
        PointTable::named(names.iter().copied(), options)
    };
    let mut table = made.map_err(|expected| {
        vec![Diagnostic::error(Some(first.span()), "this line tells no places").expected(expected)]
    })?;
    let mut row = vec![0.0; table.len()];
    for line in (!has_names).then_some(first).into_iter().chain(lines) {
        read_row(line, separator, &table, &mut row)?;
        table.push(&row);
    }
    let mut cloud = table.cloud();
    cloud.warnings = warnings;
    cloud.model(options)
}

/// The columns of a cloud.
const NAMES: [&str; 6] = ["x", "y", "z", "r", "g", "b"];

/// A note about arrays or columns that are left out.
pub(super) fn left_out<'a>(names: impl Iterator<Item = &'a String>) -> Option<Diagnostic> {
    let told = listed(names)?;
    Some(Diagnostic::warning(None, format!("{told} left out: --values makes attributes of them")))
}

/// Names with the verb of a sentence about them, the first ones of many; nothing if there are none.
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a String>) -> Option<String> {
    const MOST: usize = 8;
    let mut names = names.map(|name| format!("`{}`", jbt_model::report::clip(name)));
    let first: Vec<String> = names.by_ref().take(MOST).collect();
    let verb = if first.len() == 1 { "is" } else { "are" };
    let first = (!first.is_empty()).then(|| first.join(", "))?;
    Some(match names.count() {
        0 => format!("{first} {verb}"),
        more => format!("{first} and {more} more are"),
    })
}

fn read_row(
    line: TextLine<'_>,
    separator: Separator,
    table: &PointTable,
    row: &mut [f64],
) -> Result<(), Vec<Diagnostic>> {
    let mut words = separator.split(line);
    for (column, number) in row.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            let message = format!("a line of {column} columns");
            return Err(fault(line.span(), message, &format!("{} columns", table.len())));
        };
        if !table.ignores(column) {
            *number = word.expect_number(&format!("column {}", column + 1))?;
        }
    }
    Ok(())
}

/// What stands between columns.
#[derive(Clone, Copy)]
enum Separator {
    Mark(u8),
    Blanks,
}

impl Separator {
    /// That of a line.
    fn of(line: TextLine<'_>) -> Self {
        let marks = [b';', b'\t', b','];
        let found = marks.into_iter().find(|mark| line.text.contains(mark));
        found.map_or(Self::Blanks, Self::Mark)
    }

    /// The columns of a line, without quotes.
    fn split(self, line: TextLine<'_>) -> impl Iterator<Item = TextWord<'_>> {
        let mark = if let Self::Mark(mark) = self { Some(mark) } else { None };
        let mut words = line.words();
        let mut rest = Some(line.text);
        let mut start = line.start;
        std::iter::from_fn(move || {
            let Some(mark) = mark else { return words.next() };
            let text = rest?;
            let length = text.iter().position(|&byte| byte == mark);
            let word = TextWord { text: &text[..length.unwrap_or(text.len())], start }.trimmed();
            rest = length.map(|length| &text[length + 1..]);
            start += length.map_or(text.len(), |length| length + 1);
            Some(match word.text {
                [b'"', inner @ .., b'"'] => TextWord { text: inner, start: word.start + 1 },
                _ => word,
            })
        })
    }
}
