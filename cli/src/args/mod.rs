//! The options and commands of the command line, as clap parses them.

mod bench;
mod cli;
mod fields;
mod form;
mod movable;
pub(crate) mod names;
pub(crate) mod parse;
mod picture;
mod quality;
mod read;
mod sliding;
mod smooth;
pub(crate) mod table;
mod target;
mod trial;

pub(crate) use bench::BenchArgs;
pub(crate) use cli::{
    AdaptersArgs, Cli, Command, CompareArgs, CompletionsArgs, ConvertArgs, GroupsArgs, LogForm,
    ManArgs, OutputArgs, command,
};
pub(crate) use fields::FieldArgs;
pub(crate) use form::FormArgs;
pub(crate) use movable::{MoveArgs, Quadrilaterals};
pub(crate) use picture::PictureArgs;
pub(crate) use quality::QualityArgs;
pub(crate) use read::ReadArgs;
pub(crate) use sliding::SideArgs;
pub(crate) use smooth::SmoothArgs;
pub(crate) use target::{Target, TargetArgs};
pub(crate) use trial::TryArgs;
