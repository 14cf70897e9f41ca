//! Quadtrees as SVG: what was looked at, where the contour is, and the circles' radii, a panel for each mode.

use std::fmt::Write as _;

use super::circles::Circle;
use super::lattice::{Block, CELLS, Place, SPACING, coordinate};

/// A quadtree to be drawn.
pub struct Panel {
    /// Outlined.
    pub blocks: Vec<Block>,
    /// Filled.
    pub cells: Vec<Place>,
}

/// Between panels, in cells.
const GAP: u32 = 16;

/// Pixels to a cell.
const PIXELS: u32 = 3;

/// The panels side by side, the second axis upwards.
pub fn svg(circles: &[Circle], panels: &[Panel]) -> String {
    let width = (CELLS + GAP) * panels.len() as u32 - GAP;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {CELLS}\" width=\"{}\" height=\"{}\">\n",
        width * PIXELS,
        CELLS * PIXELS,
    );
    for (panel, left) in panels.iter().zip((0..).step_by((CELLS + GAP) as usize)) {
        // An inner svg cuts off what is outside of it.
        let _ = writeln!(text, "<svg x=\"{left}\" width=\"{CELLS}\" height=\"{CELLS}\">");
        let _ = writeln!(text, "<g transform=\"translate(0 {CELLS}) scale(1 -1)\">");
        let cells: Vec<Block> = panel.cells.iter().map(|&cell| Block::cell(cell)).collect();
        let _ = writeln!(text, "<path fill=\"#1a7f37\" d=\"{}\"/>", path(&cells));
        let _ = writeln!(
            text,
            "<path fill=\"none\" stroke=\"#888\" stroke-width=\"0.2\" d=\"{}\"/>",
            path(&panel.blocks)
        );
        for Circle { radius, center } in circles {
            let [x, y] = center.map(|place| (place - coordinate(0)) / SPACING);
            let _ = writeln!(
                text,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{:.2}\" fill=\"none\" stroke=\"#cf222e\" stroke-width=\"0.5\"/>",
                radius / SPACING,
            );
        }
        text.push_str("</g>\n</svg>\n");
    }
    text.push_str("</svg>\n");
    text
}

/// The outlines of all blocks.
fn path(blocks: &[Block]) -> String {
    let mut text = String::new();
    for Block { low: [x, y], sides: [width, height] } in blocks {
        let _ = write!(text, "M{x} {y}h{width}v{height}h-{width}z");
    }
    text
}
