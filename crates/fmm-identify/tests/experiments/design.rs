//! What planned tests would tell, against fits of simulated ones.

use fmm_identify::{Aim, Candidate, Guess, Known, Machine, Plan, PlannedSensor, PlannedTest};
use fmm_record::Quantity;

fn machine() -> Machine {
    Machine::of_mass(Known::exact(10.391).unwrap()).unwrap().with_normal_load(Known::exact(14.0).unwrap()).unwrap()
}

#[test]
fn probe() {
    let sensor = PlannedSensor::new(Quantity::Velocity, 1e-4).unwrap();
    let f0 = (1982.0f64 / 10.391).sqrt() / (2.0 * std::f64::consts::PI);
    for (law, terms) in [("berger", vec![]), ("berger + linear", vec![("damping", 0.275)]),("berger + linear + quadratic", vec![("damping", 0.2005), ("quadratic_damping", 0.437)])] {
    for m in [[0.228, 0.261, 2.852]] {
        let guess = Guess::new(machine(), &Candidate::named(law).unwrap(), f0, &m, &terms).unwrap();
        let mut tests = vec![];
        for x in [0.008, 0.016, 0.022] { for n in [3.5, 7.0, 14.0] {
            tests.push(PlannedTest::release(x, sensor, 1000.0, 2.0).unwrap().under_load(Known::exact(n).unwrap()).unwrap().named(format!("{x} m {n} N")));
        }}
        let begin = std::time::Instant::now();
        let plan = Plan::new(guess, tests).unwrap();
        println!("{law} {:?}", begin.elapsed() / 9);
        let repeats = plan.predict(&[5, 5, 5]).unwrap();
        println!("{repeats}");
        let best = plan.best(&Aim::finding("mu"), 3).unwrap();
        println!("{:?} {}", best, plan.predict(best.measurements()).unwrap());
        for (place, text) in plan.told_by_each(best.measurements()).unwrap() { println!("{}: {text}", plan.tests()[place].name()); }
        for i in 0..9 { println!("{}: {}", plan.tests()[i].name(), plan.told_alone(i).unwrap()); }
    }}
}
