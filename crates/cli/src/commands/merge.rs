//! `equip merge`: the shards of an ensemble as one file.

use crate::args::MergeArgs;
use crate::fault::Fault;
use crate::write::checkpoint::unfinished;
use crate::write::lock;
use crate::write::members::{self, Head, Members};
use crate::write::outputs::{apart, ordinary};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Write, stdout};
use std::path::Path;

pub(crate) fn merge(args: &MergeArgs) -> Result<(), Fault> {
    ordinary("--out", &args.out)?;
    let new = unfinished(&args.out);
    ordinary("--out, while it is written,", &new)?;
    let mut shards: BTreeMap<u64, (&Path, Members)> = BTreeMap::new();
    for path in &args.files {
        apart(&[
            ("a shard", Some(path)),
            ("--out", Some(&args.out)),
            ("--out, while it is written,", Some(&new)),
        ])?;
        let found = read(path)?;
        let one = shards.values().next();
        if let Some((first, one)) = one {
            alike(first, one, path, &found)?;
        }
        let number = found.head.shard.0;
        if let Some((before, _)) = shards.insert(number, (path, found)) {
            return Err(Fault::ShardTwice {
                number,
                paths: (before.to_owned(), path.clone()),
            });
        }
    }
    let Some((_, one)) = shards.values().next() else {
        return Ok(());
    };
    let (head, count) = (one.head.whole(), one.head.shard.1);
    let missing: Vec<_> = (1..=count)
        .filter(|number| !shards.contains_key(number))
        .map(|number| format!("{number}/{count}"))
        .collect();
    if !missing.is_empty() {
        let shards = missing.join(", ");
        return Err(Fault::ShardsMissing { shards });
    }
    // An ensemble that is being made there keeps its file, and so does whatever is not this ensemble.
    if new.exists() {
        own(&new, &head)?;
    }
    let lock = args.out.exists().then(|| own(&args.out, &head));
    let _lock = lock.transpose()?;
    let rows = shards.values().flat_map(|(_, found)| found.rows.values());
    members::write(&args.out, &head, rows)?;
    if !args.quiet {
        let mut out = stdout().lock();
        writeln!(out, "{:<24}{}", "members", head.n)?;
        writeln!(out, "{:<24}{count}", "shards")?;
        writeln!(out, "{:<24}{}", "members written to", args.out.display())?;
    }
    Ok(())
}

/// The file, locked, if that of the whole ensemble may take its place: it is empty, or has members of it.
fn own(path: &Path, head: &Head) -> Result<File, Fault> {
    let mut file = lock::reopen(path)?;
    let length = file.metadata().map_err(|e| lock::unwritten(path, e))?.len();
    if length == 0 {
        return Ok(file);
    }
    let found = members::read(path, &mut file)?;
    match found.head.difference(head) {
        None => Ok(file),
        Some((what, stored, now)) => Err(Fault::OtherEnsemble {
            path: path.to_owned(),
            what,
            stored,
            now,
        }),
    }
}

/// A finished shard.
fn read(path: &Path) -> Result<Members, Fault> {
    let mut file = File::open(path).map_err(|source| Fault::Read {
        path: path.to_owned(),
        source,
    })?;
    ordinary("a shard", path)?;
    let found = members::read(path, &mut file)?;
    let missing = found.missing().len();
    if missing == 0 {
        return Ok(found);
    }
    let (number, count) = found.head.shard;
    Err(Fault::ShardUnfinished {
        path: path.to_owned(),
        shard: format!("{number}/{count}"),
        missing,
        members: found.head.members().count(),
    })
}

/// Whether two shards are of one ensemble, cut into as many.
fn alike(first: &Path, one: &Members, path: &Path, other: &Members) -> Result<(), Fault> {
    let count = |members: &Members| members.head.shard.1;
    let difference = one.head.whole().difference(&other.head.whole());
    let difference = difference.or_else(|| {
        let counts = [count(one), count(other)].map(|count| count.to_string());
        let [ours, theirs] = counts;
        (ours != theirs).then(|| ("number of shards".into(), ours, theirs))
    });
    match difference {
        None => Ok(()),
        Some((what, one, other)) => Err(Fault::ShardsDiffer {
            paths: (first.to_owned(), path.to_owned()),
            what,
            values: (one, other),
        }),
    }
}
