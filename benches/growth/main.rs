//! Cost of a call as samples, half swings, derivatives, parameters and inputs grow: the tables of
//! docs/performance.md.
//!
//! `cargo bench --bench growth` prints rows of the least time of many calls;
//! `cargo bench --bench growth -- uncertainty` those of one table.

mod fits;
mod frequency_response;
mod least;
mod simulation;
mod steps;
mod uncertainty;

fn main() {
    let tables: [(&str, fn()); 5] = [
        ("simulation", simulation::print_rows),
        ("steps", steps::print_rows),
        ("fits", fits::print_rows),
        ("uncertainty", uncertainty::print_rows),
        ("frequency_response", frequency_response::print_rows),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    for (name, print_rows) in tables {
        if wanted.is_empty() || wanted.iter().any(|wanted| name.contains(wanted.as_str())) {
            println!("\n{name}\n\n| what grows | time |\n|---|---|");
            print_rows();
        }
    }
}
