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

    // Yellow is the good end of the color scale, and yellowish green is near.
    let is_good = |[r, g, b]: [u8; 3]| r > 150 && g > 200 && b < 80;
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
    let script = format!("{POINT} point(0.5, 0.5); return [textOf('#tip'), ids[marked]];");
    let result = result_of(&folder, &script, "#spot-1");
    assert_eq!(result[1], worst["triangle"]);
    let text = result[0].as_str().unwrap();
    let words: Vec<&str> = text.split_whitespace().collect();
    assert_eq!(words[..2], ["triangle", &worst["triangle"].to_string()], "{text}");
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
        let shown: f64 = words[words.len() - 2 + axis].parse().unwrap();
        assert!((shown - middle).abs() < 1e-5, "{middle} in {text}");
    }
}

/// Functions of scripts: `point` moves the pointer to a place of the first view, as shares of its width and height, and
/// `textOf` returns the text of an element, with a blank between its parts, or null if the element is hidden.
const POINT: &str = "
    const textOf = (selector) => {
      const element = document.querySelector(selector);
      if (!element || element.hidden) return null;
      const texts = document.createTreeWalker(element, NodeFilter.SHOW_TEXT), words = [];
      while (texts.nextNode()) words.push(texts.currentNode.data);
      return words.join(' ');
    };
    const move = (element, type, x, y) => {
      const { left, top, width, height } = element.getBoundingClientRect();
      element.dispatchEvent(new PointerEvent(type, { bubbles: true, clientX: left + x * width, clientY: top + y * height }));
    };
    const point = (x, y) => move(document.querySelector('canvas'), 'pointermove', x, y);";

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn the_values_are_those_of_the_pointer_or_of_the_chosen_triangle() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.line(&format!("{plate} out --engine cpu --html page.html")).clean();
    let script = format!(
        "{POINT}
        const results = [textOf('#tip')];
        point(0.12, 0.15);
        results.push(textOf('#tip'));
        const link = document.querySelectorAll('a[href^=\"#spot-\"]')[9];
        link.click();
        link.click();
        redrawNow();
        results.push(link.textContent, textOf('#tip'), tip.parentElement.querySelector('canvas').ariaLabel);
        point(0.8, 0.6);
        results.push(textOf('#tip'));
        move(document.querySelector('canvas'), 'pointerleave', 0, 0);
        results.push(textOf('#tip'));
        document.getElementById('all').click();
        redrawNow();
        return [...results, textOf('#tip')];"
    );
    let results = result_of(&folder, &script, "");
    let text = |i: usize| results[i].as_str().unwrap_or_else(|| panic!("{results}"));
    // Nothing is shown at first, nor of the whole mesh after the pointer has left.
    assert!(results[0].is_null() && results[7].is_null(), "{results}");
    let chosen = format!("triangle {} ", text(2));
    assert!(text(3).starts_with(&chosen) && text(6) == text(3), "{results}");
    assert_eq!(text(4), "the mesh after the run");
    for other in [text(1), text(5)] {
        assert!(other.starts_with("triangle ") && !other.starts_with(&chosen), "{results}");
        assert_holds(other, &["before after shape ", " min-angle "]);
    }
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn charts_show_their_values_at_the_pointer() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    folder.line(&format!("{plate} out --engine cpu --report r.json --html page.html")).clean();
    let script = format!(
        "{POINT}
        const show = (figure, i) => {{
          const hit = [...figure.querySelectorAll('.hit')].at(i);
          move(hit, 'pointermove', 0.5, 0.5);
          return [textOf('#tip'), hit.closest('figure').contains(tip)];
        }};
        const figures = [...document.querySelectorAll('.charts figure')];
        return [show(figures[0], -1), show(figures[3], -1), document.querySelectorAll('svg title').length];"
    );
    let results = result_of(&folder, &script, "");
    let history = &folder.json("r.json")["history"];
    let last = history.as_array().unwrap().last().unwrap();
    let bar = results[0][0].as_str().unwrap();
    assert!(bar.starts_with("0.9 to 1\nbefore: ") && bar.contains(" %)\nafter: "), "{bar}");
    let f = number(&last["f"]);
    assert_eq!(results[1][0], format!("sweep {}: {f:.6}", last["sweep"]));
    assert_eq!(
        [&results[0][1], &results[1][1], &results[2]],
        [&Value::from(true), &true.into(), &0.into()]
    );
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn the_overview_of_several_meshes_sorts_by_each_column() {
    let folder = Folder::new(&[]);
    for (name, amount, side) in [("b2", 0.1, 6), ("b10", 0.9, 8), ("a", 0.5, 7)] {
        let mesh = support::perturb_random(&support::lattice(side, side), amount, 3);
        let [node, ele] = support::triangle_text(&mesh, "");
        fs::write(folder.path(&format!("{name}.node")), node).unwrap();
        fs::write(folder.path(&format!("{name}.ele")), ele).unwrap();
    }
    let line = "quality b2.node b10.node a.node -m min-angle,max-angle --html page.html";
    folder.line(line).clean();
    let script = "const names = () => [...document.querySelectorAll('.overview tbody tr')].map((row) => row.cells[0].textContent);
        const buttons = [...document.querySelectorAll('.overview th button')];
        const after = (name) => {
          buttons.find((button) => button.textContent.startsWith(name)).click();
          return names();
        };
        return [names(), after('mesh'), after('mesh'), after('triangles'), after('max-angle'), after('max-angle'),
          document.querySelectorAll('[aria-sort]').length];";
    let results = result_of(&folder, script, "");
    let order = |names: [&str; 3]| serde_json::json!(names.map(|name| format!("{name}.node")));
    let (worst, best) = (order(["b10", "a", "b2"]), order(["b2", "a", "b10"]));
    for (i, expected) in [
        // The page has the mesh with the least angle first.
        &worst,
        &order(["a", "b2", "b10"]),
        &order(["b10", "b2", "a"]),
        &worst,
        &worst,
        &best,
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(results[i], *expected, "{i}: {results}");
    }
    assert_eq!(results[6], 1);
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
fn a_browser_colors_edges_between_pale_triangles() {
    let folder = Folder::new(&[]);
    let plate = plate_path().to_str().unwrap();
    let counts = |measure: &str| {
        folder
            .line(&format!("quality {plate} --picture-measure {measure} --html page.html"))
            .clean();
        let drawn = picture(&folder, "", LIGHT, [1200, 1100]);
        // Pale, and the ends of the scale.
        [[236, 238, 241], [68, 1, 84], [253, 231, 37]].map(|color| drawn.count(|p| p == color))
    };
    let [pale, bad, good] = counts("orthogonality");
    assert!(pale > 20_000 && bad > 2000 && good > 2000, "{pale} {bad} {good}");
    // Blended pixels may have the pale color by chance.
    assert!(counts("shape")[0] < 100);
}

#[test]
#[ignore = "needs a browser: GPU_SMOOTH_BROWSER=chromium cargo test --test cli browser -- --ignored"]
fn a_browser_draws_quadrilaterals_in_gray() {
    let folder = Folder::new(&[("in.off", super::html::MIXED)]);
    folder.line("quality in.off --quadrilaterals keep --html page.html").clean();
    let picture = picture(&folder, "", LIGHT, [1000, 1000]);
    let gray = picture.count(|pixel| pixel == [196, 198, 201]);
    let good = picture.count(|[r, g, b]| r > 200 && g > 200 && b < 80);
    assert!(gray > picture.pixels.len() / 10 && good > 1000, "{gray} gray, {good} yellow pixels");
}
