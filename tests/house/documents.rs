//! Links between documents, and the list of pages of the site.

use std::fs;
use std::path::{Path, PathBuf};

use super::root;

/// Returns the documents of the repository.
fn documents() -> Vec<PathBuf> {
    let of_folder = |folder: &str| {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        entries.map(|entry| entry.unwrap().path())
    };
    let all =
        ["", "docs", "mesh-io", "python", "meshes"].iter().flat_map(|folder| of_folder(folder));
    all.filter(|path| path.extension().is_some_and(|ending| ending == "md")).collect()
}

/// Returns the targets of the links in a document. Blocks of code have none.
fn links(text: &str) -> Vec<String> {
    let mut links = Vec::new();
    let mut is_code = false;
    for line in text.lines() {
        is_code ^= line.trim_start().starts_with("```");
        if is_code {
            continue;
        }
        // Text between backticks at odd places is code.
        let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        let targets = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        links.extend(targets.map(str::to_owned));
    }
    links
}

/// Returns the anchors of a document: those of its headings, as code hosts and mdBook make them, and those of HTML.
fn anchors(text: &str) -> Vec<String> {
    let slug = |heading: &str| {
        let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
        heading.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
    };
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let of_headings = headings.map(|line| slug(line.trim_start_matches('#').trim()));
    let ids = text.split("id=\"").skip(1).filter_map(|rest| rest.split('"').next());
    of_headings.chain(ids.map(str::to_owned)).collect()
}

#[test]
fn links_of_documents_lead_to_files_and_headings() {
    let mut broken = Vec::new();
    let mut count = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for link in links(&text).iter().filter(|link| !link.contains("://") && !link.is_empty()) {
            count += 1;
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match path {
                "" => document.clone(),
                path => document.parent().unwrap().join(path),
            };
            let is_found = match anchor {
                "" => target.exists(),
                anchor => fs::read_to_string(&target)
                    .is_ok_and(|text| anchors(&text).iter().any(|own| own == anchor)),
            };
            if !is_found {
                broken.push(format!("{}: {link}", document.display()));
            }
        }
    }
    assert!(count > 100, "only {count} links");
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn the_site_has_each_document() {
    let summary = links(&fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap());
    for path in documents().iter().filter(|path| path.parent() == Some(&*root().join("docs"))) {
        let name = Path::new(path.file_name().unwrap()).to_str().unwrap();
        assert!(
            name == "SUMMARY.md" || summary.iter().any(|own| own == name),
            "docs/SUMMARY.md lacks {name}"
        );
    }
}
