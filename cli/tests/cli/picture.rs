//! Pictures (`--picture`): correct content, orientation and size.

use super::html::MIXED;
use super::output::INVERTED;
use super::{Folder, assert_holds, finish, small};
use gpu_smooth::{Topology, measure::Measured};
use std::fs;

/// An image, decoded to its pixels.
struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
}

impl Image {
    fn read(folder: &Folder, name: &str) -> Self {
        let file = std::io::Cursor::new(fs::read(folder.path(name)).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
        let pixels = bytes.as_chunks().0.to_vec();
        Self { width: info.width as usize, height: info.height as usize, pixels }
    }

    /// Returns the columns and rows of the pixels whose color fits.
    fn places(&self, is: impl Fn([u8; 4]) -> bool) -> Vec<[usize; 2]> {
        let place = |i: usize| [i % self.width, i / self.width];
        (0..self.pixels.len()).filter(|&i| is(self.pixels[i])).map(place).collect()
    }
}

/// Returns the smallest and the largest column, and likewise for rows.
fn bounds(places: &[[usize; 2]]) -> [[usize; 2]; 2] {
    [0, 1].map(|axis| {
        let all = places.iter().map(|place| place[axis]);
        [all.clone().min().unwrap(), all.max().unwrap()]
    })
}

fn is_red(pixel: [u8; 4]) -> bool {
    pixel == [230, 25, 75, 255]
}

/// Returns whether a pixel has a color of the scale, unlike the black and white of lines and letters.
fn is_face(pixel: [u8; 4]) -> bool {
    let [r, g, b, _] = pixel;
    r.abs_diff(g).max(g.abs_diff(b)) > 20
}

#[test]
fn a_picture_is_upright_with_equal_axes_and_shows_inverted_triangles() {
    // A square of side 1. Its center vertex is above it, so that the upper triangle is inverted, or to the right of it.
    let [node, ele] = INVERTED;
    let above = node.replace("1.5 0.5", "0.5 1.5");
    for (node, x, y) in [(node, [1.0_f64, 1.5], [0.0_f64, 1.0]), (&above, [0.0, 1.0], [1.0, 1.5])] {
        let folder = Folder::new(&[("in.node", node), ("in.ele", ele)]);
        folder.line("quality in --picture p.png --picture-size 700").clean();
        let image = Image::read(&folder, "p.png");
        assert_eq!(image.width, 700);
        // All colored pixels above the legend.
        let mesh = |[_, row]: &[usize; 2]| *row < image.height - 70;
        let mut red = image.places(is_red);
        red.retain(mesh);
        let mut all = image.places(is_face);
        all.retain(mesh);
        let [[left, right], [top, bottom]] = bounds(&all);
        let [width, height] = [right - left, bottom - top].map(|x| x as f64);
        let [wide, high] = [x[1].max(1.0), y[1].max(1.0)];
        assert!((width / height - wide / high).abs() < 0.03, "{width} x {height}");
        let [[red_left, red_right], [red_top, red_bottom]] = bounds(&red);
        let scale = width / wide;
        let near = |pixel: usize, place: f64| (pixel as f64 - place).abs() < 6.0;
        assert!(
            near(red_left, left as f64 + scale * x[0])
                && near(red_right, left as f64 + scale * x[1])
        );
        assert!(
            near(red_top, bottom as f64 - scale * y[1])
                && near(red_bottom, bottom as f64 - scale * y[0])
        );
    }
}

#[test]
fn a_run_is_drawn_before_and_after_on_one_scale() {
    let folder = small();
    folder.line("in out --engine cpu -q --picture p.png --picture-size 900").clean();
    let image = Image::read(&folder, "p.png");
    let before = |x: usize| x < 450;
    // Good triangles are light. Rows of the legend are excluded.
    let mesh = |[_, row]: &[usize; 2]| *row < image.height - 90;
    let mean = |is_side: &dyn Fn(usize) -> bool| {
        let mut places = image.places(is_face);
        places.retain(|place| mesh(place) && is_side(place[0]));
        let light = |[x, y]: &[usize; 2]| u64::from(image.pixels[y * image.width + x][1]);
        places.iter().map(light).sum::<u64>() as f64 / places.len() as f64
    };
    let [dark, light] = [mean(&before), mean(&|x| !before(x))];
    assert!(light > dark + 20.0, "{dark} before, {light} after");
    assert_eq!(image.places(is_red), [[0; 2]; 0]);
    // No other file is written.
    assert_eq!(folder.content().len(), 5);
}

/// Two squares, the left one of triangles with a long diagonal and the right one with its corner moved, so that the edge
/// between the squares is orthogonal and one diagonal is not.
const SQUARES: [(&str, &str); 2] = [
    ("in.node", "6 2 0 0\n1 0 0\n2 2 0\n3 2 2\n4 0 2\n5 4 0\n6 5 1\n"),
    ("in.ele", "4 3 0\n1 1 2 3\n2 1 3 4\n3 2 5 3\n4 5 6 3\n"),
];

#[test]
fn measures_of_edges_color_edges_and_leave_triangles_pale() {
    let folder = Folder::new(&SQUARES);
    folder.line("quality in --picture p.svg --picture-measure orthogonality").clean();
    let edges = folder.text("p.svg");
    folder.line("quality in --picture p.svg --picture-range 0,1").clean();
    let faces = folder.text("p.svg");
    let lines = |text: &str, color: &str| {
        let of_color = |line: &&str| {
            line.contains(&format!("stroke=\"#{color}\"")) && line.contains("stroke-opacity")
        };
        text.lines().filter(of_color).map(|line| line.matches('M').count()).sum::<usize>()
    };
    // Three edges are between triangles. Both centers are on the diagonal of the left square, so the diagonal has no link.
    let topology = folder.mesh("in");
    let topology = Topology::new(&topology).unwrap();
    let mesh = folder.mesh("in");
    let measured = Measured::new(&mesh.points, &topology).unwrap();
    let values: Vec<f64> = measured.edges().iter().map(|edge| edge.orthogonality).collect();
    assert_eq!(values.len(), 3);
    let [best, worst] = ["fde725", "440154"].map(|color| lines(&edges, color));
    assert_eq!(best, values.iter().filter(|&&value| value < 0.003).count(), "{values:?}");
    assert_eq!(worst, values.iter().filter(|&&value| value > 0.5).count(), "{values:?}");
    assert!(best > 0, "{values:?}");
    assert!(edges.contains("fill=\"#eceef1\"") && !faces.contains("#eceef1"));
    assert_holds(
        &edges,
        &[">worst edges<", "3 edges; orthogonality ", ">orthogonality, 0 is best<"],
    );
    assert_holds(&faces, &[">worst triangles<", "4 triangles; shape "]);
    assert_eq!(lines(&faces, "fde725"), 0);
}

#[test]
fn arrows_are_drawn_on_request_and_for_a_run_only() {
    let folder = small();
    let lines = |options: &str| {
        folder.line(&format!("in out --engine cpu -q --picture p.svg {options}")).clean();
        folder.text("p.svg").len()
    };
    assert!(lines("--picture-arrows") > lines("") + 1000);
    assert!(folder.line("in out --engine cpu -q --picture p.svg --picture-arrows").code == Some(0));
    assert!(folder.text("p.svg").contains("displacement"));
    let line = "quality in --picture p.svg --picture-arrows";
    assert_holds(&folder.line(line).err, &["--picture-arrows needs a run"]);
}

#[test]
fn an_svg_has_every_triangle() {
    let folder = small();
    for ending in ["node", "ele"] {
        let name = |stem: &str| folder.path(&format!("{stem}.{ending}"));
        fs::rename(name("in"), name("a&b")).unwrap();
    }
    let args = [
        "quality",
        "a&b",
        "--picture",
        "p.SVG",
        "--picture-measure",
        "min_angle",
        "--picture-size",
        "800",
    ];
    folder.run(args).clean();
    let text = folder.text("p.SVG");
    let mut reader = quick_xml::Reader::from_str(&text);
    let (mut triangles, mut words) = (0, String::new());
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Eof => break,
            quick_xml::events::Event::Empty(tag) if tag.name().as_ref() == b"path" => {
                let path = tag.try_get_attribute("d").unwrap().unwrap();
                triangles += path.value.iter().filter(|&&c| c == b'Z').count();
            }
            quick_xml::events::Event::Text(text) => words += &text.decode().unwrap(),
            quick_xml::events::Event::GeneralRef(name) => {
                words += &format!("&{};", name.decode().unwrap())
            }
            _ => {}
        }
    }
    // Each triangle of the mesh is drawn, and some are drawn again in insets.
    assert!(triangles >= 160, "{triangles}");
    assert_holds(
        &words,
        &["a&amp;b", "160 triangles; min-angle ", "min-angle, 60° is best", "boundary"],
    );
    assert_holds(&text, &["width=\"800\""]);
}

#[test]
fn colors_change_within_a_range_that_pictures_and_pages_state() {
    let folder = small();
    let drawn = |options: &str| {
        let line = "in out --engine cpu -q --force --picture p.svg --html p.html";
        folder.line(&format!("{line} {options}")).clean();
        [folder.text("p.svg"), folder.text("p.html")]
    };
    let [svg, page] = drawn("");
    assert_holds(&svg, &[">≤ 0.5</text>", ">1</text>", ">in, before</text>", ">in, after</text>"]);
    assert_holds(&page, &[r#""ends":[0.5,1.0]"#, r#""ends":[30.0,60.0]"#, "≤ 0.5"]);
    let [svg, page] = drawn("--picture-range 0.6,0.9");
    assert_holds(&svg, &[">≤ 0.6</text>", ">≥ 0.9</text>"]);
    // The range is that of one measure. The page has default ranges of its other measures.
    assert_holds(&page, &[r#""ends":[0.6,0.9]"#, r#""ends":[30.0,60.0]"#, "≥ 0.9"]);
    let [svg, page] = drawn("--picture-measure max-angle --picture-range 70,180");
    assert_holds(&svg, &[">≤ 70°</text>", ">180°</text>"]);
    assert_holds(&page, &[r#""ends":[0.5,1.0]"#, r#""ends":[180.0,70.0]"#]);
    // A page alone takes a range, as does a page of several meshes, whose pictures have captions.
    folder.line("quality in --html p.html --picture-range 0.9,1").clean();
    assert_holds(&folder.text("p.html"), &[r#""ends":[0.9,1.0]"#]);
    folder.line("quality in out --html p.html --picture-range 0.9,1").clean();
    let caption = "Triangles by shape: dark blue is ≤ 0.9, yellow is 1, red is inverted or flat";
    assert_holds(&folder.text("p.html"), &[caption]);
}

#[test]
fn triangles_beyond_the_range_have_the_colors_of_its_ends() {
    let folder = small();
    let colors = |range: &str| {
        folder.line(&format!("quality in --picture p.png --picture-range {range}")).clean();
        let image = Image::read(&folder, "p.png");
        let mut places = image.places(is_face);
        places.retain(|[_, row]| *row < image.height - 150);
        let [low, high] = [[68, 1, 84, 255], [253, 231, 37, 255]];
        let share = |color| {
            let has_color =
                |place: &&[usize; 2]| image.pixels[place[1] * image.width + place[0]] == color;
            places.iter().filter(has_color).count() as f64 / places.len() as f64
        };
        [share(low), share(high)]
    };
    // Shapes of the mesh are between these values.
    let [low, high] = colors("0,0.01");
    assert!(low == 0.0 && high > 0.5, "{low} {high}");
    let [low, high] = colors("0.99999,1");
    assert!(low > 0.5 && high < 0.01, "{low} {high}");
}

/// Returns the numbers that follow `key="` in an SVG, in their order.
fn numbers(svg: &str, key: &str) -> Vec<f64> {
    let key = format!(" {key}=\"");
    svg.split(&key).skip(1).map(|rest| rest.split('"').next().unwrap().parse().unwrap()).collect()
}

#[test]
fn a_part_of_the_mesh_is_drawn_larger_with_its_worst_triangles_inside() {
    let folder = small();
    folder.line("in out --engine cpu --picture p.svg --force -q").clean();
    let whole = folder.text("p.svg");
    assert_holds(&whole, &[">in, before</text>", ">in, after</text>"]);
    folder.line("in out --engine cpu --picture p.svg --picture-box 5,4,3,2 --force -q").clean();
    let part = folder.text("p.svg");
    // Rings mark triangles in the two panels, which are squares of equal size, and in the legend.
    let (x, y) = (numbers(&part, "cx"), numbers(&part, "cy"));
    let frame = part.split("<svg ").nth(2).unwrap().split(">").next().unwrap();
    let [top, height] = ["y", "height"].map(|key| numbers(frame, key)[0]);
    assert!((numbers(frame, "width")[0] / height - 1.0).abs() < 1e-3, "{frame}");
    let legend = y.iter().copied().fold(0.0, f64::max);
    let inside: Vec<f64> = y.iter().copied().filter(|&y| y < legend - 1.0).collect();
    assert!(!inside.is_empty() && x.len() > inside.len());
    assert!(inside.iter().all(|&y| (top..=top + height).contains(&y)), "{frame} {y:?}");
    // A number is drawn after all rings of its panel, so that no ring hides the number.
    let panel = whole.split(">in, before</text>").next().unwrap();
    let first_number = panel.find(">1</text>").unwrap();
    let [ring, number] = ["<circle", ">1</text>"].map(|sign| panel.rfind(sign).unwrap());
    assert!(first_number == number && ring < number);
    let before = folder.content();
    folder
        .line("in new --engine cpu --picture p.svg --picture-box 50,4,60,2")
        .refused(&["no vertex lies in the rectangle of --picture-box"]);
    let run = folder.line("in new --engine cpu --picture p.svg --picture-box 0,0,0,1");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["--picture-box", "the corners must differ in both coordinates"]);
    assert!(folder.content() == before);
}

/// Texts of a run on a narrow picture, in both panels, with the longest numbers.
#[test]
fn headings_fit_narrow_panels() {
    let folder = small();
    for width in [400, 600] {
        let line = format!(
            "in out --engine cpu -q --force --picture-size {width} --picture-measure size-ratio --picture"
        );
        folder.line(&format!("{line} p.png")).clean();
        let image = Image::read(&folder, "p.png");
        // Two panels with margins of 11 pixels; the headings are above the meshes, and the legend is below.
        let gap = [(width - 33) / 2 + 12, (width - 33) / 2 + 21];
        let margin = [width - 10, width];
        let ink = image.places(|pixel| pixel != [255; 4]);
        let is_clipped = |place: &[usize; 2]| {
            let top = place[1] < 40 && (gap[0]..gap[1]).contains(&place[0]);
            top || (margin[0]..margin[1]).contains(&place[0])
        };
        assert!(!ink.iter().any(is_clipped), "{width}");
        folder.line(&format!("{line} p.svg")).clean();
        let svg = folder.text("p.svg");
        assert_holds(
            &svg,
            &["160 triangles;", "mean 1", ">boundary</text>", ">worst triangles</text>"],
        );
        assert_eq!(svg.contains("160 triangles; size-ratio"), width == 600);
    }
}

/// The numbers of rings at the sides of the drawn part are inside, and the heading has the values of the part.
#[test]
fn numbers_and_headings_are_of_the_drawn_part() {
    let folder = small();
    let told = folder.line("quality in --worst 1 --json").clean().out;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let corners = told["worst"][0]["corners"].as_array().unwrap();
    let [x, y] =
        [0, 1].map(|axis| corners.iter().map(|p| p[axis].as_f64().unwrap() / 3.0).sum::<f64>());
    let worst = told["worst"][0]["shape"].as_f64().unwrap();
    // Draws a part, and returns the picture with the number of triangles in the heading and their least shape.
    let drawn = |[x0, y0, x1, y1]: [f64; 4]| {
        let part = format!("quality in --picture p.svg --picture-box={x0},{y0},{x1},{y1}");
        folder.line(&part).clean();
        let svg = folder.text("p.svg");
        let (before, after) = svg.split_once(" of 160 triangles; shape ").unwrap();
        let count: usize = before.rsplit('>').next().unwrap().parse().unwrap();
        let least: f64 = after.split(' ').next().unwrap().parse().unwrap();
        (svg.clone(), count, least)
    };
    let e = 1e-6;
    // The middle of the worst triangle is at a corner of each part.
    for part in [
        [x - e, y - 2.0, x + 2.0, y + e],
        [x - 2.0, y - 2.0, x + e, y + e],
        [x - 2.0, y - e, x + e, y + 2.0],
    ] {
        let (svg, count, least) = drawn(part);
        assert!((1..80).contains(&count) && (least / worst - 1.0).abs() < 1e-3, "{count}, {least}");
        let frame = svg.split("<svg").nth(2).unwrap().split('>').next().unwrap();
        let [left, top, width, height] =
            ["x", "y", "width", "height"].map(|key| numbers(frame, key)[0]);
        let number = svg.split("<text").find(|text| text.contains(">1</text>")).unwrap();
        let [x, y, size] = ["x", "y", "font-size"].map(|key| numbers(number, key)[0]);
        assert!(left < x && x + 0.6 * size < left + width, "{part:?}: {number}");
        assert!(top < y - 0.7 * size && y < top + height, "{part:?}: {number}");
    }
    // A part without the worst triangle has another range.
    let (_, _, least) = drawn([x + e, y + e, x + 3.0, y + 3.0]);
    assert!(least > 1.1 * worst, "{least}");
}

#[test]
fn enlarged_triangles_have_outlines_and_a_bar_for_the_scale() {
    let mesh = support::perturb_random(&support::lattice(60, 60), 0.2, 7);
    let [node, ele] = support::triangle_text(&mesh, "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    folder.line("quality in --picture p.svg --picture-size 800").clean();
    let svg = folder.text("p.svg");
    // Seven longest edges fit an inset, and the bar is at most a third of the inset.
    assert_holds(&svg, &[">1: shape ", ">2</text>"]);
    let insets: Vec<&str> = svg.split("<svg ").skip(2).collect();
    assert_eq!(insets.len(), 3);
    for inset in insets {
        let drawn = inset.split("</svg>").next().unwrap();
        let outline = drawn.rsplit("<path ").next().unwrap();
        assert!(
            outline.contains("stroke=\"#000000\"") && outline.matches('M').count() == 3,
            "{outline}"
        );
    }
}

#[test]
fn regions_and_fixed_vertices_are_named_where_they_are() {
    let folder = small();
    let plain = "quality in --picture p.svg";
    folder.line(plain).clean();
    assert!(
        !folder.text("p.svg").contains("fixed vertex") && !folder.text("p.svg").contains("regions")
    );
    fs::write(folder.path("in.poly"), "0 2 0 0\n1 0\n1 50 51\n0\n").unwrap();
    folder.line(plain).clean();
    assert_holds(&folder.text("p.svg"), &[">fixed vertex inside</text>"]);
    fs::remove_file(folder.path("in.poly")).unwrap();
    let ele = folder.text("in.ele").replacen("160 3 0", "160 3 1", 1);
    let mut row = 0;
    let with_attribute = ele.lines().map(|line| {
        let is_triangle = line.split(' ').count() == 4;
        row += usize::from(is_triangle);
        if is_triangle { format!("{line} {}\n", row / 80) } else { format!("{line}\n") }
    });
    fs::write(folder.path("in.ele"), with_attribute.collect::<String>()).unwrap();
    folder.line(plain).clean();
    assert_holds(
        &folder.text("p.svg"),
        &[">between regions</text>", ">fixed vertex inside</text>"],
    );
}

#[test]
fn pictures_that_cannot_be_written_are_refused_before_the_work() {
    let folder = small();
    let before = folder.content();
    folder
        .line("in out --engine cpu --picture none/p.png")
        .refused(&["the picture cannot be written: ", "none"]);
    for (line, parts) in [
        (
            "quality in --picture p.png --picture-range 0.5,1.5",
            [
                "both values of shape must be from 0 to 1",
                "Give two values of shape, as in --picture-range 0.5,1",
            ],
        ),
        (
            "in out --engine cpu --picture p.svg --picture-measure imr --picture-range=-1,2",
            ["both values of imr must be finite and at least 1", "--picture-range 1,2"],
        ),
        (
            "in out --engine cpu --html p.html --picture-range 1,0.5",
            ["the first value must be below the second", "--picture-range 0.5,1"],
        ),
        (
            "in out --engine cpu --picture p.svg --report p.svg",
            ["p.svg: ", "would replace this file"],
        ),
        ("in out --engine cpu --picture p.jpg", ["p.jpg: ", "is PNG or SVG"]),
        ("quality in --picture p", ["p: ", "is PNG or SVG"]),
    ] {
        folder.line(line).misused(&parts);
    }
    for (line, part) in [
        ("in out --picture-size 900", "--picture <FILE>"),
        ("quality in in --picture p.png", "p.png: --picture draws a single mesh: give only one"),
        ("quality in --picture p.png --picture-arrows", "--picture-arrows needs a run"),
        (
            "quality in --picture p.png --picture-size 20",
            "it must be a number of pixels from 400 to 8000",
        ),
        ("quality in --picture p.png --picture-range 0.5", "two numbers with a comma between them"),
        ("quality in --picture p.png --picture-range 0.5,nan", "two numbers with a comma"),
        ("quality in --picture-range 0.5,1", "--picture <FILE>|--html <FILE>"),
        ("quality in --picture p.png --picture-measure round", "no measure is called 'round'"),
    ] {
        let run = finish(folder.command().args(line.split(' ')));
        assert_eq!(run.code, Some(2), "{line}");
        assert_holds(&run.err, &[part]);
    }
    assert!(folder.content() == before);
}

#[test]
fn quadrilaterals_are_drawn_in_gray_without_a_boundary_to_triangles() {
    let folder = Folder::new(&[("in.off", MIXED)]);
    let line = "quality in.off --quadrilaterals keep --picture-size 800";
    folder.line(&format!("{line} --picture p.svg")).clean();
    let svg = folder.text("p.svg");
    assert_holds(&svg, &[">fixed quadrilateral</text>"]);
    assert!(!svg.contains("fixed vertex"), "{svg}");
    folder.line(&format!("{line} --picture p.png")).clean();
    let image = Image::read(&folder, "p.png");
    // All colored and gray pixels above the legend.
    let mesh = |[_, row]: &[usize; 2]| *row < image.height - 90;
    let is_gray = |pixel| pixel == [196, 198, 201, 255];
    let mut all = image.places(|pixel| is_face(pixel) || is_gray(pixel));
    all.retain(mesh);
    let [[left, right], [top, bottom]] = bounds(&all);
    assert!((right - left).abs_diff(bottom - top) < 8, "{left} {right} {top} {bottom}");
    // Triangles fill a quarter of the square at its lower left, and gray quadrilaterals the quarters beside it.
    let at = |x: f64, y: f64| {
        let column = left as f64 + x * (right - left) as f64;
        let row = bottom as f64 - y * (bottom - top) as f64;
        image.pixels[row as usize * image.width + column as usize]
    };
    assert!(is_face(at(0.3, 0.3)) && is_gray(at(0.75, 0.25)) && is_gray(at(0.25, 0.75)));
    assert_eq!(at(0.75, 0.75), [255; 4]);
    // An edge between a triangle and a quadrilateral is thin and gray, and no black line of the boundary.
    let dark = |x: f64, y: f64| (-4..=4).map(|i| at(x + f64::from(i) / 800.0, y)[1]).min().unwrap();
    assert!(dark(0.5, 0.3) > 140 && dark(1.0, 0.3) < 110, "{} {}", dark(0.5, 0.3), dark(1.0, 0.3));
}

/// The scale of such a picture was infinite, and the program panicked.
#[test]
fn a_mesh_at_one_place_is_drawn_as_a_point() {
    let nodes = "3\n1 5 7 0\n2 5 7 0\n3 5 7 0\n";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n"
    );
    let folder = Folder::new(&[("point.msh", &text)]);
    for option in
        ["--picture p.png", "--picture p.svg", "--html one.html", "point.msh --html two.html"]
    {
        let run = folder.line(&format!("quality point.msh {option}"));
        assert_eq!(run.code, Some(0), "{option}: {}", run.err);
    }
    assert!(folder.text("p.svg").len() < 1 << 20);
}
