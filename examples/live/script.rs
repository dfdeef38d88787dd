//! Scripts in place of a user. One command a line, `#` starts a comment:
//!
//! ```text
//! wait N                    lets N frames pass
//! press X Y                 presses the mouse button at a point of the mesh's plane
//! move X Y N                moves the pointer there, over N frames
//! release                   lets go of the button
//! drag X0 Y0 X1 Y1 N        these three in one
//! key K                     presses a key: a character, or `space`
//! screenshot NAME.png       writes what the window shows, in the directory of --out
//! check                     fails unless every triangle is positive, by exact arithmetic
//! quit                      ends the script, as does its end
//! ```

use std::path::PathBuf;
use std::time::Instant;

use super::Result;
use super::app::App;

enum Command {
    Wait(u32),
    Press([f64; 2]),
    Move([f64; 2], u32),
    Release,
    Key(char),
    Screenshot(String),
    Check,
}

/// A script and the state of its execution.
pub(crate) struct Script {
    commands: Vec<Command>,
    next: usize,
    /// Number of frames spent on the next command.
    spent: u32,
    /// Position of the pointer before the next command, in the mesh's plane.
    pointer: [f64; 2],
    out: PathBuf,
    start: Instant,
    frames: u32,
}

impl Script {
    /// Parses a script. Screenshots are written to the folder `out`.
    pub(crate) fn parse(text: &str, out: PathBuf) -> std::result::Result<Self, String> {
        let mut commands = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.split('#').next().unwrap_or_default();
            let words: Vec<_> = line.split_whitespace().collect();
            parse_line(&words, &mut commands)
                .ok_or_else(|| format!("line {number}: '{}' is no command", line.trim()))?;
            if words == ["quit"] {
                break;
            }
        }
        let (start, pointer) = (Instant::now(), [0.0; 2]);
        Ok(Self { commands, next: 0, spent: 0, pointer, out, start, frames: 0 })
    }

    /// Executes the commands before the next frame. Returns false after the last command.
    pub(crate) fn advance(&mut self, app: &mut App) -> Result<bool> {
        if self.frames == 0 {
            self.start = Instant::now();
        }
        while let Some(command) = self.commands.get(self.next) {
            let frames = match command {
                &Command::Wait(frames) | &Command::Move(_, frames) => frames,
                _ => 0,
            };
            if self.spent < frames {
                self.spent += 1;
                self.frames += 1;
                if let Command::Move(to, _) = command {
                    let share = f64::from(self.spent) / f64::from(frames);
                    let from = self.pointer;
                    let at = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
                    app.move_to(app.view().to_pixels(at));
                }
                return Ok(true);
            }
            match command {
                Command::Wait(_) => {}
                Command::Press(at) => {
                    self.pointer = *at;
                    app.press(app.view().to_pixels(*at))?;
                }
                Command::Move(to, _) => self.pointer = *to,
                Command::Release => app.release()?,
                Command::Key(key) => app.key(*key)?,
                Command::Screenshot(name) => app.capture(&self.out.join(name))?,
                Command::Check => match app.smoothing.count_infeasible()? {
                    0 => println!("frame {}: no triangle is inverted", self.frames),
                    n => return Err(format!("frame {}: {n} inverted", self.frames).into()),
                },
            }
            self.next += 1;
            self.spent = 0;
        }
        let seconds = self.start.elapsed().as_secs_f64();
        let rate = f64::from(self.frames) / seconds;
        println!("{} frames in {seconds:.1} s, {rate:.0} a second", self.frames);
        Ok(false)
    }
}

fn parse_line(words: &[&str], commands: &mut Vec<Command>) -> Option<()> {
    let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
    let point = |x: &str, y: &str| Some([number(x)?, number(y)?]);
    match *words {
        [] | ["quit"] => {}
        ["wait", frames] | ["wait", frames, "frames"] => {
            commands.push(Command::Wait(frames.parse().ok()?));
        }
        ["press", x, y] => commands.push(Command::Press(point(x, y)?)),
        ["move", x, y, frames] => {
            commands.push(Command::Move(point(x, y)?, frames.parse().ok()?));
        }
        ["release"] => commands.push(Command::Release),
        ["drag", x0, y0, x1, y1, frames] => {
            commands.push(Command::Press(point(x0, y0)?));
            commands.push(Command::Move(point(x1, y1)?, frames.parse().ok()?));
            commands.push(Command::Release);
        }
        ["key", "space"] => commands.push(Command::Key(' ')),
        ["key", key] => {
            let mut characters = key.chars();
            commands.push(Command::Key(characters.next()?));
            if characters.next().is_some() {
                return None;
            }
        }
        ["screenshot", name] => commands.push(Command::Screenshot(name.to_owned())),
        ["check"] => commands.push(Command::Check),
        _ => return None,
    }
    Some(())
}
