//! Parts that are thinner than a cell: a lattice cannot show them, so they are reported.
//!
//! ```text
//! crossed blocks (4^3 cells)      what the corners of their cells tell: scraps, rows of lone points
//! (crossed) the others, in bricks           ranges exclude the other side, or a point on it is found
//!      (search) alarms, joined to places        a point of each, and how fine cells would have to be
//!          (measure)
//! ```
//!
//! The findings are a function of the field and the lattice: bricks and threads do not change them.

mod alarm;
mod crossed;
mod measure;
mod search;
mod shreds;

use crate::parallel::*;

use super::crossing::Crossings;
use super::divide::BrickDivision;
use super::error::MeshError;
use super::field::Field;
use super::indexed::Mesh;
use super::report::{MAX_NEAR, ThinReport};
use super::stage::MeshStage;
use super::vertex::side::SharpVertex;
use crate::morton::morton;
use crate::progress::Progress;
use crate::span::span;

use alarm::{ALARM, Alarm};
use crossed::{CrossedBlocks, EDGE, step};
use search::{ChunkFindings, ThinSearch};
use shreds::{Chunks, Looked};

/// Searches the bricks of a division.
pub(super) fn find<F: Field>(
    field: &F,
    division: &BrickDivision<F::Region>,
    (crossings, mesh, sharp): (&Crossings, &Mesh, &[SharpVertex]),
    iso: f32,
    progress: &Progress<'_>,
) -> Result<ThinReport, MeshError<F::Error>> {
    span!("thin parts");
    let bricks = &division.bricks;
    let crossed = {
        span!("crossed blocks");
        CrossedBlocks::new(bricks, crossings)
    };
    let (edge, places, regions) = match &division.chunks {
        Some((places, regions)) => (2 * EDGE, places, regions),
        None => (bricks.edge, &bricks.places, &division.regions),
    };
    let chunks = &Chunks { edge, places, regions };
    let looked = Looked { field, iso, bricks, crossings, crossed: &crossed, chunks, mesh, sharp };
    let mut alarms = looked.shreds()?;
    let mut report = ThinReport { shredded: alarms.len() as u64, ..ThinReport::default() };
    let blocks = (bricks.edge == EDGE).then(|| (&bricks.places[..], &division.regions[..]));
    let search = ThinSearch { field, axes: &bricks.axes, iso, crossed: &crossed, blocks };
    let group = 16;
    let total = places.len().div_ceil(group);
    MeshStage::Thin.begin(progress)?;
    let of_group = |(places, regions): (&[[u32; 3]], &[F::Region])| {
        span!("search of some boxes");
        let (mut found, mut near) = (ChunkFindings::default(), 0);
        for (&place, region) in places.iter().zip(regions) {
            search.chunk((edge, place), region, &mut near, &mut found)?;
            progress.breathe()?;
        }
        progress.add(1.0 / total as f64)?;
        Ok::<_, MeshError<F::Error>>(found)
    };
    let found: Vec<ChunkFindings> = scatter(|watches| {
        let groups = places.par_chunks(group).zip(regions.par_chunks(group));
        in_pieces(groups).map(|group| watches.hold(|| of_group(group))).collect::<Result<_, _>>()
    })?;
    for found in found {
        report.missed += found.missed.len() as u64;
        report.unproven += found.unproven;
        report.boxes += found.boxes;
        let missed = found.missed.into_iter();
        alarms.extend(missed.map(|(place, point)| Alarm { place, point, weight: ALARM }));
    }
    alarms.sort_by_key(|alarm| morton(alarm.place));
    let places = join(&alarms);
    report.places = places.len() as u64;
    let points: Vec<[f32; 3]> = places.iter().take(MAX_NEAR).map(|&alarm| alarms[alarm].point).collect();
    span!("measure of thin parts");
    report.cell = measure::cell(field, &bricks.axes, iso, &points)?;
    report.near = points.iter().map(|point| point.map(f64::from)).collect();
    Ok(report)
}

/// Joins alarms, which are in Morton order, to places; returns the first alarm of each.
fn join(alarms: &[Alarm]) -> Vec<usize> {
    let codes: Vec<u64> = alarms.iter().map(|alarm| morton(alarm.place)).collect();
    let mut seen = vec![false; alarms.len()];
    let mut places = Vec::new();
    for first in 0..alarms.len() {
        let (mut waiting, mut weight) = (vec![first], 0_u32);
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        while let Some(alarm) = waiting.pop() {
            weight = weight.saturating_add(alarms[alarm].weight);
            for direction in 0..27 {
                let steps = [direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1];
                let Some(place) = step(alarms[alarm].place, steps) else { continue };
                let Ok(other) = codes.binary_search(&morton(place)) else { continue };
                if !std::mem::replace(&mut seen[other], true) {
                    waiting.push(other);
                }
            }
        }
        if weight >= ALARM {
            places.push(first);
        }
    }
    places
}
