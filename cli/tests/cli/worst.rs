//! Improvement of the worst triangles (`--improve-worst`): printed text and report.

use super::{Folder, assert_holds, assert_smoothed, number};

#[test]
fn the_worst_triangle_before_and_after_is_printed_and_reported() {
    let outline = include_str!("../../../meshes/plate.outline");
    let plate = support::triangulate(&support::Outline::parse(outline).unwrap(), 300).unwrap();
    let [node, ele] = support::triangle_text(&support::perturb_random(&plate, 0.5, 3), "");
    let folder = Folder::new(&[("in.node", &node), ("in.ele", &ele)]);
    let line = "in.node out --engine cpu --improve-worst=min-angle --report r.json --html p.html";
    let run = folder.line(line).clean();
    assert_smoothed(&folder.mesh("in.node"), &folder.mesh("out.node"));
    let told = &folder.json("r.json");
    let improved = &told["improved"];
    assert_eq!(improved["measure"], "min-angle");
    let [before, after] = [0, 1].map(|i| number(&improved["worst"][i]));
    assert!(after > before + 0.5, "{improved}");
    assert!((number(&told["after"]["min_angle"]) - after).abs() < 1e-9, "{improved}");
    assert!((number(&told["after"]["f"]["imr"]) / number(&improved["f"][1]) - 1.0).abs() < 1e-9);
    let sentence = format!(
        "the least angle of movable triangles was improved from {before:.2}° to {after:.2}° by {} vertices, which changed f by +",
        improved["vertices"]
    );
    assert_holds(&run.out, &[&sentence]);
    assert_holds(&std::fs::read_to_string(folder.path("p.html")).unwrap(), &[&sentence]);
    // The measure needs `=`: the word after the option is a file.
    let run = folder.line("--engine cpu --improve-worst in.node out").clean();
    assert_holds(&run.out, &["the worst imr of movable triangles was improved from "]);
    let run = folder.line("in.node out --improve-worst=size");
    assert_eq!(run.code, Some(2));
    assert_holds(&run.err, &["--improve-worst", "imr, min-angle, altitude"]);
}
