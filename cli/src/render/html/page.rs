//! The frame of a page: head, style and script.

use serde_json::Value;

use crate::request::PAGE_MARK;

const STYLE: &str = include_str!("page.css");
/// The script of every page: hover texts of charts, and tables that sort.
const SCRIPT: &str = include_str!("page.js");
/// The scripts of pages with a mesh viewer: drawing, and what follows the pointer.
const VIEWER_SCRIPTS: [&str; 2] = [include_str!("viewer.js"), include_str!("pointer.js")];
const VIEWER: &str = include_str!("viewer.html");

/// The hint that a view shows if the wheel turns over it.
const HINT: &str = "<span class=\"hint\" aria-hidden=\"true\">Ctrl + wheel enlarges. After a click on the view, the wheel alone does.</span>";

/// The views of the mesh viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// The mesh before and after a run, side by side.
    Run,
    /// One mesh.
    Mesh,
}

impl View {
    /// Returns the figures of the viewer as HTML.
    fn figures(self) -> String {
        let figure = |caption: &str, label: &str| {
            format!(
                "<figure>{caption}<canvas tabindex=\"0\" aria-label=\"{label}\"></canvas>{HINT}</figure>\n"
            )
        };
        match self {
            Self::Mesh => figure("", "the mesh"),
            Self::Run => ["before", "after"]
                .map(|state| {
                    let caption = format!("<figcaption>{state}</figcaption>");
                    figure(&caption, &format!("the mesh {state} the run"))
                })
                .concat(),
        }
    }

    /// Fills the template of the viewer for a mesh.
    fn fill(self, mesh: &ViewerMesh) -> String {
        let (class, together) = match self {
            Self::Mesh => ("one", ""),
            Self::Run => ("two", "; both views move together"),
        };
        let sign = |(sign, name): &(&str, &str)| {
            format!("<li><span class=\"sign {sign}\"></span>{}</li>", escape(name))
        };
        let signs: String = mesh.signs.iter().map(sign).collect();
        let text = VIEWER.replace("{views}", &self.figures()).replace("{class}", class);
        let text = text.replace("{together}", together).replace("{signs}", &signs);
        text.replace("{caption}", &escape(&mesh.caption))
    }
}

/// A mesh for the viewer.
pub(crate) struct ViewerMesh {
    /// One or two sentences on the drawn part of the mesh.
    pub(crate) caption: String,
    /// Lines and marks that the mesh has: class in the style of the page, and name.
    pub(crate) signs: Vec<(&'static str, &'static str)>,
    /// JSON that the script draws.
    pub(crate) data: Value,
}

/// A section: title and HTML.
pub(crate) type Section<'a> = (&'a str, String);

/// A page under construction.
pub(crate) struct Page {
    title: String,
    body: String,
    data: String,
}

impl Page {
    pub(crate) fn new(title: &str) -> Self {
        let title = escape(title);
        let body = format!("<header><h1>{title}</h1>\n</header>\n<main>\n");
        Self { title, body, data: String::new() }
    }

    /// Adds a paragraph at the top of the page.
    pub(crate) fn lead(&mut self, text: &str) {
        self.body += &format!("<p class=\"lead\">{}</p>\n", escape(text));
    }

    /// Adds a section; `content` is HTML.
    pub(crate) fn section(&mut self, title: &str, content: &str) {
        self.body += &section(title, content);
    }

    /// Adds a section to which links lead by the name `id`.
    pub(crate) fn linked_section(&mut self, id: &str, title: &str, content: &str) {
        self.body +=
            &section(title, content).replacen("<section", &format!("<section id=\"{id}\""), 1);
    }

    /// Adds columns of sections, side by side in a wide window, and in order in a narrow one.
    pub(crate) fn columns(&mut self, columns: &[&[Section<'_>]]) {
        self.body += "<div class=\"columns\">";
        for sections in columns {
            let sections: String =
                sections.iter().map(|(title, content)| section(title, content)).collect();
            self.body += &format!("<div>{sections}</div>");
        }
        self.body += "</div>\n";
    }

    /// Adds the section with the mesh viewer.
    pub(crate) fn mesh(&mut self, mesh: &ViewerMesh, view: View) {
        let content = view.fill(mesh);
        self.body += &format!("<section id=\"mesh\"><h2>Mesh</h2>\n{content}</section>\n");
        // Without `<`, no text in the JSON can end the script element.
        self.data = mesh.data.to_string().replace('<', "\\u003c");
    }

    pub(crate) fn finish(self) -> String {
        let Self { title, body, data } = self;
        let scripts = match data.is_empty() {
            true => format!("<script>\n{SCRIPT}</script>\n"),
            false => format!(
                "<script type=\"application/json\" id=\"data\">{data}</script>\n<script>\n{SCRIPT}{}</script>\n",
                VIEWER_SCRIPTS.concat()
            ),
        };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n{PAGE_MARK}\n\
             <title>{title} - gpu-smooth</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}</main>\n{scripts}</body>\n</html>\n"
        )
    }
}

fn section(title: &str, content: &str) -> String {
    format!("<section><h2>{}</h2>\n{content}\n</section>\n", escape(title))
}

/// Escapes a text for HTML, attributes included.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}
