//! The page of a run in a real browser: the script runs, draws, and follows links. The suite skips these tests,
//! because installing a browser takes longer than all tests:
//!
//! ```sh
//! GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored
//! ```

use super::{Folder, assert_holds, plate_path};
use std::fs::File;
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
    command.args(["--virtual-time-budget=3000", "--enable-logging=stderr"]).args(args);
    let output = command.arg(page).output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && !log.contains("Uncaught"), "{log}");
    output
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
