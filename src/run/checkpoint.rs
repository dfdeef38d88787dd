//! Checkpoints: the state of a run as bytes, from which the run can continue later.

use crate::error::CheckpointError;
use crate::run::checksum::crc32;
use crate::run::opening::DoublePrelude;
use crate::run::records::{Reader, Writer};
use crate::run::saved::{CPU, EngineState, PeriodState, Saved};

/// The state of a run between two sweeps, with all data needed to continue the run. On the same engine, the continued
/// run computes the same bits as a run without interruption.
///
/// A [`CheckpointPolicy`](crate::CheckpointPolicy) receives checkpoints. [`Run::resume`](crate::Run::resume) continues
/// from a checkpoint, with an equal mesh and equal options.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(crate) about: RunFingerprint,
    pub(crate) saved: Saved,
    /// State of the stage of a target field. `None` for a run without such a stage.
    pub(crate) period: Option<PeriodState>,
}

/// The run of a checkpoint, as matched on resumption: mesh, options, goal, and sweeps on the CPU for a device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunFingerprint {
    /// Hash of the mesh, its targets, and the curves of sliding vertices.
    pub(crate) mesh: u64,
    /// Options of the run, one option on each line.
    pub(crate) options: String,
    /// Desired objective and its origin. `None` for a run without a goal.
    pub(crate) goal: Option<(f64, String)>,
    /// Result of the sweeps on the CPU before the device began. `None` for a run without such sweeps.
    pub(crate) opened: Option<DoublePrelude>,
    /// Number of sweeps, without opening sweeps, after which the CPU replaced the device. `None` without such a change.
    pub(crate) on_cpu_from: Option<u32>,
}

impl Checkpoint {
    /// First bytes of a checkpoint file in every version of the format.
    pub const MAGIC: &[u8; 22] = b"gpu-smooth checkpoint ";
    /// Version of the format that the library reads and writes. The version follows [`Self::MAGIC`], on the same line.
    const VERSION: &str = "8";
    /// Start of the second line. The rest of the line names the program and version that wrote the checkpoint.
    const WRITER: &str = "written by ";
    /// Name and version of this library.
    const OWN_WRITER: &str = concat!("gpu-smooth ", env!("CARGO_PKG_VERSION"));

    /// Returns the number of sweeps before the checkpoint, opening sweeps included.
    pub fn sweeps(&self) -> u32 {
        let opened = self.about.opened.as_ref().map_or(0, DoublePrelude::sweeps);
        opened + self.saved.sweeps()
    }

    /// Returns the name of the adapter of the last sweep. `None` for the CPU.
    pub fn adapter(&self) -> Option<&str> {
        Some(&*self.saved.engine.engine).filter(|name| *name != CPU)
    }

    /// Encodes the checkpoint as bytes. The length is about 16 bytes for each vertex. Once sweeps are corrected from coarser
    /// levels, the length is up to 92 bytes a vertex on the CPU and 126 on a device. Vertices of strongly stretched meshes take 12
    /// bytes more, and vertices that slide up to 17.
    ///
    /// The bytes are [`MAGIC`](Self::MAGIC) and the version of the format on a line, the version of this library on a
    /// line, records, and a CRC-32 of all bytes before. A record consists of name and content, each after its length in
    /// bytes. Numbers are little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { about, saved, period } = self;
        let head = format!("{}\n{}{}\n", Self::VERSION, Self::WRITER, Self::OWN_WRITER);
        let mut out = Writer([&Self::MAGIC[..], head.as_bytes()].concat());
        out.record("mesh", |out| out.number(about.mesh));
        out.record("options", |out| out.text(&about.options));
        if let Some((desired, origin)) = &about.goal {
            out.record("goal", |out| {
                out.real(*desired);
                out.text(origin);
            });
        }
        if let Some(DoublePrelude { log, least, positions, best }) = &about.opened {
            out.record("opening", |out| {
                out.log(log);
                out.real(*least);
                out.points(positions);
                out.points(best);
            });
        }
        if let Some(sweep) = about.on_cpu_from {
            out.record("on cpu from", |out| out.number(sweep.into()));
        }
        out.record("history", |out| {
            out.log(&saved.log);
            out.optional(saved.remaining);
        });
        out.record("control", |out| out.named(&saved.control));
        let EngineState { engine, positions, best, roots, own } = &saved.engine;
        out.record("engine", |out| {
            out.text(engine);
            out.points(positions);
            out.list(best.as_slice(), |out, best| out.points(best));
            out.list(roots, |out, roots| out.list(roots, |out, r| out.0.extend(r.to_le_bytes())));
            out.named(own);
        });
        if let Some(PeriodState { began, before, f_before, stage }) = period {
            out.record("period", |out| {
                out.number((*began).into());
                out.points(before);
                out.real(*f_before);
                out.named(stage);
            });
        }
        let sum = crc32(&out.0);
        out.0.extend(sum.to_le_bytes());
        out.0
    }

    /// Decodes a checkpoint from the bytes of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// [`CheckpointError`] for bytes that are no checkpoint, another version of the format, and changed bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let content = bytes.strip_prefix(Self::MAGIC).ok_or(CheckpointError::Foreign)?;
        let (version, content) = line(content);
        let (second, content) = line(content);
        let writer =
            second.strip_prefix(Self::WRITER).unwrap_or("an earlier version of gpu-smooth");
        let writer = writer.to_owned();
        if version != Self::VERSION {
            return Err(CheckpointError::Version { writer });
        }
        let is_whole = bytes
            .split_last_chunk()
            .is_some_and(|(before, sum)| crc32(before) == u32::from_le_bytes(*sum));
        let records = content.split_last_chunk::<4>().filter(|_| is_whole);
        let decoded = records.and_then(|(records, _)| Self::of_records(records));
        decoded.ok_or(CheckpointError::Damaged { writer })
    }

    /// Decodes the records behind the head of a checkpoint. `None` for records that [`to_bytes`](Self::to_bytes) does
    /// not write.
    fn of_records(content: &[u8]) -> Option<Self> {
        let mut records = Reader(content).records()?;
        let about = RunFingerprint {
            mesh: records.read("mesh", Reader::number)?,
            options: records.read("options", Reader::text)?,
            goal: records.read_if_any("goal", |from| Some((from.real()?, from.text()?)))?,
            opened: records.read_if_any("opening", |from| {
                let (log, least) = (from.log()?, from.real()?);
                Some(DoublePrelude { log, least, positions: from.points()?, best: from.points()? })
            })?,
            on_cpu_from: records.read_if_any("on cpu from", Reader::count)?,
        };
        let (log, remaining) =
            records.read("history", |from| Some((from.log()?, from.option(Reader::real)?)))?;
        let saved = Saved {
            log,
            remaining,
            control: records.read("control", Reader::named)?,
            engine: records.read("engine", |from| {
                Some(EngineState {
                    engine: from.text()?,
                    positions: from.points()?,
                    best: from.option(Reader::points)?,
                    roots: from.list(8, |from| {
                        from.list(4, |from| Some(f32::from_le_bytes(from.take()?)))
                    })?,
                    own: from.named()?,
                })
            })?,
        };
        let period = records.read_if_any("period", |from| {
            Some(PeriodState {
                began: from.count()?,
                before: from.points()?,
                f_before: from.real()?,
                stage: from.named()?,
            })
        })?;
        records.end()?;
        Some(Self { about, saved, period })
    }
}

/// Splits bytes behind the first line. Returns the line without its end, empty if the line is not a short text, and the
/// bytes behind the line.
fn line(bytes: &[u8]) -> (&str, &[u8]) {
    /// Length in bytes of the longest line.
    const LONGEST: usize = 100;
    let end = bytes.iter().take(LONGEST).position(|&byte| byte == b'\n');
    let (text, rest) = end.map_or((&[][..], bytes), |end| (&bytes[..end], &bytes[end + 1..]));
    (std::str::from_utf8(text).unwrap_or_default(), rest)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::metric::Metric;
    use crate::run::named::Named;
    use crate::run::objectives::Objectives;

    fn example() -> Checkpoint {
        let mut objectives = Objectives::empty();
        Metric::ALL.iter().for_each(|metric| objectives.set(*metric, 1.5));
        let log = vec![objectives; 3];
        let points = vec![DVec2::new(0.25, -1e-300), DVec2::new(-0.0, 7.0)];
        let mut engine = EngineState {
            engine: CPU.to_owned(),
            positions: points.clone(),
            best: Some(points.clone()),
            roots: vec![vec![1.0, 2.0], vec![3.0, 4.0]],
            own: Named::default(),
        };
        engine.own.add_list("words", &[1_u32, 2, 3]);
        let mut control = Named::default();
        control.add_flag("settled", true);
        let opened = DoublePrelude {
            log: log.clone(),
            least: 1.25,
            positions: points.clone(),
            best: points,
        };
        let stage = control.clone();
        let period =
            PeriodState { began: 2, before: engine.positions.clone(), f_before: 1.5, stage };
        Checkpoint {
            period: Some(period),
            about: RunFingerprint {
                mesh: 17,
                options: "max_sweeps: 3".to_owned(),
                goal: Some((1.5, "given".to_owned())),
                opened: Some(opened),
                on_cpu_from: Some(1),
            },
            saved: Saved { log, remaining: Some(1e-3), control, engine },
        }
    }

    #[test]
    fn bytes_come_back_as_the_same_checkpoint() {
        let checkpoint = example();
        let again = Checkpoint::from_bytes(&checkpoint.to_bytes()).unwrap();
        assert_eq!(again, checkpoint);
        assert_eq!((again.sweeps(), again.adapter()), (4, None));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = example().to_bytes();
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(Checkpoint::from_bytes(&damaged).is_err(), "byte {at}");
            assert!(Checkpoint::from_bytes(&bytes[..at]).is_err(), "cut at {at}");
            // A length longer than any file, with a correct checksum.
            let mut huge = bytes[..bytes.len() - 4].to_vec();
            let end = (at + 8).min(huge.len());
            huge[at.min(end)..end].fill(0xFF);
            let sum = crc32(&huge);
            huge.extend(sum.to_le_bytes());
            let _ = Checkpoint::from_bytes(&huge);
        }
    }

    #[test]
    fn errors_name_the_version_that_wrote_the_checkpoint() {
        let bytes = example().to_bytes();
        let error = |bytes: &[u8]| Checkpoint::from_bytes(bytes).unwrap_err().to_string();
        let own = format!("gpu-smooth {}", env!("CARGO_PKG_VERSION"));
        let mut damaged = bytes.clone();
        *damaged.last_mut().unwrap() ^= 1;
        assert_eq!(error(&damaged), format!("the checkpoint, written by {own}, is damaged"));
        assert_eq!(error(b"any notes"), "the file is not a checkpoint of gpu-smooth");
        let other = format!("{own} does not read checkpoints that");
        for (head, writer) in [
            ("9\nwritten by gpu-smooth 9.1\n", "gpu-smooth 9.1"),
            ("2\n", "an earlier version of gpu-smooth"),
        ] {
            let bytes = [Checkpoint::MAGIC, head.as_bytes(), &bytes[60..]].concat();
            assert_eq!(error(&bytes), format!("{other} {writer} wrote"));
        }
    }
}
