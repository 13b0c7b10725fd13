use super::*;

/// JCGM 100:2008, H.1: a gauge block of 50 mm.
const GAUGE_BLOCK: &str = r#"
[[input]]
name = "l_s"
unit = "nm"
value = 50000623
u = 25
degrees_of_freedom = 18
[[input]]
name = "d"
unit = "nm"
value = 215
u = 9.7
degrees_of_freedom = 25.6
[[input]]
name = "α_s"
unit = "1/K"
value = 11.5e-6
u = 1.2e-6
[[input]]
name = "θ"
unit = "K"
value = -0.1
u = 0.41
[[input]]
name = "δα"
unit = "1/K"
value = 0
u = 5.8e-7
degrees_of_freedom = 50
[[input]]
name = "δθ"
unit = "K"
value = 0
u = 0.029
degrees_of_freedom = 2
[[result]]
name = "length"
unit = "nm"
formula = "l_s + d - l_s*(δα*θ + α_s*δθ)"
"#;

#[test]
fn the_gauge_block_of_the_gum() {
    let measurement = Measurement::of_toml(GAUGE_BLOCK).unwrap();
    let answers = answers(&measurement, 0.99, (100_000, 1)).unwrap();
    let answer = &answers.results[0];
    assert_eq!(answer.budget.estimate(), 50_000_838.0);
    let statement = answer.statement.as_ref().unwrap();
    // Printed: u = 32 nm, U = 93 nm, ν_eff = 16.
    assert_eq!(statement.standard_uncertainty.round(), 32.0);
    assert_eq!(statement.expanded_uncertainty.round(), 93.0);
    assert_eq!(statement.effective_degrees_of_freedom.map(f64::floor), Some(16.0));
    let text = text(&answers);
    // The level that was asked for, as in the example, and no other.
    assert!(text.contains("U = 93 nm (k = 2.92, 99 %, ν_eff = 16.7)") && !text.contains("95 %"), "{text}");
    // JCGM 101:2008, 9.5: with a δθ of so few degrees of freedom the result has no standard deviation.
    assert!(answer.trials.is_none() && text.contains("δθ has, has no standard deviation"), "{text}");
    assert!(text.contains("length = l_s + d - l_s*(δα*θ + α_s*δθ)") && text.contains("by trials:"), "{text}");
}

/// A linear model of normal inputs, where both ways are the same.
#[test]
fn an_interval_that_holds_is_told() {
    let file = "[[input]]\nname = \"a\"\nunit = \"m\"\nvalue = 1\nu = 0.3\n\
                [[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"2*a\"\n";
    let answers = answers(&Measurement::of_toml(file).unwrap(), 0.95, (1_000_000, 1)).unwrap();
    assert_eq!(answers.results[0].validated_digits, 2);
    assert!(text(&answers).contains("confirm the interval above to two digits"));
}

/// JCGM 101:2008, 9.2.4: where one rectangular input dominates, the Gaussian interval is too wide.
#[test]
fn an_interval_that_does_not_hold_is_told() {
    let input =
        |name: &str, half: f64| format!("[[input]]\nname = \"{name}\"\nunit = \"1\"\nlimits = [-{half}, {half}]\n");
    let (narrow, wide) = (3f64.sqrt(), 300f64.sqrt());
    let file = [input("a", narrow), input("b", narrow), input("c", narrow), input("d", wide)].concat()
        + "[[result]]\nname = \"sum\"\nunit = \"1\"\nformula = \"a + b + c + d\"\n\
           [[result]]\nname = \"narrow\"\nunit = \"1\"\nformula = \"a + b + c\"\n";
    let answers = answers(&Measurement::of_toml(&file).unwrap(), 0.95, (200_000, 1)).unwrap();
    let [sum, narrow] = &answers.results[..] else { panic!("two results") };
    assert!(sum.validated_digits == 1 && (sum.interval.high - 17.0).abs() < 0.1, "{}", sum.interval.high);
    // Three alike are nearly normal, but not to two digits.
    assert!((narrow.interval.high - 3.4).abs() < 0.05);
    // r = 3/√(3 · 103).
    assert!((answers.correlations[0].coefficient - 3.0 / 309f64.sqrt()).abs() < 1e-12);
    assert!(text(&answers).contains("to two, state theirs"));
}

/// From JSON: u² = u_a² + u_b² − 2 r u_a u_b, with u_a = 0.3 and u_b = 0.4.
#[test]
fn correlated_inputs_and_observations_are_read() {
    let file = r#"{
        "input": [
            {"name": "a", "unit": "m", "value": 5, "u": 0.3},
            {"name": "b", "unit": "m", "value": 2, "u": 0.4},
            {"name": "c", "unit": "m", "observations": [1, 2, 3, 4]}
        ],
        "correlation": [{"between": ["a", "b"], "coefficient": 0.5}],
        "result": [
            {"name": "difference", "unit": "m", "formula": "a - b"},
            {"name": "mean", "unit": "m", "formula": "c"}
        ]
    }"#;
    let answers = answers(&Measurement::of_json(file).unwrap(), 0.95, (100_000, 1)).unwrap();
    let [difference, mean] = &answers.results[..] else { panic!("two results") };
    assert!((difference.budget.standard_uncertainty() - 0.13f64.sqrt()).abs() < 1e-12);
    // The mean of 1, 2, 3, 4 has u = √(5/12) and three degrees of freedom.
    let statement = mean.statement.as_ref().unwrap();
    assert!((statement.estimate, statement.effective_degrees_of_freedom) == (2.5, Some(3.0)));
    assert!((statement.standard_uncertainty - (5.0 / 12.0_f64).sqrt()).abs() < 1e-12);
    assert_eq!(answers.correlations[0].coefficient, 0.0);
}

/// Half widths of 3 over √3, √6 and √2 (JCGM 100:2008, 4.3.7 and 4.3.9; JCGM 101:2008, 6.4.6), from files of both
/// kinds.
#[test]
fn limits_are_those_of_their_distribution() {
    let folder = std::env::temp_dir();
    let u = |distribution: &str, ending: &str| {
        let path = folder.join(format!("fmm-budget-{}-{ending}.{ending}", std::process::id()));
        let file = if ending == "JSON" {
            format!(
                r#"{{"input": [{{"name": "a", "unit": "m", "limits": [1, 7], "distribution": "{distribution}"}}],
                     "result": [{{"name": "y", "unit": "m", "formula": "a"}}]}}"#
            )
        } else {
            format!(
                "[[input]]\nname = \"a\"\nunit = \"m\"\nlimits = [1, 7]\ndistribution = \"{distribution}\"\n\
                 [[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"a\"\n"
            )
        };
        std::fs::write(&path, file).unwrap();
        let read = Host::default().document(&path, Measurement::of);
        std::fs::remove_file(&path).unwrap();
        read.unwrap().inputs.as_slice()[0].standard_uncertainty()
    };
    for ending in ["toml", "JSON"] {
        for (distribution, divisor) in [("rectangular", 3.0_f64), ("triangular", 6.0), ("arc sine", 2.0)] {
            let found = u(distribution, ending);
            assert!((found - 3.0 / divisor.sqrt()).abs() < 1e-12, "{distribution}: {found}");
        }
    }
}

fn input_of(lines: &str) -> fmm_uq::Input {
    let result = "[[result]]\nname = \"y\"\nformula = \"a\"\n";
    let file = format!("[[input]]\nname = \"a\"\n{lines}\n{result}");
    Measurement::of_toml(&file).unwrap_or_else(|error| panic!("{lines}: {error}")).inputs.as_slice()[0].clone()
}

/// Statements of certificates and data sheets.
#[test]
fn uncertainties_are_read_as_they_are_stated() {
    for (lines, u, freedom) in [
        ("value = -20\nu = \"1.5 %\"", 0.3, f64::INFINITY),
        ("value = 20\nU = 0.3\nk = 2", 0.15, f64::INFINITY),
        ("value = 20\nU = \"1%\"\nk = 2", 0.1, f64::INFINITY),
        ("value = 20\nU = 0.3\nlevel = \"95 %\"", 0.3 / 1.959_963_984_540_054, f64::INFINITY),
        // JCGM 100:2008, Table G.2: t of 95 % and 9 degrees of freedom is 2.26.
        ("value = 20\nU = 0.3\nlevel = 0.95\ndegrees_of_freedom = 9", 0.3 / 2.262_157_162_740_99, 9.0),
        ("limits = [18, 22]\ndegrees_of_freedom = 8", 2.0 / 3f64.sqrt(), 8.0),
        // JCGM 100:2008, 4.3.4: ±129 µΩ with 99 % is u = 50 µΩ.
        ("limits = [-129, 129]\ndistribution = \"normal\"\nlevel = \"99 %\"", 50.08, f64::INFINITY),
    ] {
        let input = input_of(lines);
        assert!((input.standard_uncertainty() / u - 1.0).abs() < 1e-4, "{lines}: {}", input.standard_uncertainty());
        assert_eq!((input.degrees_of_freedom(), input.unit()), (freedom, "1"), "{lines}");
    }
}

/// JCGM 100:2008, H.2: voltage, current and phase observed together, and the impedance of them.
const IMPEDANCE: &str = include_str!("../../../../examples/budgets/impedance.toml");

#[test]
fn the_impedance_of_the_gum_is_a_complex_number() {
    let measurement = Measurement::of_toml(IMPEDANCE).unwrap();
    let answers = answers(&measurement, 0.95, (50_000, 1)).unwrap();
    let printed = [("Z_real", 127.732, 0.071), ("Z_imaginary", 219.847, 0.295), ("Z_magnitude", 254.260, 0.236)];
    for (stated, (name, estimate, u)) in answers.results.iter().zip(printed) {
        assert_eq!(stated.budget.name(), name);
        assert!((stated.budget.estimate() - estimate).abs() < 6e-4, "{name}: {}", stated.budget.estimate());
        // The printed 0.295 is 0.2956.
        assert!((stated.budget.standard_uncertainty() - u).abs() < 6e-4, "{name}");
        assert_eq!(stated.budget.effective_degrees_of_freedom().map(f64::round), Some(4.0), "{name}");
    }
    let phase = &answers.results[3].budget;
    assert!((phase.estimate() - 1.044_46).abs() < 1e-9 && (phase.standard_uncertainty() - 0.000_752_06).abs() < 1e-8);
    let coefficient = |first: &str, second: &str| {
        let between = [first, second];
        answers.correlations.iter().find(|c| c.between == between).map(|c| c.coefficient).unwrap()
    };
    assert!((coefficient("Z_real", "Z_imaginary") + 0.588).abs() < 5e-4);
    assert!((coefficient("Z_real", "Z_magnitude") + 0.485).abs() < 5e-4);
    assert!((coefficient("Z_imaginary", "Z_magnitude") - 0.993).abs() < 6e-4);
    let [[real, both], [_, imaginary]] = answers.complex[0].covariance;
    assert!((both / (real * imaginary).sqrt() + 0.588).abs() < 5e-4);
    // k² = 2 F(0.95; 2, 4) = 2 · 6.9443, as ν of the ensemble is 4.
    let k = answers.complex[0].coverage_factor.unwrap();
    assert!((k * k - 13.8885).abs() < 1e-3, "{}", k * k);
    let text = text(&answers);
    assert!(text.contains("Z (Ω): covariance matrix of real and imaginary part [[5.0511e-3"), "{text}");
}

#[test]
fn magnitude_and_phase_make_the_same_number() {
    let polar = "[[input]]\nname = \"r\"\nvalue = 2\nu = 0.1\n[[input]]\nname = \"phi\"\nvalue = 0.5\nu = 0.02\n\
                 [[result]]\nname = \"Z\"\nunit = \"Ω\"\nmagnitude = \"r\"\nphase = \"phi\"\n";
    let answers = answers(&Measurement::of_toml(polar).unwrap(), 0.95, (10_000, 1)).unwrap();
    let u: Vec<f64> = answers.results.iter().map(|stated| stated.budget.standard_uncertainty()).collect();
    let (sin, cos) = 0.5f64.sin_cos();
    for (found, expected) in u.iter().zip([(0.1 * cos).hypot(0.04 * sin), (0.1 * sin).hypot(0.04 * cos), 0.1, 0.02]) {
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
    let both = answers.complex[0].covariance[0][1];
    assert!((both - sin * cos * (0.01 - 0.0016)).abs() < 1e-14, "{both}");
}

/// An oil of 13.6 mm²/s with u = 1.8 mm²/s (JCGM 106:2012, 7.5), under each rule.
#[test]
fn tolerances_are_decided_by_their_rule() {
    let of = |rule: &str| {
        let file = format!(
            "[[input]]\nname = \"v\"\nunit = \"mm²/s\"\nvalue = 13.6\nu = 1.8\n\
             [[result]]\nname = \"viscosity\"\nunit = \"mm²/s\"\nformula = \"v\"\n\
             tolerance = {{ lower = 12.5, upper = 16.3{rule} }}\n"
        );
        let answers = answers(&Measurement::of_toml(&file).unwrap(), 0.95, (200_000, 1)).unwrap();
        let document = serde_json::to_value(&answers).unwrap()["results"][0]["conformity"].clone();
        (document, text(&answers))
    };
    let (simple, told) = of("");
    let number = |document: &serde_json::Value, key: &str| document[key].as_f64().unwrap_or(f64::NAN);
    assert!((number(&simple, "probability") - 0.66).abs() < 5e-3, "{simple}");
    assert!((number(&simple, "probability_by_trials") - number(&simple, "probability")).abs() < 4e-3, "{simple}");
    assert_eq!((simple["accepted"].as_bool(), number(&simple, "acceptance_upper")), (Some(true), 16.3));
    assert!(told.contains("tolerance from 12.5 to 16.3 mm²/s: conforms with a probability of 66.26 %"), "{told}");
    // U = 1.96 · 1.8 = 3.53: a tenth of it leaves 13.6, four tenths do not.
    let (tenth, _) = of(", guard_band = 0.1");
    assert!((number(&tenth, "acceptance_lower") - 12.5 - 0.1 * 3.527_935).abs() < 1e-6, "{tenth}");
    assert_eq!(tenth["accepted"].as_bool(), Some(true));
    let (more, told) = of(", guard_band = 0.4");
    assert_eq!(more["accepted"].as_bool(), Some(false));
    assert!(
        told.contains("guard band 0.4 U: accepted from 13.9112 to 14.8888 mm²/s; the result is not accepted"),
        "{told}"
    );
    let (none, told) = of(", risk = 0.05");
    assert_eq!(none["accepted"].as_bool(), Some(false));
    assert!(told.contains("nothing is accepted; no measured value has a risk of 0.05 or less"), "{told}");
    let (half, _) = of(", risk = 0.35");
    assert_eq!(half["accepted"].as_bool(), Some(true));
}

/// One budget a row; an uncertainty in percent goes with its value.
#[test]
fn a_sweep_has_a_budget_for_each_row() {
    let file = "[[input]]\nname = \"F\"\nunit = \"N\"\nvalue = 1\nu = \"2 %\"\n\
                [[input]]\nname = \"N\"\nunit = \"N\"\nvalue = 10\nu = 0.1\n\
                [[result]]\nname = \"mu\"\nformula = \"F/N\"\n[sweep]\nF = [1, 2, 4]\nN = [5, 10, 20]\n";
    let measurement = Measurement::of_toml(file).unwrap();
    let row = |(values, inputs): &(BTreeMap<String, f64>, Inputs)| Swept {
        values: values.clone(),
        row: answers_of(&measurement, inputs, 0.95, (10_000, 1)).unwrap(),
    };
    let sweep: Vec<Swept> = measurement.sweep.iter().map(row).collect();
    for (swept, load) in sweep.iter().zip([5.0, 10.0, 20.0]) {
        let budget = &swept.row.results[0].budget;
        assert_eq!((budget.estimate(), swept.values["N"]), (0.2, load));
        let expected = 0.2 * 0.02_f64.hypot(0.1 / load);
        assert!((budget.standard_uncertainty() - expected).abs() < 1e-15, "{load} N");
    }
    let answers = Answers { row: Row::default(), sweep };
    let told = answers.text().unwrap();
    assert!(told.contains("== F = 2, N = 10\n") && told.contains("\nF = 4, N = 20  mu (1)  0.2000 ± 0.0041"), "{told}");
    let document = serde_json::to_value(&answers).unwrap();
    assert_eq!(document["sweep"][1]["values"]["F"].as_f64(), Some(2.0));
    assert_eq!(document["sweep"][1]["results"][0]["formula"].as_str(), Some("F/N"));
    assert_eq!(document["results"].as_array().map(Vec::len), Some(0));
}

#[test]
fn results_without_an_interval_by_derivatives_are_told() {
    let input = "[[input]]\nname = \"b\"\nunit = \"m\"\nvalue = 2\nu = 0.1\n";
    let told = |formula: &str| {
        let file = format!("{input}[[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"{formula}\"\n");
        text(&answers(&Measurement::of_toml(&file).unwrap(), 0.95, (10_000, 1)).unwrap())
    };
    assert!(told("b - b").contains("the trials do not vary: the result does not depend on what is uncertain"));
    // 0.1 m is lost beside 1e20 m.
    let lost = told("b + 1e20 - 1e20");
    assert!(lost.contains("digits in which they differ are lost") && !lost.contains("does not depend"), "{lost}");
    // Flat where it is linearised: the derivatives see nothing.
    assert!(told("(b - 2)^2").contains("there is no interval above"));
}

#[test]
fn what_is_wrong_in_a_file_is_named() {
    let refused = |text: &str| Measurement::of_toml(text).unwrap_err().to_string();
    let input = "[[input]]\nname = \"m\"\nunit = \"kg\"\n";
    let result = "[[result]]\nname = \"F\"\nunit = \"N\"\nformula = \"9.81*m\"\n";
    for (file, part) in [
        (format!("{input}value = 2\n{result}"), "m needs u"),
        (format!("{input}u = 2\n{result}"), "m needs a value beside its uncertainty"),
        (format!("{input}{result}"), "m needs value and u, value and U, limits or observations"),
        (format!("{input}value = 2\nu = 0.1\nlimits = [1, 3]\n{result}"), "m has more than one of value and u, limits"),
        (format!("{input}value = 2\nu = -0.1\n{result}"), "standard uncertainty of m"),
        (format!("{input}value = 2\nu = 0.1\nsigma = 3\n{result}"), "sigma"),
        (format!("{input}limits = [1, 3]\ndistribution = \"gauss\"\n{result}"), "no distribution \"gauss\""),
        (format!("{input}value = 2\nu = 0.1\ndistribution = \"triangular\"\n{result}"), "belongs to limits"),
        (format!("{input}observations = [1, 2]\ndegrees_of_freedom = 3\n{result}"), "those of its observations"),
        (format!("{input}value = 2\nu = \"1\"\n{result}"), "u of m is a number, or a text in percent such as"),
        (format!("{input}value = 0\nu = \"1 %\"\n{result}"), "in percent of a value that is 0"),
        (format!("{input}value = 2\nU = 0.2\n{result}"), "U of m needs its k, such as 2, or its level"),
        (format!("{input}value = 2\nU = 0.2\nk = 2\nlevel = 0.95\n{result}"), "both k and level"),
        (format!("{input}value = 2\nU = 0.2\nk = 0\n{result}"), "k of m must be positive and finite, but is 0"),
        (format!("{input}value = 2\nU = 0.2\nu = 0.1\n{result}"), "both u and U"),
        (format!("{input}value = 2\nU = 0.2\nlevel = 95\n{result}"), "such as 0.95 or \"95 %\", but is 95"),
        (format!("{input}value = 2\nu = 0.1\nk = 2\n{result}"), "the k of m belongs to U"),
        (format!("{input}value = 2\nu = 0.1\nlevel = 0.9\n{result}"), "the level of m belongs to U"),
        (format!("{input}value = 2\nu = [1]\n{result}"), "a number is needed, or a text such as"),
        (format!("{input}limits = [1, 3]\ndistribution = \"normal\"\n{result}"), "goes beyond any"),
        (format!("{input}value = 2\nu = 0.1\n[[result]]\nname = \"F\"\n"), "F needs one of formula, real and"),
        (format!("{input}value = 2\nu = 0.1\n{result}tolerance = {{}}\n"), "needs lower, upper or both"),
        (format!("{input}value = 2\nu = 0.1\n{result}tolerance = {{lower = 3, upper = 1}}\n"), "a larger upper limit"),
        (
            format!("{input}value = 2\nu = 0.1\n{result}tolerance = {{lower = 3, risk = 0.7}}\n"),
            "the risk of F must lie above 0 and be at most 0.5, but is 0.7",
        ),
        (
            format!("{input}value = 2\nu = 0.1\n{result}tolerance = {{lower = 3, risk = 0.1, guard_band = 1}}\n"),
            "has both guard_band and risk",
        ),
        (format!("{input}value = 2\nu = 0.1\n{result}[sweep]\nn = [1]\n"), "no input with a value"),
        (
            format!(
                "{input}value = 2\nu = 0.1\n{}{result}[sweep]\nm = [1, 2]\nn = [1]\n",
                input.replace("\"m\"", "\"n\"") + "value = 1\nu = 0\n"
            ),
            "there are 1 of n beside 2",
        ),
        (format!("{input}value = 2\nu = 0.1\n[[simultaneous]]\nquantities = [\"m\"]\n{result}"), "observations of m"),
        (format!("{input}observations = [2.0]\n{result}"), "at least 2 observations"),
        (format!("{input}value = 2\nu = 0.1\n{}", result.replace("*m", "*M")), "no quantity M; there is m"),
        (format!("{input}value = 2\nu = 0.1\n"), "result"),
        (format!("{input}value = 2\nu = 0.1\n{result}{result}"), "two results are called F"),
        ("input = 3".to_owned(), "input"),
        (format!("{input}value = 2\nu = -1e300\n{result}"), "zero or positive and finite, but is -1e300 kg"),
        (format!("{input}limits = [1, 2, 3]\n{result}"), "limits are two numbers, but 3 are given"),
        (format!("{input}limits = [1]\n{result}"), "limits are two numbers, but 1 is given"),
        (
            format!(
                "{input}value = 2\nu = 0.1\n[[correlation]]\nbetween = [\"m\", \"m\", \"n\"]\ncoefficient = 0\n{result}"
            ),
            "between two names, but 3 are given",
        ),
    ] {
        let error = refused(&file);
        assert!(error.contains(part), "{file}\n{error}");
    }
    let json = r#"{"input": [{"name": "m", "unit": "kg", "limits": [1, 2, 3]}], "result": []}"#;
    let error = Measurement::of_json(json).unwrap_err().to_string();
    assert!(error.contains("limits are two numbers, but 3 are given"), "{error}");
}
