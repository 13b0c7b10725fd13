//! Printed text: budgets as a laboratory shows them, statements, distributions.

use fmm_uq::{
    Adaptive, Distribution, Evaluation, Input, Inputs, IntervalKind, MonteCarlo, Observations, Scalar, Taylor,
    propagate,
};

/// A length by comparison: observations, a certificate with its expanded uncertainty, limits, correlated temperatures.
fn inputs() -> Inputs {
    let observed = Observations::new(&[10.031, 10.028, 10.035, 10.030]).unwrap();
    let of = |name: &str, distribution: Distribution, unit: &str| Input::of(name, distribution, unit).unwrap();
    Inputs::new([
        Input::mean_of("reading", &observed, "mm").unwrap(),
        of("standard", Distribution::normal(40.0, 0.001).unwrap(), "mm"),
        of("resolution", Distribution::rectangular(-0.0005, 0.0005).unwrap(), "mm"),
        of("alignment", Distribution::triangular(-0.002, 0.002).unwrap(), "mm"),
        of("cycle", Distribution::arc_sine(-0.5, 0.5).unwrap(), "K"),
        Input::new("expansion", 1.15e-5, 1e-6, "1/K").unwrap().evaluated_as(Evaluation::TypeA),
    ])
    .unwrap()
}

fn length<D: Scalar>(x: &[D]) -> D {
    (x[0] + x[1] + x[2] + x[3]) * (x[4] * x[5] + 1.0)
}

#[test]
fn a_budget_as_a_laboratory_prints_it() {
    let budget = propagate(&inputs(), length).unwrap().named("length", "mm");
    assert_eq!(
        budget.to_string(),
        "\
quantity    estimate  unit  distribution  type  divisor        u  ν         c  unit of c    |c| u   share
reading       10.031  mm    t             A           1  0.00147  3         1  1          0.00147  54.7 %
standard          40  mm    normal        B           1    0.001  ∞         1  1            0.001  25.3 %
resolution         0  mm    rectangular   B          √3  2.89e-4  ∞         1  1          2.89e-4   2.1 %
alignment          0  mm    triangular    B          √6  8.16e-4  ∞         1  1          8.16e-4  16.8 %
cycle              0  K     arc sine      B          √2    0.354  ∞  5.754e-4  mm/K       2.03e-4   1.0 %
expansion    1.15e-5  1/K   normal        A           1     1e-6  ∞         0  mm·K             0   0.0 %

length = 50.0310 mm, u = 0.0020 mm
U = 0.0044 mm (k = 2.23, 95 %, ν_eff = 10)
"
    );
}

#[test]
fn statements_say_how_a_run_is_made_again() {
    let inputs = inputs();
    let run = MonteCarlo::new(&inputs, 20_000).unwrap().with_seed(3).with_allowed_failures(0.5).unwrap();
    let fragile = |x: &[f64]| if x[4] > 0.0 { Ok(length(x)) } else { Err("cold") };
    let sample = run.run(fragile).unwrap();
    let statement = run.statement(&sample, 0, IntervalKind::Shortest, 0.99).unwrap().named("length", "mm");
    assert_eq!((statement.trials, statement.failed, statement.seed), (20_000, sample.failures().count(), 3));
    assert_eq!(statement.estimate, sample.estimate(0).unwrap());
    let text = statement.to_string();
    assert!(text.starts_with("length = 50.03"), "{text}");
    assert!(text.contains("99 % interval [50.0") && text.contains("(shortest)"), "{text}");
    let failed = format!("20000 trials, {} of them failed, seed 3, standard errors of y and u ", statement.failed);
    assert!(text.contains(&failed), "{text}");
    assert_eq!(statement.tolerance, None);
    let adaptive = MonteCarlo::adaptive(&inputs, Adaptive::to_digits(1).unwrap());
    let statement = adaptive.statement(&adaptive.run(length).unwrap(), 0, IntervalKind::Symmetric, 0.95).unwrap();
    assert_eq!(statement.tolerance, Some(0.0005), "u is about 0.002");
    assert!(statement.to_string().ends_with("seed 0, stable to 5e-4"), "{statement}");
    assert!(run.statement(&sample, 1, IntervalKind::Symmetric, 0.95).is_err());
}

#[test]
fn distributions_are_written_in_the_symbols_of_the_guide() {
    for (distribution, text, name, divisor) in [
        (Distribution::constant(3.0), "3", "constant", 1.0),
        (Distribution::rectangular(7000.0, 9000.0), "R(7000, 9000)", "rectangular", 3f64.sqrt()),
        (Distribution::triangular(-1.0, 1.0), "T(-1, 1)", "triangular", 6f64.sqrt()),
        (Distribution::trapezoid(-1.0, 1.0, 0.5), "Trap(-1, 1, 0.5)", "trapezoid", (6.0f64 / 1.25).sqrt()),
        (
            Distribution::curvilinear_trapezoid(-0.05, 0.05, 0.025),
            "CTrap(-0.05, 0.05, 0.025)",
            "curvilinear trapezoid",
            0.075 / (0.1f64.powi(2) / 12.0 + 0.025f64.powi(2) / 9.0).sqrt(),
        ),
        (Distribution::arc_sine(-0.5, 0.5), "U(-0.5, 0.5)", "arc sine", 2f64.sqrt()),
        (Distribution::normal(0.0, 0.05), "N(0, 0.05²)", "normal", 1.0),
        (Distribution::student_t(5e7, 25.0, 18.0), "t_18(50000000, 25²)", "t", 1.0),
        (Distribution::exponential(2.0), "Ex(1/2)", "exponential", 1.0),
        (Distribution::gamma(4.0, 1.0), "G(4, 1)", "gamma", 1.0),
        (Distribution::empirical(&[1.0, 2.0]), "empirical of 2 values", "empirical", 1.0),
    ] {
        let distribution = distribution.unwrap();
        assert_eq!((distribution.to_string().as_str(), distribution.name()), (text, name));
        assert!((distribution.divisor() / divisor - 1.0).abs() < 1e-14, "{text}: {}", distribution.divisor());
    }
}

#[test]
fn what_cannot_be_expanded_is_printed_without_an_interval() {
    let pair = ["a", "b"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap().with_degrees_of_freedom(4.0).unwrap());
    let inputs = Inputs::new(pair).unwrap().with_correlations(&[("a", "b", 0.5)]).unwrap();
    let text = propagate(&inputs, |x| x[0] + x[1]).unwrap().to_string();
    assert!(text.contains("r(a, b) = 0.5\n\nresult = 2.00, u = 0.17\nno U: ν_eff undefined\n"), "{text}");
    let flat = propagate(&Inputs::new([Input::new("a", 0.0, 0.1, "m").unwrap()]).unwrap(), |x: &[Taylor]| x[0] * x[0]);
    let text = flat.unwrap().to_string();
    assert!(text.contains("u = 0\n") && text.contains("warning: u is zero"), "{text}");
}

#[cfg(feature = "serde")]
#[test]
fn statements_and_budgets_are_documents() {
    let inputs = inputs();
    let budget = propagate(&inputs, length).unwrap().named("length", "mm");
    let document = serde_json::to_value(&budget).unwrap();
    assert_eq!(document["name"], "length");
    assert_eq!(document["standard_uncertainty"].as_f64().unwrap(), budget.standard_uncertainty());
    assert_eq!(document["contributions"][0]["type"], "A");
    assert_eq!(document["contributions"][2]["distribution"], "R(-5e-4, 5e-4)");
    assert!(document["contributions"][2]["degrees_of_freedom"].is_null(), "infinite");
    let statement = budget.statement(0.95).unwrap();
    let text = serde_json::to_string(&statement).unwrap();
    assert_eq!(serde_json::from_str::<fmm_uq::Statement>(&text).unwrap().to_string(), statement.to_string());
    let run = MonteCarlo::new(&inputs, 2000).unwrap();
    let statement = run.statement(&run.run(length).unwrap(), 0, IntervalKind::Symmetric, 0.95).unwrap();
    let text = serde_json::to_string(&statement).unwrap();
    assert_eq!(serde_json::from_str::<fmm_uq::TrialStatement>(&text).unwrap().to_string(), statement.to_string());
}
