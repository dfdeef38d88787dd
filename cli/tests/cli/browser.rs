//! The page of a run in a real browser: the script runs, draws, and follows links. The suite skips these tests,
//! because installing a browser takes longer than all tests:
//!
//! ```sh
//! GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored
//! ```

use super::{Folder, assert_holds, number, plate_path};
use serde_json::Value;
use std::fs::{self, File};
use std::io::BufReader;
use std::process::{Command, Output};

/// A screenshot of a browser window with the page.
struct Picture {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn count(&self, is_meant: impl Fn([u8; 3]) -> bool) -> usize {
        self.pixels.iter().filter(|pixel| is_meant(**pixel)).count()
    }

    /// Counts the pixels that differ between two pictures.
    fn difference(&self, other: &Self) -> usize {
        self.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count()
    }
}

fn browser(folder: &Folder, args: &[&str], fragment: &str) -> Output {
    let program = std::env::var("GPU_SMOOTH_BROWSER").expect("GPU_SMOOTH_BROWSER names a browser");
    let page = format!("file://{}{fragment}", folder.path("page.html").display());
    let mut command = Command::new(program);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]);
    // The browser ends after the page and its images are loaded. A virtual clock would not wait for images.
    command.arg("--enable-logging=stderr").args(args);
    let output = command.arg(page).output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && !log.contains("Uncaught"), "{log}");
    output
}

/// Returns the value that a script leaves in the title of the page, after the script of the page.
fn result_of(folder: &Folder, script: &str, fragment: &str) -> Value {
    add_script(folder, &format!("document.title = JSON.stringify((() => {{ {script} }})());"));
    let dom = String::from_utf8(browser(folder, &["--dump-dom"], fragment).stdout).unwrap();
    let title = dom.split("<title>").nth(1).unwrap().split("</title>").next().unwrap();
    serde_json::from_str(title).unwrap_or_else(|error| panic!("{error} in {title}"))
}

fn add_script(folder: &Folder, script: &str) {
    let page =
        folder.text("page.html").replace("</body>", &format!("<script>{script}</script></body>"));
    fs::write(folder.path("page.html"), page).unwrap();
}

fn picture(folder: &Folder, fragment: &str, theme: &str, size: [usize; 2]) -> Picture {
    let size = format!("--window-size={},{}", size[0], size[1]);
    let path = folder.path("window.png");
    let to = format!("--screenshot={}", path.display());
    let theme = format!("--blink-settings=preferredColorScheme={theme}");
    browser(folder, &[&size, &to, &theme], fragment);
    let decoder = png::Decoder::new(BufReader::new(File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let channels = info.color_type.samples();
    let pixels = bytes.chunks(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    Picture { width: info.width as usize, pixels }
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_draws_a_mesh_without_a_run() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.line(&format!("quality {plate} --html page.html")).clean();
    let whole = picture(&folder, "", LIGHT, [1200, 1100]);
    let drawn = |picture: &Picture| picture.count(|pixel| pixel.iter().any(|&x| x < 240));
    assert!(drawn(&whole) > whole.pixels.len() / 5);
    let spot = picture(&folder, "#spot-2", LIGHT, [1200, 1100]);
    assert!(spot.difference(&whole) > whole.pixels.len() / 10);
}

const DARK: &str = "0";
const LIGHT: &str = "1";

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_draws_the_mesh_and_follows_links() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.line(&format!("{plate} out --engine cpu --html page.html")).clean();

    // The document after the script has finished.
    let dom = String::from_utf8(browser(&folder, &["--dump-dom"], "").stdout).unwrap();
    for measure in ["shape", "min-angle", "max-angle", "size-ratio"] {
        assert_holds(&dom, &[&format!(">{measure}</option>")]);
    }
    assert_holds(&dom, &["linear-gradient(to right, rgb(68,1,84)"]);

    // Yellow is the good end of the color scale.
    let is_good = |[r, g, b]: [u8; 3]| r > 200 && g > 200 && b < 80;
    for size in [[1200, 1100], [420, 1400]] {
        let whole = picture(&folder, "", LIGHT, size);
        assert_eq!(whole.width, size[0]);
        assert!(whole.count(is_good) > whole.pixels.len() / 20, "{size:?}");
        assert_eq!(whole.pixels[0], [255, 255, 255]);
        let dark = picture(&folder, "", DARK, size);
        assert!(dark.pixels[0].iter().all(|&x| x < 50), "{:?}", dark.pixels[0]);
        assert!(dark.count(is_good) > dark.pixels.len() / 20, "{size:?}");
        // The page at one of the worst triangles, enlarged.
        let spot = picture(&folder, "#spot-8", LIGHT, size);
        assert!(spot.difference(&whole) > whole.pixels.len() / 10, "{size:?}");
        assert!(spot.count(is_good) > 1000, "{size:?}");
    }
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_prints_the_values_and_the_place_of_the_triangle_under_the_pointer() {
    // Elements of 1 cm in coordinates of UTM, with seven digits before the point.
    let mut mesh = support::perturb_random(&support::lattice(20, 20), 1.0, 3);
    mesh.points.iter_mut().for_each(|[x, y]| {
        (*x, *y) = (499_980.25 + 0.01 * *x, 4_649_776.5 + 0.01 * *y);
    });
    let [node, ele] = support::triangle_text(&mesh, "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    folder.line("quality in --worst 3 --html page.html").clean();
    let told = folder.line("quality in --worst 3 --json").clean().out;
    let told: Value = serde_json::from_str(&told).unwrap();
    let worst = &told["worst"][1];
    // The link moves the middle of the view to the middle of the triangle.
    let script = "const canvas = document.querySelector('canvas'), box = canvas.getBoundingClientRect();
        canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2 }));
        return document.getElementById('hovered').textContent;";
    let text = result_of(&folder, script, "#spot-1");
    let words: Vec<&str> = text.as_str().unwrap().split_whitespace().collect();
    let after = |name: &str| {
        let word = words[1 + words.iter().position(|word| *word == name).unwrap()];
        word.trim_end_matches('°').parse::<f64>().unwrap()
    };
    for name in ["shape", "min-angle"] {
        let (shown, value) = (after(name), number(&worst[name]));
        assert!((shown - value).abs() <= 5.1e-6 * value, "{name} {value} in {text}");
    }
    for axis in 0..2 {
        let corners = worst["corners"].as_array().unwrap();
        let middle = corners.iter().map(|corner| number(&corner[axis]) / 3.0).sum::<f64>();
        let shown: f64 = words[axis].parse().unwrap();
        assert!((shown - middle).abs() < 1e-5, "{middle} in {text}");
    }
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn the_wheel_scrolls_the_page_unless_ctrl_or_the_focus_is_on_a_view() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.line(&format!("quality {plate} --html page.html")).clean();
    let script = "const canvas = document.querySelector('canvas');
        const isTaken = (keys) => {
          const event = new WheelEvent('wheel', { deltaY: -100, cancelable: true, bubbles: true, ...keys });
          canvas.dispatchEvent(event);
          return event.defaultPrevented;
        };
        const isHinted = () => document.querySelector('.hint').classList.contains('shown');
        const results = [isHinted(), isTaken({}), isHinted(), isTaken({ ctrlKey: true }), isTaken({ metaKey: true })];
        canvas.focus();
        results.push(isTaken({}));
        canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }));
        return [...results, isTaken({})];";
    let results = result_of(&folder, script, "");
    assert_eq!(results, serde_json::json!([false, false, true, true, true, true, false]));
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_draws_a_large_mesh_by_each_measure() {
    let mesh = support::perturb_random(&support::lattice(360, 360), 0.5, 3);
    let [node, ele] = support::triangle_text(&mesh, "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let run = folder.line("quality in --html page.html");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let page = folder.text("page.html");
    for measure in 0..4 {
        fs::write(folder.path("page.html"), &page).unwrap();
        let select = format!("select.selectedIndex = {measure}; select.onchange();");
        add_script(&folder, &select);
        let picture = picture(&folder, "", LIGHT, [1000, 1000]);
        let is_face = |[r, g, b]: [u8; 3]| r.abs_diff(g).max(g.abs_diff(b)) > 20;
        let count = picture.count(is_face);
        assert!(count > picture.pixels.len() / 4, "measure {measure}: {count} pixels");
    }
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_draws_quadrilaterals_in_gray() {
    let folder = Folder::new(&[("in.off", super::html::MIXED)]);
    folder.line("quality in.off --html page.html").clean();
    let picture = picture(&folder, "", LIGHT, [1000, 1000]);
    let gray = picture.count(|pixel| pixel == [196, 198, 201]);
    let good = picture.count(|[r, g, b]| r > 200 && g > 200 && b < 80);
    assert!(gray > picture.pixels.len() / 10 && good > 1000, "{gray} gray, {good} yellow pixels");
}
