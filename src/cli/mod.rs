//! The program: commands, what they print, and the files they write (PROTOCOL).

/// A line on standard output. Whoever reads may stop reading.
macro_rules! say {
    ($($text:tt)*) => { crate::cli::say(format_args!($($text)*)) };
}

mod advise;
pub mod arguments;
mod bake;
mod compare;
mod demonstration;
mod experiment;
mod files;
mod inspect;
mod measure;
mod occluders;
mod pictures;
mod preset;
mod progress;
mod setting;
mod stability;
mod walk;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use crate::error::Result;
use arguments::{Arguments, Command};

/// Runs the program. Exit status: 0 done; 2 bad usage or input, with one line on stderr.
pub fn run(args: impl Iterator<Item = OsString>) -> ExitCode {
    let arguments = match arguments::parse(args) {
        Ok(arguments) => arguments,
        Err(exit) if exit.to_stdout => {
            say!("{}", exit.message);
            return ExitCode::from(exit.code);
        }
        Err(exit) => {
            eprintln!("{}", exit.message);
            return ExitCode::from(exit.code);
        }
    };
    match execute(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("homcull: {}", error.to_string().replace('\n', " "));
            ExitCode::from(2)
        }
    }
}

fn say(line: std::fmt::Arguments<'_>) {
    if let Err(error) = writeln!(std::io::stdout().lock(), "{line}") {
        if error.kind() != std::io::ErrorKind::BrokenPipe {
            eprintln!("homcull: standard output: {error}");
        }
        std::process::exit(if error.kind() == std::io::ErrorKind::BrokenPipe { 0 } else { 2 });
    }
}

fn execute(arguments: &Arguments) -> Result<()> {
    let options = &arguments.options;
    match &arguments.command {
        None => demonstration::run(options),
        Some(Command::Walk { scene, methods }) => walk::run(scene, methods, options),
        Some(Command::Measure { kernel, scene, cluster_test, depth }) => {
            measure::run(*kernel, scene, cluster_test.is_on(), *depth, options)
        }
        Some(Command::Bake { scene, bake }) => bake::run(scene, bake, options),
        Some(Command::Inspect { scene, occluders: true }) => occluders::run(scene, options),
        Some(Command::Inspect { scene, .. }) => inspect::scene(scene, options),
        Some(Command::Experiment { name, scene }) => experiment::run(name.as_deref(), scene.as_deref(), options),
        Some(Command::Compare { scene }) => compare::run(scene, options),
        Some(Command::Advise { scene }) => advise::run(scene, options),
        Some(Command::Scenes) => inspect::generators(),
        Some(Command::Methods) => inspect::methods(),
        Some(Command::Stability) => stability::run(options),
    }
}
