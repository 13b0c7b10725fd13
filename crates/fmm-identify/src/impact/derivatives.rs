//! The derivatives of the problem of blows, against differences.

use fmm_fit::Residuals;
use fmm_friction::{Berger, Coulomb, LawFamily};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Excitation, Sampling, Scenario, Trajectory, simulate_into};

use crate::experiment::ImpactTrial;
use crate::impact::parameters::{LAW, RESPONSE_GAIN};
use crate::impact::{ImpactDomain, ImpactMachine, ImpactOptions, ImpactProblem};
use crate::machine::Known;

const INTERVAL: f64 = 1e-3;

/// Two blows on a machine with a law that falls with speed, of different length.
fn trials() -> Vec<ImpactTrial> {
    [(8.0, 1500), (10.0, 1800)]
        .map(|(peak, samples)| {
            let angle = |i: usize| std::f64::consts::PI * i as f64 / 12.0;
            let pulse = |i: usize| if (50..=62).contains(&i) { peak * angle(i - 50).sin() } else { 0.0 };
            let force: Vec<f64> = (0..samples).map(pulse).collect();
            let law = Berger::new(0.04, 0.05, 20.0).unwrap();
            let scenario = Scenario::new(Oscillator::new(0.5, 79.0).unwrap(), law, 1.0).unwrap();
            let scenario = scenario.driven_by(Excitation::sampled_force(INTERVAL, force.clone()).unwrap());
            let mut motion = Trajectory::new();
            simulate_into::<Berger, _>(&scenario, &Sampling::uniform(INTERVAL, samples).unwrap(), None, &mut motion)
                .unwrap();
            let velocity = motion.velocity().values().to_vec();
            let force = Record::new(0.0, INTERVAL, force, Quantity::Force, "N").unwrap();
            let velocity = Record::new(0.0, INTERVAL, velocity, Quantity::Velocity, "m/s").unwrap();
            ImpactTrial::prepare(&force, &velocity).unwrap()
        })
        .to_vec()
}

fn machine() -> ImpactMachine {
    let known = |value| Known::exact(value).unwrap();
    ImpactMachine::new(known(0.5), known(79.0)).unwrap().with_damping(known(0.03)).unwrap()
}

/// In every parameter, held or not, in every domain.
fn compare_with_differences<F: LawFamily>(law: &[f64]) {
    let trials = trials();
    for domain in [ImpactDomain::Mobility, ImpactDomain::Time, ImpactDomain::Both] {
        let options = ImpactOptions::default().within(0.5, 20.0).unwrap().fitting(domain);
        let problem = ImpactProblem::new::<F>(&machine(), &trials, &options).unwrap().with_derivatives_by_inputs();
        let mut p = problem.layout().values.clone();
        p[LAW..LAW + law.len()].copy_from_slice(law);
        // Gains, offsets, errors and delays that are not the trivial ones.
        p[RESPONSE_GAIN] = 1.02;
        let own = problem.layout().shared;
        p[own..].copy_from_slice(&[0.97, 1e-3, 0.01, 3e-5, 1.04, -2e-3, -0.02, -2e-5]);
        let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
        let mut jacobian = vec![0.0; elements];
        let mut together = vec![0.0; problem.len()];
        problem.evaluate(&p, &mut together, Some(&mut jacobian)).unwrap();
        let at = |j: usize, by: f64| {
            let mut moved = p.clone();
            moved[j] += by;
            let mut residuals = vec![0.0; problem.len()];
            problem.evaluate(&moved, &mut residuals, None).unwrap();
            residuals
        };
        let alone = at(0, 0.0);
        let largest = together.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The tolerance of an integration with and without derivatives.
        assert!(largest < 1e-9, "{domain}: residuals differ by {largest} m/s");
        let (mut columns, mut row) = (jacobian.as_slice(), 0);
        for block in problem.blocks() {
            for &j in block.parameters() {
                let name = problem.parameters()[j].name();
                let h = if name.starts_with("pulse_delay") { 1e-6 } else { 1e-5 * p[j].abs().max(1e-2) };
                let (above, below) = (at(j, h), at(j, -h));
                let (column, rest) = columns.split_at(block.rows());
                let difference = |i: usize| (above[row + i] - below[row + i]) / (2.0 * h);
                let scale = column.iter().fold(0.0f64, |scale, d| scale.max(d.abs()));
                // A reversal may cross a sample within h, which spoils its difference: one sample per half swing at
                // most.
                let off = (0..block.rows()).filter(|&i| (column[i] - difference(i)).abs() > 1e-4 * scale).count();
                let has_effect = scale > 0.0 || (name.starts_with("offset") && domain == ImpactDomain::Mobility);
                let worst = (0..block.rows()).map(|i| (column[i] - difference(i)).abs() / scale).fold(0.0, f64::max);
                assert!(has_effect && off < 20, "{domain}, {name}: {off} of {} differ, by {worst}", block.rows());
                columns = rest;
            }
            row += block.rows();
        }
        assert_eq!((row, columns.len()), (problem.len(), 0));
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    compare_with_differences::<Coulomb>(&[0.061]);
    compare_with_differences::<Berger>(&[0.042, 0.047, 18.0]);
}
