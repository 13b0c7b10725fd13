//! The thesis' Monte Carlo, refits of a coefficient of friction, over the ranks of MPI or over files, with the bits of
//! a single process.
//!
//! ```text
//! cargo build --release
//! target/release/monte-carlo-mpi                                        one process
//! mpirun -n 2 target/release/monte-carlo-mpi                            the same bits from two ranks
//! target/release/monte-carlo-mpi --part 0/2 --into a.json               the same without MPI: two jobs,
//! target/release/monte-carlo-mpi --part 1/2 --into b.json
//! target/release/monte-carlo-mpi --merge b.json a.json                  and one that puts them together
//! ```
//!
//! Every rank runs its share of the blocks of trials and sends a [`PartialRun`] to rank 0, which merges them. What is
//! measured stands in `model.rs`. Building needs an MPI library and libclang; on Debian these are the packages
//! `openmpi-bin`, `libopenmpi-dev` and `libclang-dev`.

mod model;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use clap::Parser;
use fmm_uq::{MonteCarlo, OutputSample, PartialRun};
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Source};

/// Runs a Monte Carlo over the ranks of MPI.
#[derive(Debug, Parser)]
#[command(name = "monte-carlo-mpi")]
struct Arguments {
    /// Number of trials
    #[arg(long, default_value_t = 1_000_000)]
    trials: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Run one part only, without MPI, such as 0/2
    #[arg(long, value_name = "K/N", requires = "into", conflicts_with = "merge")]
    part: Option<Part>,
    /// Where that part goes
    #[arg(long, value_name = "FILE", requires = "part")]
    into: Option<PathBuf>,
    /// Merge parts from files, in any order
    #[arg(long, value_name = "FILES", num_args = 1..)]
    merge: Vec<PathBuf>,
}

/// One of several parts, counted from 0.
#[derive(Debug, Clone, Copy)]
struct Part {
    index: u64,
    of: u64,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, of)) if index < of => Ok(Self { index, of }),
            _ => Err(format!("a part is K/N with K from 0 to N - 1, such as 0/2, but not {text}")),
        }
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let plan = MonteCarlo::new(&model::inputs()?, arguments.trials)?.with_seed(arguments.seed);
    if let (Some(part), Some(path)) = (arguments.part, &arguments.into) {
        let partial = plan.run_blocks(plan.shard(part.index, part.of), model::evaluate)?;
        let text = serde_json::to_string(&partial)?;
        return fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()).into());
    }
    let merged = if arguments.merge.is_empty() {
        match over_ranks(&plan)? {
            Some(merged) => merged,
            None => return Ok(()),
        }
    } else {
        merge(arguments.merge.iter().map(|path| read(path)))?
    };
    let start = Instant::now();
    let sample = plan.finish(merged)?;
    print(&sample)?;
    eprintln!("pooled, sorted and printed in {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    Ok(())
}

/// All parts in one on rank 0, and nothing on the others.
fn over_ranks(plan: &MonteCarlo) -> Result<Option<PartialRun>, Box<dyn Error>> {
    let universe = mpi::initialize().ok_or("MPI cannot be started")?;
    let world = universe.world();
    let (rank, ranks) = (world.rank(), world.size());
    let parts = u64::try_from(ranks)?;
    world.barrier();
    let start = Instant::now();
    let own = plan.run_blocks(plan.shard(u64::try_from(rank)?, parts), model::evaluate);
    let seconds = start.elapsed().as_secs_f64();
    if rank != 0 {
        // A rank whose trials failed says so, instead of leaving the others waiting.
        let own = own.map_err(|error| error.to_string());
        world.process_at_rank(0).send(&serde_json::to_vec(&own)?);
        return Ok(None);
    }
    let start = Instant::now();
    let mut bytes = 0;
    let others = (1..ranks).map(|rank| {
        let (message, _) = world.process_at_rank(rank).receive_vec::<u8>();
        bytes += message.len();
        Ok(serde_json::from_slice::<Result<PartialRun, String>>(&message)??)
    });
    // All messages are received before an error ends this rank, so that no other one hangs.
    let others: Vec<Result<PartialRun, Box<dyn Error>>> = others.collect();
    let merged = merge(std::iter::once(own.map_err(Into::into)).chain(others))?;
    let waited = 1e3 * start.elapsed().as_secs_f64();
    eprintln!("{ranks} ranks: {seconds:.3} s on rank 0, then {bytes} bytes gathered and merged in {waited:.1} ms");
    Ok(Some(merged))
}

fn read(path: &Path) -> Result<PartialRun, Box<dyn Error>> {
    let text = fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    serde_json::from_str(&text).map_err(|error| format!("{} is no part: {error}", path.display()).into())
}

fn merge(parts: impl IntoIterator<Item = Result<PartialRun, Box<dyn Error>>>) -> Result<PartialRun, Box<dyn Error>> {
    let merged = parts.into_iter().reduce(|first, second| Ok(first?.merge(second?)?));
    merged.unwrap_or_else(|| Err("there is nothing to merge".into()))
}

/// The results, each with the hexadecimal digits of its bits, and a digest of all values.
fn print(sample: &OutputSample) -> Result<(), Box<dyn Error>> {
    println!("{} trials", sample.trials());
    for (output, (name, unit)) in model::OUTPUTS.iter().enumerate() {
        let interval = sample.symmetric_interval(output, 0.95)?;
        for (what, value) in [
            ("estimate", sample.estimate(output)?),
            ("standard uncertainty", sample.standard_uncertainty(output)?),
            ("95 % from", interval.low),
            ("95 % to", interval.high),
        ] {
            println!("{name:<14} {what:<21} {value:>22.15e} {unit:<2} {:016x}", value.to_bits());
        }
    }
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for output in 0..sample.outputs() {
        for byte in sample.values(output)?.iter().flat_map(|value| value.to_bits().to_le_bytes()) {
            digest = (digest ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    println!("all values     FNV-1a digest {digest:016x}");
    Ok(())
}
