//! Tests of the example `live`: its parts without a window, and the whole example on a virtual display.
#![allow(clippy::print_stderr)]

#[allow(dead_code)]
#[path = "../examples/live/main.rs"]
mod live;

use gpu_smooth::{Mesh, Metric, wgpu};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use live::app::App;

const SIZE: [u32; 2] = [240, 300];

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn plate() -> Mesh {
    support::read_mesh(&root().join("meshes/plate.node"))
}

/// The application with a test in the role of the user.
struct Hand {
    app: App,
    target: wgpu::TextureView,
}

impl Hand {
    fn new() -> Self {
        let (app, target) = live::headless::start(plate(), SIZE).unwrap();
        Self { app, target }
    }

    fn press(&mut self, [x, y]: [f64; 2]) {
        let at = self.app.view().to_pixels([x, y]);
        self.app.press(at).unwrap();
    }

    fn move_to(&mut self, [x, y]: [f64; 2]) {
        let at = self.app.view().to_pixels([x, y]);
        self.app.move_to(at);
    }

    fn frames(&mut self, count: u32) {
        for _ in 0..count {
            self.app.frame(&self.target).unwrap();
            self.app.smoothing.wait().unwrap();
        }
    }

    /// Executes frames until a condition holds. The number of frames depends on the machine, because frames of a busy
    /// machine have fewer sweeps.
    fn frames_until(&mut self, holds: impl Fn(&Self) -> bool) {
        for _ in 0..400 {
            self.frames(1);
            if holds(self) {
                return;
            }
        }
        panic!("it does not come to hold in 400 frames");
    }

    fn points(&self) -> &[[f64; 2]] {
        &self.app.smoothing.points
    }

    fn nearest(&self, at: [f64; 2]) -> usize {
        let far = |v: &usize| distance(self.points()[*v], at);
        (0..self.points().len()).min_by(|v, w| far(v).total_cmp(&far(w))).unwrap()
    }
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

#[test]
fn a_vertex_follows_the_pointer_and_the_mesh_follows_the_vertex() {
    let mut hand = Hand::new();
    hand.frames(60);
    let (from, to) = ([1.8, 1.3], [2.0, 1.4]);
    let vertex = hand.nearest(from);
    let (from, before) = (hand.points()[vertex], hand.points().to_vec());
    hand.press(from);
    hand.move_to(to);
    hand.frames_until(|hand| distance(hand.points()[vertex], to) < 1e-6);
    hand.frames(20);
    assert!(distance(hand.points()[vertex], to) < 1e-6, "it is at {:?}", hand.points()[vertex]);
    let moved = |hand: &Hand| {
        let both = before.iter().zip(hand.points());
        both.filter(|&(&p, &q)| distance(p, q) > 0.01).count()
    };
    assert!(moved(&hand) > 50, "only {} vertices moved", moved(&hand));
    assert_eq!(hand.app.smoothing.objectives.inverted, 0);

    hand.app.release().unwrap();
    hand.frames_until(|hand| distance(hand.points()[vertex], from) < 0.05);
}

#[test]
fn a_hole_moves_as_a_whole_and_the_outer_boundary_stays() {
    let mut hand = Hand::new();
    hand.frames(30);
    let before = hand.points().to_vec();
    hand.press([2.5, 0.6]);
    hand.move_to([2.6, 0.8]);
    let to = hand.nearest([2.5, 0.6]);
    hand.frames_until(|hand| distance(hand.points()[to], [2.6, 0.8]) < 1e-5);
    let on_hole = |p: [f64; 2]| (distance(p, [2.25, 0.6]) - 0.25).abs() < 1e-5;
    let outside = |[x, y]: [f64; 2]| x == 0.0 || x == 3.0 || y == 0.0 || y == 2.0;
    let grip = hand.nearest([2.6, 0.8]);
    let delta = [0, 1].map(|i| hand.points()[grip][i] - before[grip][i]);
    assert!(distance(delta, [0.1, 0.2]) < 1e-5, "it moved by {delta:?}");
    let mut seen = [0, 0];
    for (&p, &q) in before.iter().zip(hand.points()) {
        if on_hole(p) {
            assert!(distance([p[0] + delta[0], p[1] + delta[1]], q) < 1e-5, "{p:?} went to {q:?}");
            seen[0] += 1;
        }
        if outside(p) {
            assert_eq!(p, q);
            seen[1] += 1;
        }
    }
    assert!(seen[0] >= 24 && seen[1] > 100, "{seen:?}");
}

#[test]
fn nothing_the_hand_does_inverts_a_triangle() {
    let mut hand = Hand::new();
    let grips = [[0.35, 1.1], [1.7, 1.0], [2.5, 0.6], [1.45, 1.1], [0.2, 0.2], [2.9, 1.9]];
    let goals = [[-1.0, 3.0], [1.5, 1.0], [4.0, -1.0], [0.0, 0.0], [2.2, 0.6], [1.5, 2.0]];
    for (turn, key) in "1a2a3a4 5 r".chars().enumerate() {
        hand.app.key(key).unwrap();
        hand.press(grips[turn % grips.len()]);
        for step in 0..3 {
            hand.move_to(goals[(turn + step) % goals.len()]);
            hand.frames(6);
        }
        assert_eq!(hand.app.smoothing.count_infeasible().unwrap(), 0, "after key '{key}'");
        hand.app.release().unwrap();
    }
}

#[test]
fn a_mesh_turned_inside_out_by_a_free_hand_recovers() {
    let mut hand = Hand::new();
    hand.frames(30);
    hand.app.key('f').unwrap();
    // During a pause, inverted triangles remain. Drags a vertex far away, and one hole across another.
    hand.app.key(' ').unwrap();
    for (from, to) in [([1.8, 1.3], [2.6, 1.7]), ([2.5, 0.6], [1.7, 0.9])] {
        hand.press(from);
        hand.move_to(to);
        hand.frames(2);
        hand.app.release().unwrap();
    }
    let inverted = hand.app.smoothing.objectives.inverted;
    assert!(inverted > 20, "only {inverted} triangles are inverted");
    hand.press([1.7, 0.9]);
    hand.move_to([2.5, 0.6]);
    hand.frames(2);
    hand.app.release().unwrap();
    assert!(hand.app.smoothing.objectives.inverted > 0);
    hand.app.key(' ').unwrap();
    hand.frames_until(|hand| hand.app.smoothing.objectives.inverted == 0);
    assert_eq!(hand.app.smoothing.count_infeasible().unwrap(), 0);
    hand.frames_until(|hand| hand.app.smoothing.objectives.worst_imr < 2.0);
}

#[test]
fn keys_choose_the_scheme() {
    let mut hand = Hand::new();
    let mut after = |keys: &str| {
        keys.chars().for_each(|key| hand.app.key(key).unwrap());
        hand.app.smoothing.scheme().to_string()
    };
    for (digit, metric) in "12345".chars().zip(Metric::ALL) {
        assert_eq!(after(&digit.to_string()), metric.name());
    }
    assert_eq!(after("2a"), "area+imr");
    assert_eq!(after("a"), "area");
}

/// Returns the pixels of a picture, four bytes each.
fn pixels(path: &Path, size: [u32; 2]) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([info.width, info.height], size);
    bytes
}

fn check_pictures(directory: &Path, size: [u32; 2]) {
    let pictures = ["start.png", "vertex.png", "hole.png", "tangled.png", "recovered.png"];
    let pictures = pictures.map(|name| pixels(&directory.join(name), size));
    for picture in &pictures {
        let colors: HashSet<_> = picture.chunks_exact(4).collect();
        assert!(colors.len() > 100, "a picture of {} colors", colors.len());
    }
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]));
    // Magenta marks inverted triangles.
    let magenta = |picture: &[u8]| {
        picture.chunks_exact(4).filter(|p| p[0] > 240 && p[1] < 20 && p[2] > 240).count()
    };
    assert!(magenta(&pictures[3]) > 500, "{} pixels", magenta(&pictures[3]));
    assert!([0, 1, 2, 4].iter().all(|&i| magenta(&pictures[i]) == 0));
}

fn tour(directory: &Path, size: [u32; 2]) -> Vec<String> {
    let script = root().join("examples/live/tour.script");
    let size = format!("{}x{}", size[0], size[1]);
    let paths = [&script, directory].map(|path| path.to_str().unwrap());
    ["--script", paths[0], "--out", paths[1], "--size", &size].map(str::to_owned).to_vec()
}

#[test]
fn the_tour_runs_without_a_window() {
    let directory = tempfile::tempdir().unwrap();
    let mut args = tour(directory.path(), [400, 440]);
    args.push("--headless".to_owned());
    live::run(&args).unwrap();
    check_pictures(directory.path(), [400, 440]);
}

/// Requires the binary of the example, which `cargo test` builds beside this one, and `xvfb-run`, which `tests/run`
/// installs. Linux only, because other systems would open a real window.
#[cfg(target_os = "linux")]
#[test]
fn the_tour_runs_in_a_window() {
    let own = std::env::current_exe().unwrap();
    let example: PathBuf = own.parent().unwrap().with_file_name("examples").join("live");
    assert!(example.exists(), "{} is missing: cargo build --example live", example.display());
    let has_display = Command::new("xvfb-run").arg("--help").output().is_ok();
    assert!(has_display, "xvfb-run is missing: install xvfb, or run tests/run, which does");
    let directory = tempfile::tempdir().unwrap();
    let size = [920, 700];
    let output = Command::new("xvfb-run")
        .args(["-a", "-s", "-screen 0 1280x1000x24"])
        .arg(example)
        .args(tour(directory.path(), size))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    check_pictures(directory.path(), size);
}

#[test]
fn mistakes_in_a_script_are_reported_by_line() {
    for wrong in ["wait", "wait -1", "drag 0 0 1 1", "key ab", "jump", "press 0 nan"] {
        let text = format!("wait 1 # fine\n\n{wrong}\n");
        let problem = live::script::Script::parse(&text, PathBuf::new()).err().unwrap();
        assert!(problem.contains("line 3") && problem.contains(wrong), "{problem}");
    }
}
