//! A hostile driver of the C interface: random sequences of calls with random, wrong and wicked arguments.
//!
//! Every sequence goes to one object an instruction set, which have to agree in every status, answer,
//! list, statistic and bit of depth; now and then one of them is drawn into by a pool of threads. All arrays border on
//! forbidden pages. It ends with status 1, and with the seed and number of the episode, at the first crash, hang,
//! disagreement or impossible answer.
//!
//! `cargo tool fuzzing -- --seconds 30 --seed 1`

#[cfg(unix)]
mod alarm;
#[cfg(unix)]
mod calls;
#[cfg(unix)]
mod episode;
#[cfg(unix)]
mod family;
#[cfg(unix)]
mod guarded;
#[cfg(unix)]
mod hostile;
#[cfg(unix)]
mod lists;
#[cfg(unix)]
mod memory;
#[cfg(unix)]
mod mesh;
#[cfg(unix)]
mod objects;
#[cfg(unix)]
mod pool;
#[cfg(unix)]
mod stretch;

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    use clap::Parser;

    /// Drives the C interface with random and hostile calls.
    #[derive(Parser)]
    struct Arguments {
        /// How long to go on.
        #[arg(long, default_value_t = 30.0)]
        seconds: f64,
        /// The same seed gives the same calls.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Run only this episode: the one that a failure named.
        #[arg(long)]
        episode: Option<u64>,
    }

    let arguments = Arguments::parse();
    alarm::install();
    let start = std::time::Instant::now();
    let mut memory = episode::Memory::new();
    let mut tally = episode::Tally::default();
    for number in arguments.episode.unwrap_or(0).. {
        alarm::enter(arguments.seed, number);
        if let Err(failure) = episode::run(arguments.seed, number, arguments.episode.is_some(), &mut memory, &mut tally)
        {
            eprintln!("FAILED: {failure}\nrun again with --seed {} --episode {number}", arguments.seed);
            return std::process::ExitCode::FAILURE;
        }
        if arguments.episode.is_some() || start.elapsed().as_secs_f64() >= arguments.seconds {
            break;
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("seed {}: {tally}, {:.0} calls a second, no failure", arguments.seed, tally.calls as f64 / seconds);
    std::process::ExitCode::SUCCESS
}

#[cfg(not(unix))]
fn main() {
    println!("fuzzing needs the memory protection of a Unix system");
}
