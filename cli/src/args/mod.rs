//! The options and commands of the command line, as clap parses them.

mod bench;
mod cli;
mod fields;
mod movable;
pub(crate) mod names;
pub(crate) mod parse;
mod picture;
mod quality;
mod read;
mod sliding;
mod smooth;
mod surface;
mod target;
mod trial;
mod worst;

pub(crate) use bench::BenchArgs;
pub(crate) use cli::{
    AdaptersArgs, Cli, Command, CompareArgs, CompletionsArgs, ConvertArgs, GroupsArgs, LogForm,
    ManArgs, OutputArgs,
};
pub(crate) use fields::FieldArgs;
pub(crate) use movable::MoveArgs;
pub(crate) use parse::Desired;
pub(crate) use picture::PictureArgs;
pub(crate) use quality::{QualityArgs, Threshold};
pub(crate) use read::ReadArgs;
pub(crate) use sliding::SlideArgs;
pub(crate) use smooth::{
    DerivativesChoice, EdgeNorm, EngineChoice, GuardChoice, History, MethodChoice, SmoothArgs,
};
pub(crate) use surface::{SurfaceArg, SurfaceArgs, ZArg};
pub(crate) use target::{Owner, Target, TargetArgs};
pub(crate) use trial::TryArgs;
pub(crate) use worst::{WorstArgs, WorstChoice};
