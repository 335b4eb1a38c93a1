//! What the user typed: the commands and options, by clap, with every bad value caught here.
//!
//! A usage error is one line on standard error that names the argument at fault, and status 2;
//! `--help` and `--version` go to standard output with status 0. Values are checked where they are
//! parsed (sizes, counts, names), so that what [`parse`] returns can be used as it is; scenes and
//! methods are strings still, for those who know them to judge.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::error::Error;
use crate::measure::bake::DEFAULT_SIDE;
use crate::measure::report_target::Target;

/// The longest side of a view, in pixels.
const MAX_SIDE: u64 = 16_384;

/// What this viewer can see, answered on the CPU.
///
/// Without a command: the demonstration, a walk through the city with every method that pays; its
/// report goes to the folder homcull-out.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "homcull", version, max_term_width = 100)]
pub struct Arguments {
    /// The command; none is the demonstration.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The options that all commands share.
    #[command(flatten)]
    pub options: Options,
}

/// The commands.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// Walk a camera path with one method or several, and compare them
    Walk {
        /// A model (.obj), a benchmark folder, a generator or a preset: NAME[:key=value,...]
        scene: String,
        /// A method, NAME[:key=value,...]; repeat it to compare several. When left out hom, or what the preset has
        #[arg(long = "method", value_name = "METHOD")]
        methods: Vec<String>,
    },
    /// Walk with every method, and with every knob that trades error for time: both beside each other, with a plot
    Compare {
        /// A model (.obj), a benchmark folder, or a generator: NAME[:key=value,...]
        scene: String,
    },
    /// Say what a scene needs and what to leave out, with the counts behind it
    Advise {
        /// A model (.obj), a benchmark folder, or a generator: NAME[:key=value,...]
        scene: String,
    },
    /// Measure one kernel alone
    Measure {
        /// The kernel
        #[arg(value_enum)]
        kernel: Kernel,
        /// A model (.obj), a benchmark folder, or a generator: NAME[:key=value,...]
        scene: String,
        /// Whether clusters of a mesh are dropped when they are hidden
        #[arg(long, value_name = "on|off", value_enum, default_value_t = Switch::On)]
        cluster_test: Switch,
        /// What stands for the occluders' depth
        #[arg(long, value_name = "DEPTH", value_enum, default_value_t = Depth::Nbz)]
        depth: Depth,
    },
    /// Find what is visible from the points of a grid, and write it to --out FILE, for hom:select=baked and pvs
    Bake {
        /// A model (.obj), a benchmark folder, or a generator: NAME[:key=value,...]
        scene: String,
        /// Where from, and how finely
        #[command(flatten)]
        bake: BakeArguments,
    },
    /// Make an experiment on a claim of the thesis; without a name, list them
    Experiment {
        /// Which
        name: Option<String>,
        /// A scene other than the experiment's own
        scene: Option<String>,
    },
    /// Show what a scene is made of
    Inspect {
        /// A model (.obj), a benchmark folder, or a generator: NAME[:key=value,...]
        scene: String,
        /// Which of its parts are closed, and how few triangles stand in for them as occluders
        #[arg(long)]
        occluders: bool,
    },
    /// List the scene generators and their parameters
    Scenes,
    /// List the culling methods and their parameters
    Methods,
    /// Run the table of stiff and extreme cases
    Stability,
}

impl Options {
    /// True when a report goes to standard output: then nothing else does.
    pub fn reports_to_stdout(&self) -> bool {
        [&self.json, &self.csv].into_iter().any(|target| matches!(target, Some(Target::Stdout)))
    }
}

/// The options of `bake`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct BakeArguments {
    /// View points along x, y and z
    #[arg(long, value_name = "XxYxZ", default_value = "20x10x20")]
    pub grid: String,
    /// The least corner of the grid's box, in metres; the scene's when left out
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub min: Option<String>,
    /// The greatest corner of the grid's box, in metres; the scene's when left out
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub max: Option<String>,
    /// Samples along the side of a cube's face
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SIDE, value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub face: u32,
    /// Near distance of the cube, in metres; a ten-thousandth of the scene's diagonal when left out
    #[arg(long, value_name = "METRES")]
    pub near: Option<f64>,
}

/// A kernel that `measure` measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kernel {
    /// Every object in the frustum, into a cleared buffer
    Raster,
    /// Building the pyramid of occlusion maps
    Pyramid,
    /// Testing every box against the full buffer
    Query,
    /// Nearest first: test the box, rasterize what is visible
    Progressive,
}

/// What stands for the occluders' depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Depth {
    /// The no-background Z-buffer, a depth a sample
    Nbz,
    /// The no-background Z-buffer, one farthest depth a block
    NbzBlock,
    /// The depth estimation buffer of 64x64 partitions; not with `progressive`
    Deb,
    /// The single plane; not with `progressive`
    Plane,
}

/// On or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// On
    On,
    /// Off
    Off,
}

/// A SIMD level that can be asked for; whether this CPU has it is another question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Simd {
    /// One sample after the other
    Scalar,
    /// 256 bits
    Avx2,
    /// 512 bits
    Avx512,
}

/// The options that all commands share; a command without use for one ignores it.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Options {
    /// The camera path, a JSON file; the scene's own when left out
    #[arg(long, global = true, value_name = "FILE")]
    pub path: Option<PathBuf>,
    /// Frames of the path; its own count when left out
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: Option<u32>,
    /// The view in pixels; 1280x1024 when left out, for measure the views' own
    #[arg(long, global = true, value_name = "WxH", value_parser = Size::parse)]
    pub size: Option<Size>,
    /// Threads to work with
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// The SIMD level; the best of this CPU when left out
    #[arg(long, global = true, value_name = "LEVEL", value_enum)]
    pub simd: Option<Simd>,
    /// Write the report as JSON to a file, or to standard output (-)
    #[arg(long, global = true, value_name = "FILE|-", value_parser = target)]
    pub json: Option<Target>,
    /// Write every frame as comma-separated values to a file, or to standard output (-)
    #[arg(long, global = true, value_name = "FILE|-", value_parser = target)]
    pub csv: Option<Target>,
    /// The folder for plots and pictures; for bake, the file to write
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Frames to write as pictures, spread evenly over the path
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub images: Option<u32>,
    /// No progress and no table
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Leave out the exact reference, and with it all errors
    #[arg(long, global = true)]
    pub no_exact: bool,
    /// How often to repeat what is timed; the fastest counts
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub repetitions: Option<u32>,
}

/// A view's size in pixels, each side 1 to 16384.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

/// How the program ends when there is nothing more to do: help, version, or bad usage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exit {
    /// The exit status: 0 for help and version, 2 for bad usage.
    pub code: u8,
    /// What to print, without the last line end; a single line for bad usage.
    pub message: String,
    /// Whether it belongs on standard output rather than standard error.
    pub to_stdout: bool,
}

/// Reads the arguments, the program's name first.
///
/// # Errors
///
/// [`Exit`] for bad usage, and for `--help` and `--version`, which are no errors but end here too.
pub fn parse(args: impl Iterator<Item = OsString>) -> Result<Arguments, Exit> {
    Arguments::try_parse_from(args).map_err(|error| {
        let text = error.render().to_string();
        match error.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
                Exit { code: 0, message: text.trim_end().to_string(), to_stdout: true }
            }
            _ => Exit { code: 2, message: one_line(&text), to_stdout: false },
        }
    })
}

impl Arguments {
    /// The size asked for, or 1280x1024, the default of everything but `measure`.
    pub fn size_or_default(&self) -> Size {
        self.options.size.unwrap_or(Size::DEFAULT)
    }
}

impl Switch {
    /// Whether it is on.
    pub fn is_on(self) -> bool {
        self == Switch::On
    }
}

impl Simd {
    /// The level as the user writes it.
    pub fn name(self) -> &'static str {
        match self {
            Simd::Scalar => "scalar",
            Simd::Avx2 => "avx2",
            Simd::Avx512 => "avx512",
        }
    }
}

impl Size {
    /// The size of the thesis' experiments, 1280x1024.
    pub const DEFAULT: Size = Size { width: 1280, height: 1024 };

    /// Reads `1280x1024`.
    ///
    /// # Errors
    ///
    /// [`Error::Size`] for a side of 0 or beyond 16384, [`Error::Parameter`] for what is no size.
    pub fn parse(text: &str) -> Result<Size, Error> {
        let side = |text: &str| {
            let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            // Only a number of more than 64 bits can fail to parse, and that is too large.
            digits.then(|| text.parse::<u64>().unwrap_or(u64::MAX))
        };
        let sides = text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let Some((width, height)) = sides else {
            return Err(Error::parameter("size", text, "must be WIDTHxHEIGHT, as 1280x1024"));
        };
        let checked = |side: u64| u32::try_from(side).ok().filter(|_| (1..=MAX_SIDE).contains(&side));
        match (checked(width), checked(height)) {
            (Some(width), Some(height)) => Ok(Size { width, height }),
            _ => Err(Error::Size { width, height }),
        }
    }

    /// A size; `None` for a side of 0 or beyond 16384.
    pub fn new(width: u32, height: u32) -> Option<Size> {
        let fits = |side: u32| (1..=MAX_SIDE).contains(&u64::from(side));
        (fits(width) && fits(height)).then_some(Size { width, height })
    }

    /// Width in pixels, 1 to 16384.
    pub fn width(self) -> u32 {
        self.width
    }

    /// Height in pixels, 1 to 16384.
    pub fn height(self) -> u32 {
        self.height
    }
}

fn target(text: &str) -> Result<Target, std::convert::Infallible> {
    Ok(Target::parse(text))
}

/// clap's message on one line: without its usage and its advice on `--`, its `error: ` replaced by
/// the program's name, other tips in brackets.
fn one_line(text: &str) -> String {
    let end = |line: &&str| !line.starts_with("Usage:") && !line.starts_with("For more information");
    let mut message = String::from("homcull:");
    for line in text.lines().take_while(end) {
        let words = line.split_whitespace().collect::<Vec<&str>>().join(" ");
        let words = words.strip_prefix("error: ").unwrap_or(&words);
        match words.strip_prefix("tip: ") {
            Some(tip) if tip.starts_with("to pass") => {}
            Some(tip) => message.extend([" (", tip, ")"]),
            None if words.is_empty() => {}
            None => message.extend([" ", words]),
        }
    }
    message.chars().map(|letter| if letter.is_control() { '?' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> Result<Arguments, Exit> {
        parse(line.split(' ').map(OsString::from))
    }

    #[test]
    fn the_definition_is_sound() {
        <Arguments as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn no_command_is_the_demonstration() {
        let arguments = parsed("homcull").unwrap();
        assert_eq!((&arguments.command, &arguments.options), (&None, &Options::default()));
        assert_eq!(arguments.size_or_default(), Size { width: 1280, height: 1024 });
    }

    #[test]
    fn options_stand_before_or_after_the_command() {
        let after = parsed("homcull walk city --method vfc --method hom:depth=nbz --json - --quiet").unwrap();
        let before = parsed("homcull --json - --quiet walk city --method vfc --method hom:depth=nbz").unwrap();
        assert_eq!(after, before);
        assert_eq!(after.options.json, Some(Target::Stdout));
        let methods = vec!["vfc".to_string(), "hom:depth=nbz".to_string()];
        assert_eq!(after.command, Some(Command::Walk { scene: "city".into(), methods }));
    }

    #[test]
    fn measure_takes_its_own_options() {
        let arguments = parsed("homcull measure raster s --cluster-test off --depth nbz-block").unwrap();
        let expected = Command::Measure {
            kernel: Kernel::Raster,
            scene: "s".into(),
            cluster_test: Switch::Off,
            depth: Depth::NbzBlock,
        };
        assert_eq!((arguments.command, arguments.options.size), (Some(expected), None));
    }

    #[test]
    fn sizes_are_typed_errors() {
        assert_eq!(Size::parse("1x16384"), Ok(Size { width: 1, height: 16384 }));
        for (text, width, height) in [("0x5", 0, 5), ("16385x1", 16385, 1), ("5x99999999999999999999", 5, u64::MAX)] {
            assert_eq!(Size::parse(text), Err(Error::Size { width, height }), "{text}");
        }
        for text in ["", "x", "5", "5x", "-1x5", "+1x5", "5x5x5", "5 x5", "axb"] {
            assert!(matches!(Size::parse(text), Err(Error::Parameter { .. })), "{text}");
        }
    }
}
