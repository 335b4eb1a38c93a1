//! The program `homcull`.

use std::process::ExitCode;

fn main() -> ExitCode {
    homcull::cli::run(std::env::args_os())
}
