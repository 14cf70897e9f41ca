//! Positions differ, so that a mesh is closed also for programs that merge equal ones.

use std::collections::HashMap;
use std::fmt::Write as _;

use jbt::Fineness;
use jbt::export::{Format, write};
use jbt::mesh::{Lattice, Mesh, Options, check_manifold, extract};

use crate::fields::{Closed, hash, signs, sphere};
use crate::models::mesh_in;

/// How many positions are left when equal ones are one, and the triangles over these.
fn merge(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
    let mut numbers = HashMap::new();
    // Zeros are equal, whatever their sign.
    let key = |position: &[f32; 3]| position.map(|c| (c + 0.0).to_bits());
    let merged: Vec<u32> = positions
        .iter()
        .map(|position| {
            let next = numbers.len() as u32;
            *numbers.entry(key(position)).or_insert(next)
        })
        .collect();
    (numbers.len(), triangles.iter().map(|triangle| triangle.map(|v| merged[v as usize])).collect())
}

fn real(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

fn place(bytes: &[u8], at: usize) -> [f32; 3] {
    [0, 4, 8].map(|offset| real(bytes, at + offset))
}

/// The vertices as a file has them, with triangles over them.
fn read(mesh: &Mesh, format: Format) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut bytes = Vec::new();
    write(mesh, format, &mut bytes).expect("it is written");
    let count = mesh.positions.len();
    let find =
        |text: &[u8]| bytes.windows(text.len()).position(|w| w == text).expect("it is there") + text.len();
    let planes = |first: usize, step: usize| (0..count).map(|n| place(&bytes, first + n * step)).collect();
    match format {
        Format::Obj => {
            let text = String::from_utf8(bytes).expect("text");
            let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
            let real = |word: &str| word.parse::<f32>().expect("a number");
            let positions = lines.map(|line| {
                let words: Vec<f32> = line.split(' ').map(real).collect();
                [words[0], words[1], words[2]]
            });
            (positions.collect(), mesh.triangles.clone())
        }
        // Position and normal, and nothing else: the model has no attributes but a colour of three bytes at
        // most.
        Format::Ply => {
            let first = find(b"end_header\n");
            let faces = 13 * mesh.triangles.len();
            let step = (bytes.len() - first - faces) / count;
            (planes(first, step), mesh.triangles.clone())
        }
        Format::Glb => (planes(find(b"BIN\0"), 12), mesh.triangles.clone()),
        Format::Usda => {
            let text = String::from_utf8(bytes).expect("text");
            let list = text.split_once("points = [").expect("points").1.split_once(']').expect("an end").0;
            let real = |word: &str| {
                word.trim_matches(|c: char| "( )\n".contains(c)).parse::<f32>().expect("a number")
            };
            let reals: Vec<f32> = list.split(',').map(real).collect();
            (reals.as_chunks().0.to_vec(), mesh.triangles.clone())
        }
        Format::ThreeMf => {
            let text = String::from_utf8(unpacked(&bytes)).expect("text");
            let lines = text.lines().filter_map(|line| line.strip_prefix("<vertex "));
            let positions = lines.map(|line| {
                let words: Vec<f32> =
                    line.split('"').skip(1).step_by(2).map(|word| word.parse().expect("a number")).collect();
                [words[0], words[1], words[2]]
            });
            (positions.collect(), mesh.triangles.clone())
        }
        Format::Stl => {
            let corners = mesh.triangles.iter().enumerate().flat_map(|(n, _)| {
                let first = 84 + 50 * n + 12;
                [0, 12, 24].map(|corner| place(&bytes, first + corner))
            });
            let soup: Vec<[f32; 3]> = corners.collect();
            let triangles = (0..mesh.triangles.len() as u32).map(|n| [0, 1, 2].map(|corner| 3 * n + corner));
            (soup, triangles.collect())
        }
    }
}

/// The last entry of an archive.
fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let start = bytes.windows(4).rposition(|word| word == b"PK\x03\x04").expect("an entry");
    let name = usize::from(bytes[start + 26]);
    let mut text = Vec::new();
    let mut packed = flate2::read::DeflateDecoder::new(&bytes[start + 30 + name..]);
    std::io::Read::read_to_end(&mut packed, &mut text).expect("it is deflated");
    text
}

#[track_caller]
fn assert_apart(mesh: &Mesh) {
    let (count, triangles) = merge(&mesh.positions, &mesh.triangles);
    assert_eq!(count, mesh.positions.len());
    assert_eq!(check_manifold(count, &triangles), Ok(()));
}

/// 20,000 random particles about as large as a cell: thousands of cells have two sheets, and in hundreds of
/// places sheets all but touch.
#[test]
fn particles_are_closed_when_equal_positions_are_merged() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 23) - 1.0
    };
    let mut text = "jbt 1 sum {".to_owned();
    for _ in 0..20_000 {
        let [x, y, z] = [0; 3].map(|_| random());
        write!(text, " point {{ at ({x:.4} {y:.4} {z:.4}) surface_radius 0.04 }}")
            .expect("a string takes all");
    }
    text.push('}');
    let made = mesh_in(&text, None, Fineness::Cell(0.03));
    assert!(made.report.closed && !made.report.crowded && made.mesh.positions.len() > 100_000);
    assert_apart(&made.mesh);
    for format in Format::ALL {
        let (positions, triangles) = read(&made.mesh, format);
        let (count, triangles) = merge(&positions, &triangles);
        assert_eq!(count, made.mesh.positions.len(), "{format:?}");
        assert_eq!(check_manifold(count, &triangles), Ok(()), "{format:?}");
    }
}

/// Two, three and four sheets in most cells, pulled to the same corners of them by a gradient that has
/// nothing to do with them.
#[test]
fn sheets_of_one_cell_are_apart() {
    for seed in 0..12 {
        let inside = |p: [i64; 3]| p.iter().all(|&c| c > 0 && c < 20) && hash(seed, p) & 1 == 1;
        let flat = signs(inside);
        let tilted = |p: [f32; 3]| (flat(p).0, [0.3, -0.2, 0.1]);
        let lattice = Lattice::new([0.0; 3], 1.0, [20; 3]).unwrap();
        for pulls in [0, 1, 2] {
            let options = Options { pulls, ..Options::default() };
            assert_apart(&extract(&Closed(tilted), &lattice, &options).run().unwrap().0);
        }
        // Near the iso-value, the steps stay in the cells and end on one point of each.
        let saddle = |p: [f32; 3]| {
            let q = p.map(|c| c - c.round());
            let sign = if inside(p.map(|c| c.round() as i64)) { 1.0 } else { -1.0 };
            (0.5 + sign * 1e-3 * (1.0 - 3.0 * (q[0] * q[0]).max(q[1] * q[1])), [1e-4 * q[0], 0.0, 1.0])
        };
        assert_apart(&extract(&Closed(saddle), &lattice, &Options::default()).run().unwrap().0);
    }
}

/// Far out there are few numbers in a cell, and the report says so.
#[test]
fn crowded_cells_are_told() {
    let center = [100_000.0, -100_000.0, 33_000.0];
    let report = |cell: f64| {
        let [low, high] = [-2.0, 2.0].map(|way| center.map(|c: f64| c + way));
        let lattice = Lattice::covering(low, high, cell).unwrap();
        let ball = sphere(center.map(|c| c as f32), 1.0);
        extract(&Closed(ball), &lattice, &Options::default()).run().unwrap().1
    };
    assert!(!report(0.25).crowded);
    assert!(report(0.0625).crowded);
}
