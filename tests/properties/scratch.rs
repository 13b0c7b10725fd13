use fmm_friction::*;
use fmm_model::*;
use fmm_sim::*;
fn sc(m: f64, k: f64, c: f64, f: f64, x: f64, v: f64) -> Scenario<f64, Coulomb> {
    Scenario::new(Oscillator::new(m, k).unwrap().with_damping(Damping::linear(c).unwrap()), Coulomb::new(f).unwrap(), 1.0).unwrap().starting_at(x, v).unwrap()
}
#[test]
fn scratch() {
    println!("dual 49/49 {:?}", (Dual::<1>::from(49.0) / Dual::from(49.0)).value());
    println!("atan2 {:?} {:?}", Scalar::atan2(Dual::<1>::from(1e-200), Dual::from(1e-200)).value(), Scalar::atan2(Dual::<1>::from(1e200), Dual::from(1e200)).value());
    // fl(k * fl(F/k)) > F
    let mut n = 0;
    for i in 1..1000 { let f = i as f64 * 0.01; let k = 3.0; let x = f / k; if k * x > f { n += 1; } }
    println!("k fl(F/k) > F: {n} of 999 for k = 3");
    let mut n = 0; let mut first = None;
    for i in 1..1000 { let f = i as f64 * 0.01; let k = 1982.0; let x = f / k; if k * x > f { n += 1; first.get_or_insert(f);} }
    println!("k fl(F/k) > F: {n} of 999 for k = 1982 {first:?}");
    let f = first.unwrap();
    let m = Exact.run(&sc(10.391, 1982.0, 0.275, f, f / 1982.0, 0.0), &Sampling::uniform(1e-3, 2001).unwrap()).unwrap();
    println!("{} events {:?} {:?}", m.events().len(), m.rest(), &m.events()[..3]);
    // static margin
    let s = Scenario::new(Oscillator::new(1.0, 1.0).unwrap(), Coulomb::new(1e200).unwrap(), 1e200).unwrap().starting_at(1.0, 0.0).unwrap();
    let m = Exact.run(&s, &Sampling::uniform(1e-3, 3).unwrap()).map(|m| m.events()[0]);
    println!("static inf {:?} margin {:?}", m, m.as_ref().map(|e| e.margin()));
    // powers overflow
    let m = Exact.run(&sc(1.0, 1e-20, 0.0, 0.0, 0.0, 1e300), &Sampling::uniform(1e-3, 3).unwrap());
    println!("powers {:?}", m);
    for z in [1e2f64, 1e4, 1e6, 1e7, 1e8, 1e9] {
        // m=k=1, c = 2z, v0 = 1, x0=0.; tau = ln(((a+s)v + x)/(x + v/(a+s)))/(2 s) = ln((a+s)^2)/(2s)
        let (a, s) = (z, (z * z - 1.0).sqrt());
        let t = 2.0 * (a + s).ln() / (2.0 * s);
        let m = Exact.run(&sc(1.0, 1.0, 2.0 * z, 0.0, 0.0, 1.0), &Sampling::uniform(1e-3, 2001).unwrap()).unwrap();
        let e = m.events().get(1).map(|e| e.time);
        println!("zeta {z}: expected {t:e} got {e:?} rel {:e}", e.map_or(f64::NAN, |e| e / t - 1.0));
    }
    // friction pushes
    let m = Exact.run(&sc(1.0, 1.0, 2e9, 1e-10, 0.0, 1.0), &Sampling::uniform(1e7, 500).unwrap()).unwrap();
    println!("events {:?}\n{:?} {:?}", m.events(), &m.position().values()[..3], m.position().values().last());
    // v0 derivative
    type D = Dual<1>;
    let g = |x: f64, v: f64| {
        let s = Scenario::new(Oscillator::new(D::from(1.0), D::from(1.0)).unwrap(), Coulomb::new(D::from(0.1)).unwrap(), D::from(1.0)).unwrap().starting_at(D::from(x), D::variable(v, 0)).unwrap();
        Exact.run(&s, &Sampling::uniform(0.5, 20).unwrap()).unwrap()
    };
    let d = g(1.0, 0.0);
    let h = 1e-6;
    for (name, other, sign) in [("inward", g(1.0, -h), -1.0), ("outward", g(1.0, h), 1.0)] {
        for i in [2, 5, 8, 9, 12] {
            println!("{name} sample {i}: dv/dv0 {} fd {}  dx/dv0 {} fd {}", d.velocity().partial(0).unwrap()[i], (other.velocity().values()[i] - d.velocity().values()[i]) / (sign * h),
            d.position().partial(0).unwrap()[i], (other.position().values()[i] - d.position().values()[i]) / (sign * h));
        }
        let shift = other.events().len() - d.events().len();
        println!("event dt {:?} fd {}", d.events()[1].time.partial(0), (other.events()[1 + shift].time.value() - d.events()[1].time.value()) / (sign * h));
    }
    let e = g(1.0, -1e-9);
    println!("dual at -1e-9: dt {} dv[9] {}", e.events()[1].time.partial(0), e.velocity().partial(0).unwrap()[9]);
}
