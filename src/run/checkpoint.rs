//! Checkpoints: the state of a run as bytes, from which the run can continue later.

use glam::DVec2;

use crate::metric::Metric;
use crate::run::checksum::crc32;
use crate::run::objectives::Objectives;
use crate::run::opening::Opened;
use crate::run::saved::{CPU, EngineState, Saved};

/// The state of a run between two sweeps, with all data needed to continue it. On the same engine the continued run
/// gives the same bits as one that was never interrupted.
///
/// A [`CheckpointPolicy`](crate::CheckpointPolicy) receives it, and [`Smoother::run_kept`](crate::Smoother::run_kept) continues from it,
/// with the same mesh and the same options.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(crate) about: About,
    pub(crate) saved: Saved,
}

/// The data of a checkpoint other than the state of the sweeps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct About {
    /// A hash of the mesh.
    pub(crate) mesh: u64,
    /// The options, a field on each line.
    pub(crate) options: String,
    /// The desired objective and its origin, if the run has a goal.
    pub(crate) goal: Option<(f64, String)>,
    /// The result of the sweeps on the CPU before a device could begin.
    pub(crate) opened: Option<Opened>,
}

impl Checkpoint {
    /// The first bytes of every checkpoint, with the version of the format.
    pub const MAGIC: &[u8; 24] = b"gpu-smooth checkpoint 1\n";

    /// Returns the number of sweeps that were done.
    pub fn sweeps(&self) -> u32 {
        let opened = self.about.opened.as_ref().map_or(0, Opened::sweeps);
        opened + self.saved.sweeps()
    }

    /// Returns the name of the adapter that did the last sweep; `None` for the CPU.
    pub fn adapter(&self) -> Option<&str> {
        Some(&*self.saved.engine.engine).filter(|name| *name != CPU)
    }

    /// Returns the checkpoint as bytes, with a checksum: about 16 bytes for each vertex, and up to 76 once sweeps are
    /// corrected from coarser levels.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { about, saved } = self;
        let mut out = Writer(Self::MAGIC.to_vec());
        out.number(about.mesh);
        out.bytes(about.options.as_bytes());
        out.list(about.goal.as_slice(), |out, (desired, origin)| {
            out.number(desired.to_bits());
            out.bytes(origin.as_bytes());
        });
        out.list(about.opened.as_slice(), |out, opened| {
            out.log(&opened.log);
            out.number(opened.least.to_bits());
            out.points(&opened.positions);
            out.points(&opened.best);
        });
        out.log(&saved.log);
        out.list(saved.remaining.as_slice(), |out, share| out.number(share.to_bits()));
        out.list(saved.corrections.as_slice(), |out, words| {
            out.list(words, |out, word| out.number(*word));
        });
        let EngineState { engine, positions, best, roots, own } = &saved.engine;
        out.bytes(engine.as_bytes());
        out.points(positions);
        out.list(best.as_slice(), |out, best| out.points(best));
        out.list(roots, |out, roots| out.list(roots, |out, r| out.0.extend(r.to_le_bytes())));
        out.list(own, |out, (name, bytes)| {
            out.bytes(name.as_bytes());
            out.bytes(bytes);
        });
        let sum = crc32(&out.0);
        out.0.extend(sum.to_le_bytes());
        out.0
    }

    /// Reads a checkpoint from the bytes that [`to_bytes`](Self::to_bytes) returned. `None` if the bytes are anything
    /// else, or were changed.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (content, sum) = bytes.split_last_chunk()?;
        if crc32(content) != u32::from_le_bytes(*sum) {
            return None;
        }
        let mut from = Reader(content.strip_prefix(Self::MAGIC)?);
        let about = About {
            mesh: from.number()?,
            options: from.text()?,
            goal: from.option(|from| Some((f64::from_bits(from.number()?), from.text()?)))?,
            opened: from.option(|from| {
                let (log, least) = (from.log()?, f64::from_bits(from.number()?));
                Some(Opened { log, least, positions: from.points()?, best: from.points()? })
            })?,
        };
        let saved = Saved {
            log: from.log()?,
            remaining: from.option(|from| Some(f64::from_bits(from.number()?)))?,
            corrections: from.option(|from| from.list(8, Reader::number))?,
            engine: EngineState {
                engine: from.text()?,
                positions: from.points()?,
                best: from.option(Reader::points)?,
                roots: from
                    .list(8, |from| from.list(4, |from| Some(f32::from_le_bytes(from.take()?))))?,
                own: from.list(16, |from| Some((from.text()?, from.bytes()?.to_vec())))?,
            },
        };
        from.0.is_empty().then_some(Self { about, saved })
    }
}

/// Writes numbers with their least byte first, and lists after their length.
struct Writer(Vec<u8>);

impl Writer {
    fn number(&mut self, number: u64) {
        self.0.extend(number.to_le_bytes());
    }

    fn list<T>(&mut self, list: &[T], mut write: impl FnMut(&mut Self, &T)) {
        self.number(list.len() as u64);
        list.iter().for_each(|item| write(self, item));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.0.extend(bytes);
    }

    fn points(&mut self, points: &[DVec2]) {
        self.list(points, |out, p| p.to_array().iter().for_each(|x| out.number(x.to_bits())));
    }

    fn log(&mut self, log: &[Objectives]) {
        self.list(log, |out, one| one.values().iter().for_each(|f| out.number(f.to_bits())));
    }
}

struct Reader<'b>(&'b [u8]);

impl<'b> Reader<'b> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn number(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// Reads a list of items that each take at least `least` bytes, so that an impossible length is refused.
    fn list<T>(
        &mut self,
        least: usize,
        mut read: impl FnMut(&mut Self) -> Option<T>,
    ) -> Option<Vec<T>> {
        let length = usize::try_from(self.number()?).ok()?;
        if length > self.0.len() / least {
            return None;
        }
        (0..length).map(|_| read(self)).collect()
    }

    fn option<T>(&mut self, read: impl FnMut(&mut Self) -> Option<T>) -> Option<Option<T>> {
        let mut list = self.list(1, read)?;
        let item = list.pop();
        list.is_empty().then_some(item)
    }

    fn bytes(&mut self) -> Option<&'b [u8]> {
        let length = usize::try_from(self.number()?).ok()?;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(bytes)
    }

    fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }

    fn float(&mut self) -> Option<f64> {
        self.number().map(f64::from_bits)
    }

    fn points(&mut self) -> Option<Vec<DVec2>> {
        self.list(16, |from| Some(DVec2::new(from.float()?, from.float()?)))
    }

    fn log(&mut self) -> Option<Vec<Objectives>> {
        self.list(8 * Metric::ALL.len(), |from| {
            let mut values = [0.0; Metric::ALL.len()];
            for value in &mut values {
                *value = from.float()?;
            }
            Some(Objectives::of_values(values))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Checkpoint {
        let log = vec![Objectives::of_values([1.5; Metric::ALL.len()]); 3];
        let points = vec![DVec2::new(0.25, -1e-300), DVec2::new(-0.0, 7.0)];
        let mut engine = EngineState {
            engine: CPU.to_owned(),
            positions: points.clone(),
            best: Some(points.clone()),
            roots: vec![vec![1.0, 2.0], vec![3.0, 4.0]],
            own: Vec::new(),
        };
        engine.add("words", &[1_u32, 2, 3]);
        let opened =
            Opened { log: log.clone(), least: 1.25, positions: points.clone(), best: points };
        Checkpoint {
            about: About {
                mesh: 17,
                options: "max_sweeps: 3".to_owned(),
                goal: Some((1.5, "given".to_owned())),
                opened: Some(opened),
            },
            saved: Saved { log, remaining: Some(1e-3), corrections: Some(vec![1, 2]), engine },
        }
    }

    #[test]
    fn bytes_come_back_as_the_same_checkpoint() {
        let checkpoint = example();
        let again = Checkpoint::from_bytes(&checkpoint.to_bytes()).unwrap();
        assert_eq!(again, checkpoint);
        assert_eq!((again.sweeps(), again.adapter()), (4, None));
        assert_eq!(again.saved.engine.own::<u32>("words", 3), Some(vec![1, 2, 3]));
        assert_eq!(again.saved.engine.own::<u32>("words", 2), None);
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = example().to_bytes();
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert_eq!(Checkpoint::from_bytes(&damaged), None, "byte {at}");
            assert_eq!(Checkpoint::from_bytes(&bytes[..at]), None, "cut at {at}");
            // A length that no file can have, with a correct checksum.
            let mut huge = bytes[..bytes.len() - 4].to_vec();
            let end = (at + 8).min(huge.len());
            huge[at.min(end)..end].fill(0xFF);
            let sum = crc32(&huge);
            huge.extend(sum.to_le_bytes());
            let _ = Checkpoint::from_bytes(&huge);
        }
    }
}
