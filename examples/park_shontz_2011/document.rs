//! A report composed of blocks, in Markdown and HTML.

use std::fmt::Write;

/// A block of the report. Its text may contain `code`, **strong** and *emphasis*.
pub(crate) enum Block {
    Heading(u8, String),
    Text(String),
    List(Vec<String>),
    Table(Table),
    /// A figure with its file name in figures/, its SVG and its caption.
    Figure {
        file: String,
        svg: String,
        caption: String,
    },
}

/// A table with a head. The first column is text, the others contain numbers.
pub(crate) struct Table {
    pub(crate) caption: String,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
    /// Whether all columns contain text.
    pub(crate) prose: bool,
}

pub(crate) fn markdown(blocks: &[Block]) -> String {
    let mut out = String::new();
    for block in blocks {
        match block {
            Block::Heading(level, text) => {
                let _ = writeln!(out, "{} {text}\n", "#".repeat(usize::from(*level)));
            }
            Block::Text(text) => {
                let _ = writeln!(out, "{text}\n");
            }
            Block::List(items) => {
                items.iter().for_each(|item| {
                    let _ = writeln!(out, "- {item}");
                });
                out.push('\n');
            }
            Block::Table(table) => {
                let _ = writeln!(out, "{}\n", table.caption);
                let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
                out += &line(&table.head);
                let rule = |i| if i == 0 || table.prose { "---" } else { "---:" };
                out +=
                    &line(&(0..table.head.len()).map(|i| rule(i).to_owned()).collect::<Vec<_>>());
                table.rows.iter().for_each(|row| out += &line(row));
                out.push('\n');
            }
            Block::Figure { file, caption, .. } => {
                let _ = writeln!(out, "![{caption}](figures/{file})\n\n{caption}\n");
            }
        }
    }
    out.trim_end().to_owned() + "\n"
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;color:#222;max-width:72rem;margin:2rem auto;padding:0 1rem}
table{border-collapse:collapse;margin:.5rem 0 1.5rem;font-size:.9em}
caption{text-align:left;padding:.3rem 0;font-weight:600}
th,td{padding:.2rem .7rem;border-bottom:1px solid #ddd;text-align:right;vertical-align:top;font-variant-numeric:tabular-nums}
th:first-child,td:first-child,.prose th,.prose td{text-align:left}
.scroll{overflow-x:auto}figure{margin:1rem 0 2rem}figure svg{width:100%;height:auto}
figcaption{font-size:.9em}code{background:#f3f3f3;padding:0 .2em}";

pub(crate) fn html(title: &str, blocks: &[Block]) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n<style>{STYLE}</style>\n",
        escaped(title)
    );
    for block in blocks {
        match block {
            Block::Heading(level, text) => {
                let _ = writeln!(out, "<h{level}>{}</h{level}>", inline(text));
            }
            Block::Text(text) => {
                let _ = writeln!(out, "<p>{}</p>", inline(text));
            }
            Block::List(items) => {
                let items: Vec<_> =
                    items.iter().map(|item| format!("<li>{}</li>", inline(item))).collect();
                let _ = writeln!(out, "<ul>{}</ul>", items.join("\n"));
            }
            Block::Table(table) => {
                let row = |cells: &[String], tag: &str| {
                    let cells: Vec<_> = cells
                        .iter()
                        .map(|cell| format!("<{tag}>{}</{tag}>", inline(cell)))
                        .collect();
                    format!("<tr>{}</tr>\n", cells.concat())
                };
                let class = if table.prose { " class=\"prose\"" } else { "" };
                let _ = writeln!(
                    out,
                    "<div class=\"scroll\"><table{class}><caption>{}</caption>\n{}{}</table></div>",
                    inline(&table.caption),
                    row(&table.head, "th"),
                    table.rows.iter().map(|cells| row(cells, "td")).collect::<String>()
                );
            }
            Block::Figure { svg, caption, .. } => {
                let svg = svg.find("<svg").map_or("", |start| &svg[start..]);
                let _ = writeln!(
                    out,
                    "<figure>{svg}<figcaption>{}</figcaption></figure>",
                    inline(caption)
                );
            }
        }
    }
    out + "</html>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Converts text with `code`, **strong** and *emphasis* to HTML.
fn inline(text: &str) -> String {
    let mut out = escaped(text);
    for (mark, tag) in [("`", "code"), ("**", "strong"), ("*", "em")] {
        let parts: Vec<_> = out.split(mark).map(str::to_owned).collect();
        out = parts[0].clone();
        for (i, part) in (1..).zip(&parts[1..]) {
            let slash = if i % 2 == 0 { "/" } else { "" };
            let _ = write!(out, "<{slash}{tag}>{part}");
        }
    }
    out
}
