//! Check that a checkpoint belongs to the run that continues from it.

use std::ops::Range;

use glam::DVec2;

use crate::error::{ResumeError, SmoothError};
use crate::layout::Problem;
use crate::mesh::Mesh;
use crate::options::Options;
use crate::parallel::paced;
use crate::run::{Checkpoint, PeriodState, RunFingerprint};

/// Returns the description of a run that its checkpoints carry: a hash of the mesh, of the target maps of its vertices
/// and of `more` data that the run depends on, and the options as lines of text.
pub(crate) async fn about(
    mesh: &Mesh,
    targets: Option<&[[f32; 3]]>,
    more: &[u64],
    options: &Options,
) -> RunFingerprint {
    RunFingerprint {
        mesh: hash(mesh, targets, more).await,
        options: options.lines(),
        goal: None,
        opened: None,
        on_cpu_from: None,
    }
}

/// Checks that a checkpoint comes from a run with equal options on the same mesh, whose layout is `problem`. Fails with
/// [`SmoothError::Checkpoint`].
pub(crate) fn check(
    own: &RunFingerprint,
    checkpoint: &Checkpoint,
    problem: &Problem,
) -> Result<(), SmoothError> {
    let vertices = problem.positions().len();
    let fits = |points: &[DVec2]| points.len() == vertices && points.iter().all(|p| p.is_finite());
    let Checkpoint { about, saved, period } = checkpoint;
    let is_whole = about.opened.as_ref().is_none_or(|opened| {
        !opened.log.is_empty() && fits(&opened.positions) && fits(&opened.best)
    });
    let is_of_stages = period.as_ref().is_none_or(|period| {
        let PeriodState { began, before, f_before, .. } = period;
        fits(before) && (*began as usize) < saved.log.len() && f_before.is_finite()
    });
    let is_whole = is_whole && about.on_cpu_from.is_none_or(|from| from <= saved.sweeps());
    if own.mesh != about.mesh || !is_whole || !is_of_stages {
        return Err(foreign());
    }
    difference(&about.options, &own.options).map_or(Ok(()), |error| Err(error.into()))
}

/// Returns the first option in which a checkpoint differs from the run that continues. Both texts have a line `name = value`
/// for each option. A checkpoint of another version of the library may have other options. An option that the checkpoint lacks
/// had its default, as the library of the checkpoint did not have the option.
fn difference(checkpoint: &str, run: &str) -> Option<ResumeError> {
    fn name(line: &str) -> &str {
        line.split(" = ").next().unwrap_or(line)
    }
    let defaults = Options::default().lines();
    for now in run.lines() {
        let mut all = checkpoint.lines().chain(defaults.lines());
        if let Some(then) = all.find(|then| name(then) == name(now)).filter(|then| *then != now) {
            let (then, now) = (then.to_owned(), now.to_owned());
            return Some(ResumeError::OtherOption { then, now });
        }
    }
    let unknown = checkpoint.lines().find(|then| run.lines().all(|now| name(now) != name(then)))?;
    Some(ResumeError::UnknownOption { then: unknown.to_owned() })
}

/// Returns the error for a checkpoint of another mesh.
pub(crate) fn foreign() -> SmoothError {
    ResumeError::OtherMesh.into()
}

/// Returns the hash of all data of a mesh that a run depends on.
async fn hash(mesh: &Mesh, targets: Option<&[[f32; 3]]>, more: &[u64]) -> u64 {
    let Mesh { points, triangles, quadrilaterals, fixed } = mesh;
    let targets = targets.unwrap_or_default();
    let counts = [points.len(), triangles.len(), quadrilaterals.len(), fixed.len()];
    let lists = [
        of_list(points.as_flattened(), |x| x.to_bits()).await,
        of_list(triangles.as_flattened(), |&i| i.into()).await,
        of_list(quadrilaterals.as_flattened(), |&i| i.into()).await,
        of_list(fixed, |&i| i.into()).await,
        of_list(targets.as_flattened(), |x| x.to_bits().into()).await,
    ];
    let words = counts.into_iter().map(|count| count as u64).chain(lists);
    words.chain(more.iter().copied()).fold(SEED, mixed)
}

/// Returns the hash of a list. Parts of the list are hashed in parallel.
async fn of_list<T: Sync>(items: &[T], word: impl Fn(&T) -> u64 + Sync + Send) -> u64 {
    const CHUNK: usize = 1 << 14;
    let of_range = |range: Range<usize>| items[range].iter().map(&word).fold(SEED, mixed);
    paced::map_ranges(items.len(), CHUNK, of_range).await.into_iter().fold(SEED, mixed)
}

/// Hash of an empty list: the offset basis of FNV-1a.
const SEED: u64 = 0xcbf2_9ce4_8422_2325;

/// Returns the hash of a list with a further word: FNV-1a over words of 64 bits.
fn mixed(hash: u64, word: u64) -> u64 {
    let mixed = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    mixed ^ (mixed >> 32)
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::parallel::pace::now;
    use crate::run::checksum::crc32;
    use crate::run::{CheckpointPolicy, Stop};
    use crate::{Backend, GpuError, Guard, Outcome, Quality, Slide, Smoother, topology};

    /// A policy that takes the first checkpoint, and continues on the CPU if asked.
    #[derive(Default)]
    struct First {
        checkpoint: Option<Checkpoint>,
        goes_on: bool,
        told: Vec<GpuError>,
    }

    impl CheckpointPolicy for First {
        fn wants_checkpoint(&mut self, _: bool) -> bool {
            self.checkpoint.is_none()
        }

        fn checkpoint(&mut self, checkpoint: Checkpoint) {
            self.checkpoint = Some(checkpoint);
        }

        fn falls_back_to_cpu(&mut self, error: &GpuError, _: u32) -> bool {
            self.told.push(error.clone());
            self.goes_on
        }
    }

    /// Returns a lattice of squares cut in two, with its inner vertices moved.
    fn lattice(n: u32) -> Mesh {
        let mut points = Vec::new();
        for (row, column) in (0..=n).flat_map(|row| (0..=n).map(move |column| (row, column))) {
            let is_inner = |i| 0 < i && i < n;
            let away = if is_inner(row) && is_inner(column) { 0.3 } else { 0.0 };
            let wave = f64::from(7 * row + 3 * column).sin();
            points.push([f64::from(column) + away * wave, f64::from(row) - away * wave]);
        }
        let of_square = |(row, column)| {
            let a = row * (n + 1) + column;
            [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
        };
        let squares = (0..n).flat_map(|row| (0..n).map(move |column| (row, column)));
        Mesh { points, triangles: squares.flat_map(of_square).collect(), ..Mesh::default() }
    }

    /// Returns the CPU backend and, with the feature `gpu`, the default device.
    fn backends() -> Vec<Backend> {
        Vec::from([
            Backend::Cpu,
            #[cfg(feature = "gpu")]
            Backend::Gpu(crate::Gpu::open(None).block().unwrap()),
        ])
    }

    /// The checkpoint contains a position that overflows, as if memory had failed. The run undoes the sweep that
    /// reveals the error, and the returned mesh is no worse than before the run.
    #[test]
    fn a_sweep_that_makes_a_number_that_is_not_finite_is_undone() {
        let mesh = lattice(12);
        let smoother = Smoother::new(&mesh).unwrap();
        let of_each = |backend| ["imr", "edge+imr"].map(|scheme| (backend, scheme));
        for (backend, scheme) in backends().iter().flat_map(of_each) {
            let options = Options { scheme: scheme.parse().unwrap(), ..Options::default() };
            let mut first = First::default();
            let whole = smoother.run(&options).on(backend).checkpoints(&mut first).block().unwrap();
            let mut spoiled = first.checkpoint.clone().unwrap();
            let engine = &mut spoiled.saved.engine;
            engine.positions[0].x = 1e200;
            for (name, bytes) in &mut engine.own.0 {
                if name == "positions" {
                    bytes[..4].copy_from_slice(&3e38_f32.to_le_bytes());
                }
            }
            let check = |outcome: &Outcome| {
                let bad = topology::infeasible(&outcome.points, &mesh.triangles).unwrap();
                assert!(bad.is_empty(), "{bad:?}");
                let f = |p| Quality::of(p, smoother.topology()).unwrap().f(options.scheme.base());
                assert!(f(&outcome.points) <= f(&mesh.points), "{scheme}");
            };
            let from = Some(&spoiled);
            let outcome = smoother
                .run(&options)
                .on(backend)
                .resume(from)
                .checkpoints(&mut first)
                .block()
                .unwrap();
            assert_eq!(outcome.stop, Stop::NotFinite, "{scheme}");
            check(&outcome);
            assert!(outcome.sweeps < whole.sweeps);
            if !matches!(backend, Backend::Cpu) {
                assert!(matches!(first.told[..], [GpuError::NotFinite { .. }]), "{:?}", first.told);
            }
        }
    }

    /// Bytes with a correct checksum that are no valid checkpoint are refused, or the run ends with a sound mesh.
    #[test]
    fn a_hostile_checkpoint_does_no_harm() {
        let mesh = lattice(6);
        let mut smoother = Smoother::new(&mesh).unwrap();
        let mut state = 1_u64;
        let (mut refused, mut went_on) = (0, 0);
        let mut random = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        let of_each = |backend| {
            [("imr", false), ("edge+imr", false), ("imr", true)].map(|case| (backend, case))
        };
        for (backend, (scheme, slides)) in backends().iter().flat_map(of_each) {
            let slide = slides.then(Slide::default);
            smoother.set_slide(slide.as_ref()).unwrap();
            let rounds = if matches!(backend, Backend::Cpu) { 150 } else { 12 };
            let options =
                Options { scheme: scheme.parse().unwrap(), max_sweeps: 30, ..Options::default() };
            let mut kept = Latest::default();
            smoother.run(&options).on(backend).checkpoints(&mut kept).block().unwrap();
            let bytes = kept.0.unwrap().to_bytes();
            for _ in 0..rounds {
                let mut hostile = bytes[..bytes.len() - 4].to_vec();
                for _ in 0..=random(2) {
                    let word = [
                        0,
                        1,
                        7,
                        u32::MAX.into(),
                        u64::MAX,
                        f64::NAN.to_bits(),
                        1e300_f64.to_bits(),
                        1 << 40,
                    ][random(8)];
                    // Half of the changes hit the bytes before the long lists.
                    let most = if random(2) == 0 { hostile.len() } else { hostile.len().min(3000) };
                    let at = random(most - 8);
                    hostile[at..at + 8].copy_from_slice(&word.to_le_bytes());
                }
                let sum = crc32(&hostile);
                hostile.extend(sum.to_le_bytes());
                let Ok(from) = Checkpoint::from_bytes(&hostile) else {
                    refused += 1;
                    continue;
                };
                let mut none = Latest::default();
                match smoother
                    .run(&options)
                    .on(backend)
                    .resume(&from)
                    .checkpoints(&mut none)
                    .block()
                {
                    Ok(outcome) => {
                        let bad = topology::infeasible(&outcome.points, &mesh.triangles).unwrap();
                        assert!(bad.is_empty(), "{bad:?}");
                        went_on += 1;
                    }
                    Err(SmoothError::Checkpoint(_)) => refused += 1,
                    Err(error) => panic!("{error}"),
                }
            }
        }
        assert!(refused > 50 && went_on > 50, "{refused} refused, {went_on} went on");
    }

    /// If the device's last sweep came after the checkpoint, sweeps of the CPU would count from a sweep that the
    /// checkpoint lacks.
    #[test]
    fn a_checkpoint_whose_cpu_took_over_after_the_last_sweep_is_refused() {
        let mesh = lattice(6);
        let mut smoother = Smoother::new(&mesh).unwrap();
        smoother.set_slide(Some(&Slide::default())).unwrap();
        let mut kept = Latest::default();
        let options = Options::default();
        smoother.run(&options).checkpoints(&mut kept).block().unwrap();
        let mut checkpoint = kept.0.unwrap();
        checkpoint.about.on_cpu_from = Some(checkpoint.saved.sweeps() + 1);
        let error = smoother.run(&options).resume(&checkpoint).block().unwrap_err();
        assert!(matches!(error, SmoothError::Checkpoint(_)), "{error}");
    }

    /// A checkpoint of an earlier version of the library lacks the options that came later.
    #[test]
    fn an_option_that_a_checkpoint_lacks_had_its_default() {
        let of = |guard| Options::default().guard(guard).lines();
        let earlier = Options::default().lines().replace("guard = by-metric\n", "");
        assert_eq!(difference(&earlier, &of(Guard::ByMetric)), None);
        let then = "guard = by-metric".to_owned();
        let now = "guard = worst".to_owned();
        let other = ResumeError::OtherOption { then, now };
        assert_eq!(difference(&earlier, &of(Guard::Worst)), Some(other));
    }

    /// A checkpoint of another version of the library may have more options or other values.
    #[test]
    fn the_error_on_other_options_in_a_checkpoint_names_the_option() {
        let mesh = lattice(6);
        let smoother = Smoother::new(&mesh).unwrap();
        let mut kept = Latest::default();
        let options = Options::default();
        smoother.run(&options).checkpoints(&mut kept).block().unwrap();
        let checkpoint = kept.0.unwrap();
        let own = &checkpoint.about.options;
        for (changed, part) in [
            (format!("{own}\nsmoothness = 2"), "has smoothness = 2, an option that this version"),
            (own.replace("max sweeps = 1000", "max sweeps = 7"), "has max sweeps = 7, and this"),
        ] {
            let mut other = checkpoint.clone();
            other.about.options = changed;
            let error = smoother.run(&options).resume(&other).block().unwrap_err();
            let SmoothError::Checkpoint(error) = error else { panic!("{error}") };
            let text = error.to_string();
            assert!(text.contains(part), "{part} is not in: {text}");
        }
    }

    /// A policy that keeps the latest checkpoint.
    #[derive(Default)]
    struct Latest(Option<Checkpoint>);

    impl CheckpointPolicy for Latest {
        fn wants_checkpoint(&mut self, _: bool) -> bool {
            true
        }

        fn checkpoint(&mut self, checkpoint: Checkpoint) {
            self.0 = Some(checkpoint);
        }
    }

    #[test]
    fn any_change_of_a_mesh_changes_its_hash() {
        let mesh = Mesh {
            points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            quadrilaterals: vec![[0, 1, 2, 3]],
            fixed: vec![2],
        };
        let changes: [fn(&mut Mesh); 7] = [
            |mesh| mesh.points[3][1] += f64::EPSILON,
            |mesh| mesh.points[0][0] = -0.0,
            |mesh| mesh.triangles[1] = [2, 3, 0],
            |mesh| mesh.quadrilaterals[0] = [1, 2, 3, 0],
            |mesh| {
                mesh.quadrilaterals.clear();
                mesh.fixed.splice(..0, [0, 1, 2, 3]);
            },
            |mesh| mesh.fixed[0] = 1,
            |mesh| mesh.fixed.clear(),
        ];
        let targets = [[1.0, 0.0, 1.0]; 4];
        let hash = |mesh: &Mesh, targets| now(super::hash(mesh, targets, &[]));
        let mut hashes = vec![hash(&mesh, None), hash(&mesh, Some(&targets[..]))];
        for change in changes {
            let mut changed = mesh.clone();
            change(&mut changed);
            hashes.push(hash(&changed, None));
        }
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), 9);
    }
}
