//! A contest: contestants that were checked against each other do the same work in turn, and the median of
//! each counts.
//!
//! A machine may change its clock while they run. So a ratio of two contestants is no ratio of their medians:
//! it is the median of the ratios within each round, in which they ran one behind the other.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Who takes part. The order is that of the table's columns.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Contestant {
    /// The compiler.
    Ours,
    /// The hand-written program for sums of points, see [`crate::limit`].
    Limit,
    /// The compiler, with the search for parts that its mesh misses.
    Searched,
    /// The compiler, everything made anew after an edit but the code.
    Whole,
    /// The compiler on one thread, beside itself on several.
    OneThread,
    /// The same work on each of several threads at once, with one thread each: what the machine has for all
    /// of them, where they wait for nobody.
    Apart,
    /// The compiler's interpreter, beside its machine code.
    Lanes,
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
    pub const ALL: [Self; 12] = [
        Self::Ours,
        Self::Limit,
        Self::Searched,
        Self::Whole,
        Self::OneThread,
        Self::Apart,
        Self::Lanes,
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
            Self::Searched => "searched",
            Self::Whole => "whole",
            Self::OneThread => "one_thread",
            Self::Apart => "apart",
            Self::Lanes => "lanes",
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
            Self::Ours
            | Self::Limit
            | Self::Searched
            | Self::Whole
            | Self::OneThread
            | Self::Apart
            | Self::Lanes => true,
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
    /// Whoever takes longer than this runs once, ours and the limit too.
    pub endurance: Duration,
}

/// Fewest runs of ours and of the limit, unless they take longer than [`Effort::endurance`].
const LEAST_ROUNDS: usize = 5;
/// Fewest rounds of both of which ratios are taken.
const LEAST_PAIRS: usize = 3;
/// More rounds say nothing more.
const MOST_ROUNDS: usize = 51;
/// A measurement takes at least this long: what is faster is run several times.
const SAMPLE: Duration = Duration::from_millis(1);
/// A first run of at least this long counts: warming up is a small part of it.
const LONG: Duration = Duration::from_millis(100);

/// Somebody's way of doing the work.
struct ContestEntry<'a> {
    contestant: Contestant,
    /// Which of the contestant's ways.
    form: &'static str,
    run: Box<dyn FnMut() + 'a>,
    /// The time of the first run, if there was one: its answer was checked.
    first: Option<Duration>,
    /// Runs in a measurement.
    batch: u32,
    samples: Vec<TimeSample>,
}

/// A measurement.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TimeSample {
    /// The round, from 1; 0 for a first run that counts.
    pub round: usize,
    /// Of a whole run.
    pub time: Duration,
}

impl ContestEntry<'_> {
    fn measure(&mut self) -> Duration {
        let start = Instant::now();
        for _ in 0..self.batch {
            (self.run)();
        }
        start.elapsed() / self.batch
    }

    /// The first run, unless the check was: it warms caches up, and tells how often the others may run. It
    /// counts where it takes long.
    fn begin(&mut self) {
        let first = self.first.unwrap_or_else(|| self.measure());
        if first >= LONG {
            self.samples.push(TimeSample { round: 0, time: first });
            return;
        }
        if first < SAMPLE {
            self.batch = batch(first);
            // The first run may have been slow for being the first.
            self.batch = batch(self.measure());
        }
    }

    /// Whether another round is needed; `over` once the contest has gone on for long enough.
    fn goes_on(&self, effort: Effort, over: bool) -> bool {
        let Some(&TimeSample { time: first, .. }) = self.samples.first() else { return true };
        if first > effort.endurance {
            return false;
        }
        if first <= effort.patience {
            return !over;
        }
        self.contestant.is_measured_well() && self.samples.len() < LEAST_ROUNDS
    }
}

/// How many runs of this time make a measurement.
fn batch(run: Duration) -> u32 {
    let batch = SAMPLE.as_nanos().div_ceil(run.as_nanos().max(1));
    u32::try_from(batch).unwrap_or(u32::MAX).clamp(1, 100_000)
}

/// A contestant, in its fastest form.
#[derive(Clone, PartialEq, Debug)]
pub struct Standing {
    /// Who.
    pub contestant: Contestant,
    /// Which of the contestant's ways was fastest; empty if there is one.
    pub form: &'static str,
    /// Of a whole run.
    pub median: Duration,
    /// All measurements, in their order.
    pub samples: Vec<TimeSample>,
}

/// What came out.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Standings {
    /// One for each contestant that was timed, in the order of [`Contestant`].
    pub standings: Vec<Standing>,
    /// Who was not timed, and why.
    pub disagreements: Vec<String>,
}

impl Standings {
    /// A contestant, if it was timed.
    #[must_use]
    pub fn of(&self, contestant: Contestant) -> Option<&Standing> {
        self.standings.iter().find(|standing| standing.contestant == contestant)
    }
}

impl Standing {
    /// How many times as long as another one this one takes: the median over all rounds in which both ran; of
    /// their medians, if there are fewer than three of these.
    #[must_use]
    pub fn ratio(&self, other: &Self) -> f64 {
        let behind = |sample: &TimeSample| other.samples.iter().find(|their| their.round == sample.round);
        let pairs = self.samples.iter().filter_map(|sample| Some((sample.time, behind(sample)?.time)));
        let mut ratios: Vec<f64> =
            pairs.map(|(ours, theirs)| ours.as_secs_f64() / theirs.as_secs_f64()).collect();
        if ratios.len() < LEAST_PAIRS {
            return self.median.as_secs_f64() / other.median.as_secs_f64();
        }
        ratios.sort_unstable_by(f64::total_cmp);
        f64::midpoint(ratios[(ratios.len() - 1) / 2], ratios[ratios.len() / 2])
    }
}

/// A contest that is being prepared.
#[derive(Default)]
pub struct Contest<'a> {
    entries: Vec<ContestEntry<'a>>,
    disagreements: Vec<String>,
}

impl<'a> Contest<'a> {
    /// Nobody takes part yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Enters a contestant whose answers were checked, or notes why it does not take part: they are not what
    /// they should be.
    pub fn enter<T>(
        &mut self,
        contestant: Contestant,
        form: &'static str,
        checked: Result<(), String>,
        run: impl FnMut() -> T + 'a,
    ) {
        self.admit(contestant, form, checked, None, run);
    }

    /// Enters a contestant that takes long: it runs here for the first time, that run is timed and its answer
    /// checked. The run counts where it is long, so that nothing runs for its check alone.
    pub fn enter_checked<T>(
        &mut self,
        contestant: Contestant,
        form: &'static str,
        mut run: impl FnMut() -> T + 'a,
        check: impl FnOnce(&T) -> Result<(), String>,
    ) {
        let start = Instant::now();
        let answer = black_box(run());
        let made = start.elapsed();
        let checked = check(&answer);
        // Other runs drop what they made while they are timed.
        let start = Instant::now();
        drop(answer);
        self.admit(contestant, form, checked, Some(made + start.elapsed()), run);
    }

    fn admit<T>(
        &mut self,
        contestant: Contestant,
        form: &'static str,
        checked: Result<(), String>,
        first: Option<Duration>,
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
        self.entries.push(ContestEntry { contestant, form, run, first, batch: 1, samples: Vec::new() });
    }

    /// Lets all run in turn; for the first half of the time, those that are measured well alone. Where a peer
    /// takes seconds, others that take milliseconds would have few runs otherwise, and each of them behind
    /// the peer: on threads that the system has parked on one processor, in memory that it has taken back.
    #[must_use]
    pub fn run(mut self, effort: Effort) -> Standings {
        for entry in &mut self.entries {
            entry.begin();
        }
        let (start, mut together) = (Instant::now(), 0);
        for round in 0..MOST_ROUNDS {
            let alone = together == 0 && round < MOST_ROUNDS / 2 && start.elapsed() < effort.budget / 2;
            let over = together >= LEAST_ROUNDS && start.elapsed() >= effort.budget;
            let mut ran = false;
            // There and back: nobody runs behind the same one each time, in the memory and the caches that
            // this one has left.
            let mut order: Vec<_> = self.entries.iter_mut().collect();
            if round % 2 == 1 {
                order.reverse();
            }
            for entry in order {
                let takes_part = !alone || entry.contestant.is_measured_well();
                if takes_part && entry.goes_on(effort, over) {
                    let time = entry.measure();
                    entry.samples.push(TimeSample { round: round + 1, time });
                    ran = true;
                }
            }
            together += usize::from(!alone);
            if !ran && !alone {
                break;
            }
        }
        Standings { standings: standings(self.entries), disagreements: self.disagreements }
    }
}

/// The fastest form of each contestant.
fn standings(entries: Vec<ContestEntry<'_>>) -> Vec<Standing> {
    let mut standings: Vec<Standing> = Vec::new();
    for ContestEntry { contestant, form, samples, .. } in entries {
        let mut times: Vec<Duration> = samples.iter().map(|sample| sample.time).collect();
        let standing = Standing { contestant, form, median: median(&mut times), samples };
        match standings.iter_mut().find(|standing| standing.contestant == contestant) {
            Some(known) if known.median <= standing.median => {}
            Some(known) => *known = standing,
            None => standings.push(standing),
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

    const EFFORT: Effort = Effort {
        budget: Duration::from_millis(5),
        patience: Duration::from_millis(120),
        endurance: Duration::from_millis(600),
    };

    /// Counts a call, and takes this many milliseconds.
    fn work(calls: &Cell<u32>, millis: u64) -> u32 {
        calls.set(calls.get() + 1);
        std::thread::sleep(Duration::from_millis(millis));
        calls.get()
    }

    #[test]
    fn medians() {
        let ms = Duration::from_millis;
        assert_eq!(median(&mut [ms(5), ms(1), ms(2)]), ms(2));
        assert_eq!(median(&mut [ms(4), ms(1), ms(2), ms(9)]), ms(3));
    }

    #[test]
    fn a_clock_that_changes_does_not_change_ratios() {
        let ms = Duration::from_millis;
        let standing = |contestant, times: [u64; 5]| {
            let samples = times.iter().zip(1..).map(|(&time, round)| TimeSample { round, time: ms(time) });
            Standing { contestant, form: "", median: median(&mut times.map(ms)), samples: samples.collect() }
        };
        // The clock halves in the third round, between the two.
        let ours = standing(Contestant::Ours, [12, 12, 12, 24, 24]);
        let limit = standing(Contestant::Limit, [10, 10, 20, 20, 20]);
        assert!((ours.ratio(&limit) - 1.2).abs() < 1e-12);
        let mut once = limit.clone();
        once.samples.truncate(1);
        assert!((ours.ratio(&once) - 0.6).abs() < 1e-12, "of the medians");
    }

    #[test]
    fn ours_runs_a_few_times_though_it_takes_long_and_others_once() {
        let (ours, walk) = (Cell::new(0), Cell::new(0));
        let mut contest = Contest::new();
        contest.enter(Contestant::Ours, "", Ok(()), || work(&ours, 130));
        contest.enter(Contestant::Walk, "", Ok(()), || work(&walk, 130));
        let standings = contest.run(EFFORT);
        assert_eq!((ours.get(), walk.get()), (LEAST_ROUNDS as u32, 1));
        assert_eq!(standings.standings.len(), 2);
    }

    #[test]
    fn beyond_endurance_all_run_once() {
        let calls = Cell::new(0);
        let mut contest = Contest::new();
        contest.enter(Contestant::Ours, "", Ok(()), || work(&calls, 610));
        let standings = contest.run(EFFORT).standings;
        assert_eq!(calls.get(), 1);
        assert!(standings[0].median >= Duration::from_millis(610));
    }

    #[test]
    fn a_long_first_run_is_checked_and_counts() {
        let (ours, walk, limit) = (Cell::new(0), Cell::new(0), Cell::new(0));
        let mut seen = 0;
        let mut contest = Contest::new();
        let see = |answer: &u32| {
            seen = *answer;
            Ok(())
        };
        contest.enter_checked(Contestant::Ours, "", || work(&ours, 130), see);
        contest.enter_checked(Contestant::Walk, "", || work(&walk, 130), |_| Ok(()));
        contest.enter_checked(Contestant::Limit, "", || work(&limit, 610), |_| Ok(()));
        let standings = contest.run(EFFORT).standings;
        assert_eq!((ours.get(), walk.get(), limit.get()), (LEAST_ROUNDS as u32, 1, 1));
        assert_eq!(seen, 1);
        for (standing, millis) in standings.iter().zip([130, 610, 130]) {
            assert!(standing.median >= Duration::from_millis(millis), "{standing:?}");
        }
    }

    #[test]
    fn a_short_first_run_is_checked_and_does_not_count() {
        let calls = Cell::new(0);
        let mut contest = Contest::new();
        let slow_at_first = || {
            let first = calls.get() == 0;
            work(&calls, if first { 40 } else { 2 })
        };
        contest.enter_checked(Contestant::Ours, "", slow_at_first, |_| Ok(()));
        let standings = contest.run(EFFORT).standings;
        assert!(calls.get() > LEAST_ROUNDS as u32, "{}", calls.get());
        assert!(standings[0].median < Duration::from_millis(40), "{standings:?}");
    }

    #[test]
    fn who_disagrees_on_the_first_run_does_not_run_again() {
        let calls = Cell::new(0);
        let mut contest = Contest::new();
        contest.enter_checked(
            Contestant::FidgetJit,
            "if",
            || work(&calls, 1),
            |answer| Err(format!("{answer} is not 2")),
        );
        let Standings { standings, disagreements } = contest.run(EFFORT);
        assert_eq!(calls.get(), 1);
        assert_eq!(disagreements, ["fidget_jit (if): 1 is not 2"]);
        assert!(standings.is_empty());
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
