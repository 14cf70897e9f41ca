//! A contest: contestants that were checked against each other do the same work in turn, and the median of each counts.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Who takes part. The order is that of the table's columns.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Contestant {
    /// The compiler.
    Ours,
    /// The hand-written program for sums of points, see [`crate::limit`].
    Limit,
    /// fidget's machine code.
    FidgetJit,
    /// fidget's interpreter.
    FidgetVm,
    /// splashsurf.
    Splashsurf,
    /// A tree walker, see [`crate::naive`].
    Walk,
    /// Separate walks for each answer, see [`crate::naive`].
    Separate,
}

impl Contestant {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Ours,
        Self::Limit,
        Self::FidgetJit,
        Self::FidgetVm,
        Self::Splashsurf,
        Self::Walk,
        Self::Separate,
    ];

    /// The name in keys and columns.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Limit => "limit",
            Self::FidgetJit => "fidget_jit",
            Self::FidgetVm => "fidget_vm",
            Self::Splashsurf => "splashsurf",
            Self::Walk => "walk",
            Self::Separate => "separate",
        }
    }

    /// Whether it is what we measure, and not what we measure against.
    const fn is_measured_well(self) -> bool {
        match self {
            Self::Ours | Self::Limit => true,
            Self::FidgetJit | Self::FidgetVm | Self::Splashsurf | Self::Walk | Self::Separate => false,
        }
    }
}

/// How long to measure.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Effort {
    /// Rounds go on for about this long.
    pub budget: Duration,
    /// Who is not ours and takes longer than this runs once.
    pub patience: Duration,
}

/// Fewest runs of ours and of the limit.
const LEAST_ROUNDS: usize = 5;
/// More rounds say nothing more.
const MOST_ROUNDS: usize = 51;
/// A measurement takes at least this long: what is faster is run several times.
const SAMPLE: Duration = Duration::from_millis(1);

/// Somebody's way of doing the work.
struct Entry<'a> {
    contestant: Contestant,
    /// Which of the contestant's ways.
    form: &'static str,
    run: Box<dyn FnMut() + 'a>,
    /// Runs in a measurement.
    batch: u32,
    samples: Vec<Duration>,
}

impl Entry<'_> {
    fn measure(&mut self) -> Duration {
        let start = Instant::now();
        for _ in 0..self.batch {
            (self.run)();
        }
        start.elapsed() / self.batch
    }

    /// The first run: it warms caches up, and tells how often the others may run. It counts where it takes long.
    fn begin(&mut self) {
        let first = self.measure();
        if first >= SAMPLE * 100 {
            self.samples.push(first);
        }
        let batch = SAMPLE.as_nanos().div_ceil(first.as_nanos().max(1));
        self.batch = u32::try_from(batch).unwrap_or(u32::MAX).clamp(1, 100_000);
        if self.samples.is_empty() && self.batch == 1 {
            return;
        }
        if self.samples.is_empty() {
            // The first run may have been slow for being the first.
            let again = self.measure();
            let batch = SAMPLE.as_nanos().div_ceil(again.as_nanos().max(1));
            self.batch = u32::try_from(batch).unwrap_or(u32::MAX).clamp(1, 100_000);
        }
    }
}

/// The median of a contestant, in its fastest form.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Standing {
    /// Who.
    pub contestant: Contestant,
    /// Which of the contestant's ways was fastest; empty if there is one.
    pub form: &'static str,
    /// Of a whole run.
    pub median: Duration,
}

/// What came out.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Standings {
    /// One for each contestant that was timed, in the order of [`Contestant`].
    pub standings: Vec<Standing>,
    /// Who was not timed, and why.
    pub disagreements: Vec<String>,
}

/// A contest that is being prepared.
#[derive(Default)]
pub struct Contest<'a> {
    entries: Vec<Entry<'a>>,
    disagreements: Vec<String>,
}

impl<'a> Contest<'a> {
    /// Nobody takes part yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Enters a contestant, or notes why it does not take part: its answers are not what they should be.
    pub fn enter<T>(
        &mut self,
        contestant: Contestant,
        form: &'static str,
        checked: Result<(), String>,
        mut run: impl FnMut() -> T + 'a,
    ) {
        if let Err(reason) = checked {
            let form = if form.is_empty() { String::new() } else { format!(" ({form})") };
            self.disagreements.push(format!("{}{form}: {reason}", contestant.name()));
            return;
        }
        let run = Box::new(move || {
            black_box(run());
        });
        self.entries.push(Entry { contestant, form, run, batch: 1, samples: Vec::new() });
    }

    /// Lets all run in turn.
    #[must_use]
    pub fn run(mut self, effort: Effort) -> Standings {
        for entry in &mut self.entries {
            entry.begin();
        }
        let start = Instant::now();
        for round in 0..MOST_ROUNDS {
            let over = round >= LEAST_ROUNDS && start.elapsed() >= effort.budget;
            let mut ran = false;
            for entry in &mut self.entries {
                let slow = entry.samples.first().is_some_and(|&first| first > effort.patience);
                let done = if entry.contestant.is_measured_well() {
                    over || (slow && entry.samples.len() >= LEAST_ROUNDS)
                } else {
                    over || slow
                };
                if !done {
                    let sample = entry.measure();
                    entry.samples.push(sample);
                    ran = true;
                }
            }
            if !ran {
                break;
            }
        }
        Standings { standings: standings(self.entries), disagreements: self.disagreements }
    }
}

/// The fastest form of each contestant.
fn standings(entries: Vec<Entry<'_>>) -> Vec<Standing> {
    let mut standings: Vec<Standing> = Vec::new();
    for mut entry in entries {
        let (contestant, form) = (entry.contestant, entry.form);
        let median = median(&mut entry.samples);
        match standings.iter_mut().find(|standing| standing.contestant == contestant) {
            Some(known) if known.median <= median => {}
            Some(known) => *known = Standing { contestant, form, median },
            None => standings.push(Standing { contestant, form, median }),
        }
    }
    standings.sort_by_key(|standing| standing.contestant);
    standings
}

/// The median; the mean of the two in the middle of an even number.
fn median(samples: &mut [Duration]) -> Duration {
    samples.sort_unstable();
    let middle = samples.len() / 2;
    if samples.len() % 2 == 1 { samples[middle] } else { (samples[middle - 1] + samples[middle]) / 2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    const EFFORT: Effort = Effort { budget: Duration::from_millis(5), patience: Duration::from_millis(120) };

    #[test]
    fn medians() {
        let ms = Duration::from_millis;
        assert_eq!(median(&mut [ms(5), ms(1), ms(2)]), ms(2));
        assert_eq!(median(&mut [ms(4), ms(1), ms(2), ms(9)]), ms(3));
    }

    #[test]
    fn ours_runs_five_times_however_long_it_takes_and_others_once() {
        let (ours, walk) = (Cell::new(0), Cell::new(0));
        let count = |counter: &Cell<u32>| {
            counter.set(counter.get() + 1);
            std::thread::sleep(Duration::from_millis(130));
        };
        let mut contest = Contest::new();
        contest.enter(Contestant::Ours, "", Ok(()), || count(&ours));
        contest.enter(Contestant::Walk, "", Ok(()), || count(&walk));
        let standings = contest.run(EFFORT);
        assert_eq!((ours.get(), walk.get()), (5, 1));
        assert_eq!(standings.standings.len(), 2);
    }

    #[test]
    fn who_disagrees_is_not_timed() {
        let ran = Cell::new(false);
        let mut contest = Contest::new();
        contest.enter(Contestant::Ours, "", Ok(()), || ());
        contest.enter(Contestant::FidgetVm, "if", Err("7 is not 8".to_owned()), || ran.set(true));
        let Standings { standings, disagreements } = contest.run(EFFORT);
        assert!(!ran.get());
        assert_eq!(disagreements, ["fidget_vm (if): 7 is not 8"]);
        assert_eq!(standings.len(), 1);
    }

    #[test]
    fn the_fastest_form_counts() {
        let mut contest = Contest::new();
        for (form, time) in [("slow", 3), ("fast", 1), ("slower", 5)] {
            contest.enter(Contestant::FidgetJit, form, Ok(()), move || {
                std::thread::sleep(Duration::from_millis(time));
            });
        }
        assert_eq!(contest.run(EFFORT).standings[0].form, "fast");
    }
}
