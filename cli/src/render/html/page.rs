//! The frame of a page: head, style and script.

use serde_json::Value;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("viewer.js");
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

    /// Fills the template of the viewer. `faces` is the name of the fixed faces of the mesh; `None` without any.
    fn fill(self, caption: &str, faces: Option<&str>) -> String {
        let (class, together, slid) = match self {
            Self::Mesh => ("one", "", ""),
            Self::Run => (
                "two",
                "; both views move together",
                "<li><span class=\"sign slid\"></span>vertex that slid</li>",
            ),
        };
        let text = VIEWER.replace("{views}", &self.figures()).replace("{class}", class);
        let text = text.replace("{together}", together).replace("{slid}", slid);
        let sign = |name| format!("<li><span class=\"sign face\"></span>{}</li>", escape(name));
        let text = text.replace("{faces}", &faces.map(sign).unwrap_or_default());
        text.replace("{caption}", &escape(caption))
    }
}

/// A mesh for the viewer.
pub(crate) struct ViewerMesh {
    /// One or two sentences on the drawn part of the mesh.
    pub(crate) caption: String,
    /// Name of the quadrilaterals and polygons; `None` if the mesh has triangles alone.
    pub(crate) faces: Option<&'static str>,
    /// JSON that the script draws.
    pub(crate) data: Value,
}

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
        self.body += &format!("<section><h2>{}</h2>\n{content}\n</section>\n", escape(title));
    }

    /// Adds the section with the mesh viewer.
    pub(crate) fn mesh(&mut self, mesh: &ViewerMesh, view: View) {
        let content = view.fill(&mesh.caption, mesh.faces);
        self.body += &format!("<section id=\"mesh\"><h2>Mesh</h2>\n{content}</section>\n");
        // Without `<`, no text in the JSON can end the script element.
        self.data = mesh.data.to_string().replace('<', "\\u003c");
    }

    pub(crate) fn finish(self) -> String {
        let Self { title, body, data } = self;
        // The script draws the data of the viewer.
        let scripts = match data.is_empty() {
            true => String::new(),
            false => format!(
                "<script type=\"application/json\" id=\"data\">{data}</script>\n<script>\n{SCRIPT}</script>\n"
            ),
        };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{title} - gpu-smooth</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}</main>\n{scripts}</body>\n</html>\n"
        )
    }
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
