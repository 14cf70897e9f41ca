//! Pictures: places, depths, normals and colours that were worked out by hand, the same bytes on any number
//! of threads, and what is no picture.

use std::f64::consts::PI;

use jbt::Picture;
use jbt::export::write_png;
use jbt::limits::{MAX_ANTIALIAS, MAX_PICTURE_SIDE};
use jbt::render::{Background, Notice, Quality, RenderError, RenderMode, Rendered, Stance, VIEWS, View};
use jbt::{Box3, CancelToken, CheckedTree, Compiler, Engine, Render, Renderer};
use jbt_testkit::scene::tree;
use jbt_text::{Options, parse};

fn ball() -> CheckedTree {
    tree("jbt 1 point { surface_radius 1 }")
}

/// A red ball on the left of a bluish one, for somebody who looks from +x; each with a number.
fn two() -> CheckedTree {
    tree(
        "jbt 1
        attribute weight 1 default 0 dominant
        union {
            color (1 0 0) { weight 3 { point { at (0 -1.5 0) surface_radius 1 } } }
            color (0 0.5 1) { weight -1 { point { at (0 1.5 0) surface_radius 1 } } }
        }",
    )
}

/// A camera on the x axis that sees `half` of space on each side of the origin.
fn on_axis(distance: f64, half: f64, orthographic: bool) -> View {
    let lens = 2.0 * (half / distance).atan().to_degrees();
    let stance = Stance::At { eye: [distance, 0.0, 0.0], target: [0.0; 3] };
    View { stance, lens, orthographic, ..View::default() }
}

fn make(render: &Render, tree: &CheckedTree) -> Rendered {
    render.picture(&Compiler::new(), tree).run().unwrap()
}

/// A small picture with one ray for each pixel.
fn plain(size: [u32; 2], mode: RenderMode, view: View) -> Render {
    Render { size, mode, view, antialias: 1, ..Render::default() }
}

/// The unit vector that a pixel of the mode `normal` shows.
fn normal(pixel: [u8; 4]) -> [f64; 3] {
    [0, 1, 2].map(|axis| f64::from(pixel[axis]) / 127.5 - 1.0)
}

fn opaque(picture: &Picture) -> Vec<[u32; 2]> {
    let all = (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| [x, y]));
    all.filter(|&[x, y]| picture.pixel(x, y)[3] > 0).collect()
}

#[test]
fn the_silhouette_of_a_ball_is_a_disc() {
    // Without perspective its radius is 1 of 1.5; with perspective a cone touches the ball.
    let (distance, half) = (4.0_f64, 1.5);
    let touching = (1.0 / distance).asin().tan() * distance;
    for (orthographic, radius) in [(true, 1.0), (false, touching)] {
        let made =
            make(&plain([160, 120], RenderMode::Depth, on_axis(distance, half, orthographic)), &ball());
        let expected = PI * (radius / half * 60.0).powi(2);
        let found = made.report.pixels_hit as f64;
        assert!((found / expected - 1.0).abs() < 0.01, "{orthographic}: {found} of {expected}");
        assert_eq!(opaque(&made.picture).len() as u64, made.report.pixels_hit);
        assert_eq!(made.report.rays.total(), made.report.rays.camera, "no secondary rays");
        assert!(made.report.evaluations > 0);
    }
}

#[test]
fn depths_and_normals_are_those_of_the_ball() {
    let view = on_axis(4.0, 1.5, true);
    let depth = make(&plain([61, 61], RenderMode::Depth, view), &ball());
    let [near, far] = depth.report.range.unwrap().map(f64::from);
    // The eye steps back from a model that it has no perspective of; the camera tells where it is.
    let nearest = depth.report.camera.unwrap().eye[0] - 1.0;
    assert!((near - nearest).abs() <= depth.report.tolerance + 1e-6, "{near} {nearest}");
    assert!(far > near + 0.7 && far <= near + 1.0 + depth.report.tolerance);
    assert_eq!(depth.picture.pixel(30, 30), [255; 4]);
    assert_eq!(depth.picture.pixel(0, 0), [0; 4]);

    let shown = make(&plain([61, 61], RenderMode::Normal, view), &ball());
    assert_eq!(shown.report.range, None);
    for [x, y] in opaque(&shown.picture) {
        let across = [x, 60 - y].map(|at| (f64::from(at) - 30.0) / 30.5 * 1.5);
        let out = (1.0 - across[0].powi(2) - across[1].powi(2)).max(0.0).sqrt();
        if out > 0.2 {
            let found = normal(shown.picture.pixel(x, y));
            for (found, expected) in found.into_iter().zip([out, across[0], across[1]]) {
                assert!((found - expected).abs() < 0.02, "{x} {y}: {found} {expected}");
            }
        }
    }
}

#[test]
fn attributes_are_shown_as_they_are() {
    let view = View { orthographic: true, ..View::named("front").unwrap() };
    let color = make(&plain([80, 40], RenderMode::Attribute("color".to_owned()), view), &two());
    // Linear 0.5 is 188 on a screen.
    assert_eq!(color.picture.pixel(20, 20), [255, 0, 0, 255]);
    assert_eq!(color.picture.pixel(60, 20), [0, 188, 255, 255]);
    let weight = make(&plain([80, 40], RenderMode::Attribute("weight".to_owned()), view), &two());
    assert_eq!(weight.report.range, Some([-1.0, 3.0]));
    // The ends of viridis: yellow is much, dark blue is little.
    let (much, little) = (weight.picture.pixel(20, 20), weight.picture.pixel(60, 20));
    assert!(much[0] > 240 && much[2] < 50, "{much:?}");
    assert!(little[0] < 80 && little[1] < 10, "{little:?}");
    let unknown = plain([8, 8], RenderMode::Attribute("colour".to_owned()), view);
    let error = unknown.picture(&Compiler::new(), &two()).run().unwrap_err();
    assert_eq!(error.to_string(), "the model has no attribute `colour`; it has color, weight");
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let tree = two();
    let renderer = Renderer::new(&Compiler::new(), &tree).unwrap();
    for (mode, quality) in [
        (RenderMode::Shaded, Quality::Good),
        (RenderMode::Shaded, Quality::Best),
        (RenderMode::Normal, Quality::Draft),
        (RenderMode::Evaluations, Quality::Good),
    ] {
        let render = Render { size: [90, 50], mode, quality, ..Render::default() };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render.with(&renderer).run()).unwrap()
        };
        let one = on(1);
        for threads in [2, 5] {
            let other = on(threads);
            assert!(one.picture == other.picture, "{:?} on {threads} threads", render.mode);
            assert_eq!(one.report.evaluations, other.report.evaluations);
            assert_eq!(one.report.rays, other.report.rays);
        }
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_engine() {
    let tree = tree(
        "jbt 1 twist axis z rate 1 { blend ricci 3 {
        color (1 0 0) { segment { from (-0.5 0 0) to (0.5 0 0) surface_radius 0.2 } }
        color (0 0 1) { point { at (0.4 0.3 0.2) surface_radius 0.3 } }
    } }",
    );
    for quality in [Quality::Draft, Quality::Good] {
        let render = Render { size: [48, 36], quality, ..Render::default() };
        let made = Engine::ALL
            .map(|engine| render.picture(&Compiler::for_engine(engine), &tree).run().unwrap().picture);
        assert!(made.iter().all(|picture| *picture == made[0]), "{quality:?}");
    }
}

/// Light that meets a mesh is that of exact rays, but for noise.
#[test]
fn light_by_a_mesh_is_that_of_the_surface() {
    let with = |quality: Quality| {
        make(&Render { size: [120, 80], quality, antialias: 2, ..Render::default() }, &two())
    };
    let (good, best) = (with(Quality::Good), with(Quality::Best));
    assert!(good.report.triangles > 1000 && best.report.triangles == 0);
    assert!(good.report.evaluations * 4 < best.report.evaluations);
    let differences = good.picture.pixels().iter().zip(best.picture.pixels()).flat_map(|(a, b)| {
        (0..3).map(|channel| u64::from(a[channel].abs_diff(b[channel]))).collect::<Vec<_>>()
    });
    let (sum, count) = differences.fold((0, 0), |(sum, count), off| (sum + off, count + 1));
    assert!(sum < 3 * count, "{sum} of {count}");
}

/// A rod that is thinner than a cell of the mesh is seen as by exact rays.
#[test]
fn what_the_mesh_misses_is_seen() {
    let rod = tree(
        "jbt 1 union {
            point { surface_radius 0.4 }
            segment { from (0 -1 0.6) to (0 1 0.6) surface_radius 0.012 }
        }",
    );
    let hits = |quality: Quality| {
        let view = View { orthographic: true, ..View::named("front").unwrap() };
        let size = [240, 180];
        let render = Render { size, quality, view, antialias: 1, ground: false, ..Render::default() };
        make(&render, &rod).report.pixels_hit as f64
    };
    let (good, best, draft) = (hits(Quality::Good), hits(Quality::Best), hits(Quality::Draft));
    assert!((good / best - 1.0).abs() < 0.03, "{good} {best}");
    assert!(draft < best - 100.0, "the rod is thick enough for the mesh of a draft: {draft} {best}");
}

#[test]
fn materials_are_seen() {
    let ball = |words: &str| {
        let text = format!(
            "jbt 1
            attribute rough 1 default 0.43
            attribute metal 1 default 0
            attribute glow 1 default 0
            {words} {{ color (0.5 0.2 0.1) {{ point {{ surface_radius 1 }} }} }}"
        );
        let background = Some(Background::Color([0; 3]));
        let render = Render { size: [64, 64], ground: false, background, ..Render::default() };
        let made = make(&render, &tree(&text));
        let bytes: Vec<u8> = made.picture.pixels().iter().map(|pixel| pixel[0]).collect();
        let mean = bytes.iter().map(|&byte| f64::from(byte)).sum::<f64>() / bytes.len() as f64;
        (bytes.into_iter().max().unwrap(), mean)
    };
    let (usual, glowing) = (ball("rough 0.43"), ball("glow 1"));
    assert!(glowing.1 > usual.1 + 5.0, "{usual:?} {glowing:?}");
    let (smooth, chalk) = (ball("rough 0.1"), ball("rough 1"));
    assert!(smooth.0 > chalk.0 + 5, "{smooth:?} {chalk:?}");
    assert_ne!(ball("metal 1"), usual);
    assert_eq!(ball("metal 0"), usual);
}

#[test]
fn a_model_fills_the_picture_from_every_side() {
    let renderer = Renderer::new(&Compiler::new(), &two()).unwrap();
    for (name, _) in VIEWS {
        for size in [[96, 64], [48, 96]] {
            for orthographic in [false, true] {
                let view = View { orthographic, ..View::named(name).unwrap() };
                let made = plain(size, RenderMode::Depth, view).with(&renderer).run().unwrap();
                let hit = opaque(&made.picture);
                let part = |axis: usize| {
                    let low = hit.iter().map(|pixel| pixel[axis]).min().unwrap();
                    let high = hit.iter().map(|pixel| pixel[axis]).max().unwrap();
                    let off = f64::from(low + high + 1) / f64::from(size[axis]) - 1.0;
                    assert!(off.abs() < 0.08, "{name} {size:?}: off the middle by {off}");
                    f64::from(high - low + 1) / f64::from(size[axis])
                };
                let filled = part(0).max(part(1));
                assert!((0.8..0.93).contains(&filled), "{name} {size:?} {orthographic}: {filled}");
            }
        }
    }
}

#[test]
fn a_shadow_falls_on_the_ground() {
    let with = |ground: bool, quality: Quality| {
        let background = Some(Background::Transparent);
        let render =
            Render { size: [64, 48], ground, quality, background, antialias: 1, ..Render::default() };
        make(&render, &ball())
    };
    let (bare, grounded, draft) =
        (with(false, Quality::Good), with(true, Quality::Good), with(true, Quality::Draft));
    assert_eq!(opaque(&bare.picture).len() as u64, bare.report.pixels_hit);
    assert!(opaque(&grounded.picture).len() as u64 > grounded.report.pixels_hit + 100);
    assert_eq!(opaque(&draft.picture).len() as u64, draft.report.pixels_hit);
    assert_eq!((draft.report.rays.shadow, draft.report.rays.sky), (0, 0));
    assert!(grounded.report.rays.shadow > 0 && grounded.report.rays.sky > 0);
    // The light comes over the left shoulder: the ball's upper left is brighter than its lower right.
    let bright = |x: u32, y: u32| bare.picture.pixel(x, y)[..3].iter().map(|&c| u32::from(c)).sum::<u32>();
    assert!(bright(26, 17) > bright(40, 34) + 100);
}

#[test]
fn a_region_cuts_the_model_open() {
    let region = Some(Box3::new([-2.0; 3], [0.25, 2.0, 2.0]));
    let view = View { orthographic: true, ..View::named("front").unwrap() };
    let cut = Render { region, ..plain([61, 61], RenderMode::Normal, view) };
    let made = make(&cut, &ball());
    // The cut is a disc that looks along x, in the middle; around it there is the ball.
    assert_eq!(made.picture.pixel(30, 30), [255, 128, 128, 255]);
    assert_eq!(made.picture.pixel(40, 40), [255, 128, 128, 255]);
    let color = Render { mode: RenderMode::Attribute("color".to_owned()), ..cut.clone() };
    assert_eq!(make(&color, &ball()).picture.pixel(30, 30), [255; 4]);
    // A half space fills all of its region; without one it has no picture.
    let half_space = tree("jbt 1 half_space { normal (0 0 1) radius 1 }");
    let shaded = Render {
        mode: RenderMode::Shaded,
        ground: false,
        region,
        ..plain([16, 16], RenderMode::Shaded, view)
    };
    assert!(make(&shaded, &half_space).report.pixels_hit > 60);
    let error = plain([16, 16], RenderMode::Shaded, view).picture(&Compiler::new(), &half_space).run();
    assert!(matches!(error, Err(RenderError::Unbounded)));
}

#[test]
fn pictures_of_nothing() {
    let background = Some(Background::Color([10, 20, 30]));
    let away =
        View { stance: Stance::At { eye: [5.0, 0.0, 0.0], target: [6.0, 0.0, 0.0] }, ..View::default() };
    let render = Render { background, ..plain([9, 7], RenderMode::Shaded, away) };
    let empty = tree("jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }");
    let faint = tree("jbt 1 point { radius 1 strength 0.25 }");
    for (tree, notice) in [(ball(), Notice::OutOfView), (empty, Notice::Empty), (faint, Notice::Empty)] {
        let made = make(&Render { ground: false, ..render.clone() }, &tree);
        assert_eq!((made.report.notice, made.report.pixels_hit), (Some(notice), 0));
        assert!(made.picture.pixels().iter().all(|pixel| *pixel == [10, 20, 30, 255]));
        for mode in [RenderMode::Depth, RenderMode::Normal, RenderMode::Evaluations] {
            assert_eq!(make(&Render { mode, ..render.clone() }, &tree).report.notice, Some(notice));
        }
    }
}

/// A field that is cut off at the iso-value has no gradient where it reaches it.
#[test]
fn no_gradient_is_no_defect() {
    let flat = tree("jbt 1 clamp low 0 high 0.5 { color (1 1 1) { point { radius 2 } } }");
    let view = on_axis(4.0, 1.5, true);
    let made = make(&plain([21, 21], RenderMode::Shaded, view), &flat);
    assert!(made.report.pixels_hit > 100);
    for [x, y] in opaque(&made.picture) {
        assert!(made.picture.pixel(x, y)[..3].iter().all(|&channel| channel > 20), "{x} {y}");
    }
    let shown = make(&plain([21, 21], RenderMode::Normal, view), &flat);
    let found = normal(shown.picture.pixel(10, 10));
    assert!(found[0] > 0.98, "{found:?}");
}

#[test]
fn an_edited_model_is_that_of_a_new_renderer() {
    let model = parse(b"jbt 1 param r = 0.5 point { surface_radius r }", &Options::default()).unwrap();
    let small = model.check().unwrap();
    let large = small.with_parameters(&[("r", 0.8)]).unwrap();
    let render = plain([40, 30], RenderMode::Shaded, on_axis(4.0, 1.5, false));
    let renderer = Renderer::new(&Compiler::new(), &small).unwrap();
    let edited = render.with(&renderer.updated(&large).unwrap()).run().unwrap();
    assert!(edited.picture == make(&render, &large).picture);
    assert!(edited.report.pixels_hit > make(&render, &small).report.pixels_hit);
    assert_eq!(edited.report.compile_time, std::time::Duration::ZERO);
}

#[test]
fn a_png_is_the_picture() {
    let made = make(&Render { size: [33, 21], antialias: 1, ..Render::default() }, &ball());
    let mut file = Vec::new();
    write_png(&made.picture, &mut file).unwrap();
    let mut again = Vec::new();
    write_png(&made.picture, &mut again).unwrap();
    assert_eq!(file, again);
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
    assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::Perceptual));
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height, info.color_type), (33, 21, png::ColorType::Rgb));
    let opaque: Vec<u8> = made.picture.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    assert_eq!(bytes, opaque);
}

#[test]
fn what_is_no_picture_says_why() {
    let good = plain([8, 8], RenderMode::Shaded, View::default());
    let at = |eye: [f64; 3]| View { stance: Stance::At { eye, target: [9.0; 3] }, ..View::default() };
    let flat = Box3::new([0.0; 3], [1.0, 0.0, 1.0]);
    let side = MAX_PICTURE_SIDE as u32;
    for (render, words) in [
        (
            Render { size: [0, 8], ..good.clone() },
            "at least one pixel along each side, and this one is 0 x 8",
        ),
        (Render { size: [side + 1, 1], ..good.clone() }, "and this one is 16385 x 1"),
        (Render { size: [8193, 8192], ..good.clone() }, "and this one is 8193 x 8192"),
        (Render { antialias: 0, ..good.clone() }, "and not 0 x 0"),
        (Render { antialias: MAX_ANTIALIAS + 1, ..good.clone() }, "and not 17 x 17"),
        (
            Render { view: at([0.5, 0.25, 0.0]), ..good.clone() },
            "inside the solid, at (0.5, 0.25, 0): move it out",
        ),
        (Render { view: at([f64::NAN; 3]), ..good.clone() }, "eye must be a finite number, and it is NaN"),
        (Render { view: at([9.0; 3]), ..good.clone() }, "eye and target are both at (9, 9, 9)"),
        (
            Render { view: View { zoom: 1e-310, ..View::default() }, ..good.clone() },
            "the camera is too far away",
        ),
        (Render { region: Some(flat), ..good.clone() }, "a region has finite corners"),
    ] {
        let error = render.picture(&Compiler::new(), &ball()).run().expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    // At the limits it is something else that is wrong.
    let unbounded = tree("jbt 1 half_space { radius 1 }");
    for size in [[side, 4096], [8192, 8192]] {
        let render = Render { size, antialias: MAX_ANTIALIAS, ..good.clone() };
        let error = render.picture(&Compiler::new(), &unbounded).run();
        assert!(matches!(error, Err(RenderError::Unbounded)));
    }
    let line = Render { size: [side, 1], quality: Quality::Draft, ..good.clone() };
    assert_eq!(make(&line, &ball()).picture.width(), side);
}

#[test]
fn a_picture_is_watched_and_cancelled() {
    let render = Render { size: [300, 300], quality: Quality::Draft, antialias: 1, ..Render::default() };
    let renderer = Renderer::new(&Compiler::new(), &ball()).unwrap();
    for patience in [0, 1, 2] {
        let mut calls = 0;
        let token = CancelToken::new();
        let watch = |_| {
            calls += 1;
            if calls > patience {
                token.cancel();
            }
        };
        let made = render.with(&renderer).on_progress(watch).cancel(&token).run();
        assert!(matches!(made, Err(RenderError::Cancelled)));
    }
    let mut last = -1.0;
    let watch = |part| {
        assert!((0.0..=1.0).contains(&part) && part >= last);
        last = part;
    };
    let made = render.with(&renderer).on_progress(watch).run();
    assert!(made.is_ok() && last == 1.0);
}
