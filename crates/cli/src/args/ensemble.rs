//! Options of `equip ensemble` and `equip merge`.

use super::shared::{Problem, Span, Stepping, whole};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(
    after_help = "What is drawn: every component x of the scene's start, of q and of p, becomes x (1 + spread u), with u uniform in \
        [-1, 1) and its own for each component; components that are zero stay so. u comes from the seed and the number \
        of the member alone (ChaCha8, one stream a member), never from shard, thread or machine.\n\n\
        FILE.csv has one line of the options, then `member`, the start, the end, what was kept, and a checksum of every member. A \
        member that fails is a row of NaN with its reason, and does not end the program. While the program runs, rows \
        stand in the order in which they are finished, at the end in that of the members. The same command with the \
        same FILE makes what is missing. The bytes do not depend on threads, on interruptions, or on shards that \
        `equip merge` puts together.\n\n\
        Exit codes: 0 all members are in the file; 1 the output failed; 2 bad usage or input; 128 + n ended by signal n, \
        with all finished members in the file.\n\n\
        Examples:\n  \
        equip ensemble henon-heiles --n 1000 --seed 7 --until 200 --tolerance 1e-12 --out hh.csv\n  \
        equip ensemble kepler --e 0.3 --n 100000 --seed 1 --spread 1e-3 --shard 2/4 --out kepler-2.csv\n  \
        equip merge kepler-1.csv kepler-2.csv kepler-3.csv kepler-4.csv --out kepler.csv"
)]
pub(crate) struct EnsembleArgs {
    #[command(flatten)]
    pub(crate) problem: Problem,
    /// Number of members, of all shards together
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, u32::MAX.into()))]
    pub(crate) n: u64,
    /// Seed of the starts, a whole number
    #[arg(long, value_name = "SEED", default_value_t = 0, allow_negative_numbers = true, value_parser = whole(0, u64::MAX))]
    pub(crate) seed: u64,
    /// Relative size of what is drawn: how far a component of the start is moved at most, in units of itself
    #[arg(
        long,
        value_name = "SPREAD",
        default_value = "0.01",
        allow_hyphen_values = true
    )]
    pub(crate) spread: String,
    /// Make the K-th of COUNT equal shares of the members only, K from 1
    #[arg(long, value_name = "K/COUNT", default_value = "1/1", allow_hyphen_values = true, value_parser = shard)]
    pub(crate) shard: Shard,
    /// Threads; all of the machine if not given
    #[arg(long, value_name = "THREADS", allow_negative_numbers = true, value_parser = whole(1, 4096))]
    pub(crate) threads: Option<u64>,
    #[command(flatten)]
    pub(crate) stepping: Stepping,
    #[command(flatten)]
    pub(crate) span: Span,
    /// Where the members are written; if the file is there, what is missing in it is made
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) out: PathBuf,
    /// Print nothing
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The shards must be those of one ensemble, each once and finished: the file is then, byte for byte, that of one \
        program without --shard.\n\n\
        Examples:\n  \
        equip merge part-*.csv --out all.csv"
)]
pub(crate) struct MergeArgs {
    /// Files that `equip ensemble` wrote, in any order
    #[arg(required = true, value_name = "FILES")]
    pub(crate) files: Vec<PathBuf>,
    /// Where all members are written, in their order
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) out: PathBuf,
    /// Print nothing
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

/// One of `count` equal shares of the members, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    pub(crate) number: u64,
    pub(crate) count: u64,
}

fn shard(text: &str) -> Result<Shard, String> {
    let read = |text: &str| text.trim().parse::<u64>().ok();
    let given = text
        .split_once('/')
        .and_then(|(number, count)| Some((read(number)?, read(count)?)));
    match given {
        Some((_, 0)) | None => Err("write it as K/COUNT, like 2/4".into()),
        Some((number, count)) if (1..=count).contains(&number) => Ok(Shard { number, count }),
        Some((_, count)) => Err(format!("there are shards 1/{count} to {count}/{count}")),
    }
}

#[cfg(test)]
mod tests {
    use super::{Shard, shard};

    #[test]
    fn shards() {
        let last = Shard {
            number: 4,
            count: 4,
        };
        assert_eq!(shard("4/4"), Ok(last));
        for wrong in ["0/4", "5/4", "4", "1/0", "-1/4", "a/b", ""] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
    }
}
