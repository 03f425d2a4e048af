//! Fuzzes the C interface with random sequences of calls with random, invalid and adversarial arguments.
//!
//! Every sequence runs on one object per instruction set; the objects must agree in every status, result, list,
//! statistic and bit of depth. At times one of them is drawn into by a thread pool. All arrays are bordered by
//! inaccessible pages. At the first crash, hang, disagreement or impossible result, the program exits with status 1 and
//! names the seed and number of the episode.
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

    /// Fuzzes the C interface with random and hostile calls.
    #[derive(Parser)]
    struct Arguments {
        /// Duration in seconds.
        #[arg(long, default_value_t = 30.0)]
        seconds: f64,
        /// The same seed gives the same calls.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Runs only this episode, as named by a failure.
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
    println!("seed {}: {tally}, {:.0} calls per second, no failure", arguments.seed, tally.calls as f64 / seconds);
    std::process::ExitCode::SUCCESS
}

#[cfg(not(unix))]
fn main() {
    println!("fuzzing needs Unix memory protection");
}
