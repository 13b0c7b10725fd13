"""A law of one's own is fitted as a law of the list is, and its faults are told."""

import copy
import gc
import pickle
import time
import weakref

import numpy as np
import pytest

import fmm_friction as fmm
from conftest import MACHINE, RUNS


def straight(v, coefficient, viscous):
    return coefficient + viscous * v


def straight_by(v, coefficient, viscous):
    return np.ones_like(v) * viscous, np.ones_like(v), v


def stribeck(v, sliding, excess, speed, viscous):
    return sliding + excess * np.exp(-((v / speed) ** 2)) + viscous * v


def root(v, level, rise):
    return level + rise * np.sqrt(v + 1e-4)


STRAIGHT = [fmm.Parameter("coefficient", "level"), fmm.Parameter("viscous", "slope")]
ROOT = [fmm.Parameter("coefficient", "level"), fmm.Parameter("rise", "level", "(s/m)^0.5", start=0.3)]


def near(own, listed, share=1e-3):
    """True if all findings of two results differ by less than a share of u, and so do their u."""
    assert set(own.findings) == set(listed.findings)
    for name, finding in listed.findings.items():
        other = own.findings[name]
        assert other.value == pytest.approx(finding.value, abs=share * (finding.u or 1)), name
        assert other.u == pytest.approx(finding.u, rel=share), name
    return True


@pytest.mark.parametrize("derivatives", [None, straight_by])
def test_a_straight_law_is_coulomb_viscous(derivatives):
    law = fmm.Law("straight", straight, STRAIGHT, derivatives=derivatives)
    own = fmm.identify(RUNS[0], law=law, **MACHINE)
    listed = fmm.identify(RUNS[0], law="coulomb_viscous", **MACHINE)
    assert own.preferred == "straight" and near(own, listed)
    assert own.curve.fitted == pytest.approx(listed.curve.fitted, abs=1e-6 * np.ptp(listed.curve.fitted))


def test_a_curve_is_stribecks():
    """The excess and the static level are the same parameter by other names."""
    parameters = [
        fmm.Parameter("sliding_coefficient", "level", start=0.9),
        fmm.Parameter("excess_coefficient", "excess", start=0.4),
        fmm.Parameter("stribeck_speed", "shape", "m/s", start=0.2, bounds=(1e-9, None)),
        fmm.Parameter("viscous", "slope"),
    ]
    own = fmm.identify(RUNS[0], law=fmm.Law("curve", stribeck, parameters), **MACHINE)
    listed = fmm.identify(RUNS[0], law="stribeck", hold={"exponent": 2}, **MACHINE)
    for name in ("sliding_mu", "stribeck_speed"):
        own_finding, finding = own.findings[name], listed.findings[name]
        assert own_finding.value == pytest.approx(finding.value, abs=1e-3 * finding.u), name
    ratio = own.model["rms_residual"] / listed.model["rms_residual"]
    assert ratio == pytest.approx(1, abs=1e-6)


def moved(law, values, mass, stiffness, load, position, rate, end):
    """Velocities of a machine under a law, by small steps of Runge and Kutta that end where the contact sticks."""
    h, x, v, t, found = 1 / (rate * 20), position, 0.0, 0, []
    breakaway = float(law(0.0, *values)) * load

    def pull(x, v, sign):
        return (-stiffness * x - sign * load * float(law(abs(v), *values))) / mass

    sticks = False
    while len(found) < end * rate:
        if t % 20 == 0:
            found.append(v)
        t += 1
        if sticks or (v == 0.0 and abs(stiffness * x) <= breakaway):
            v, sticks = 0.0, True
            continue
        sign = np.sign(v) or -np.sign(x)
        k1 = pull(x, v, sign)
        k2 = pull(x + h / 2 * v, v + h / 2 * k1, sign)
        k3 = pull(x + h / 2 * v + h * h / 4 * k1, v + h / 2 * k2, sign)
        k4 = pull(x + h * v + h * h / 2 * k2, v + h * k3, sign)
        before = v
        x, v = x + h * v + h * h / 6 * (k1 + k2 + k3), v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if before * v < 0:
            v = 0.0
    return np.array(found)


@pytest.fixture(scope="module")
def of_root():
    law = fmm.Law("root", root, ROOT)
    v = moved(law, (0.05, 0.2), mass=2.0, stiffness=800.0, load=10.0, position=0.03, rate=500.0, end=1.6)
    return np.arange(len(v)) / 500.0, v + 2e-4 * np.random.default_rng(1).standard_normal(len(v))


def test_a_law_that_is_not_on_the_list_is_found_again(of_root):
    law = fmm.Law("root", root, ROOT)
    begun = time.perf_counter()
    found = fmm.compare(*of_root, unit="m/s", mass=2, normal_load=10, law=[law, "coulomb", "coulomb_viscous"])
    assert time.perf_counter() - begun < 60
    assert found.preferred == "root" and found.document["decided"]
    level, rise = found.findings["mu"], found.findings["contact_rise"]
    assert abs(level.value - 0.05) < 4 * level.u < 0.02 and abs(rise.value - 2) < 4 * rise.u < 0.1
    assert rise.unit == "N s^0.5/m^0.5"
    assert np.std(found.residuals) == pytest.approx(2e-4, rel=0.1)
    again = pickle.loads(pickle.dumps(found))
    assert again.to_json() == found.to_json() and "root" in str(again)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "function",
    [
        lambda v, coefficient: coefficient,
        lambda v, coefficient: np.broadcast_to(coefficient, v.shape),
        lambda v, coefficient: list(coefficient),
        lambda v, coefficient: np.float64(coefficient[0]) if len(v) == 1 else coefficient,
        lambda v, coefficient: np.stack([v, coefficient]).T[:, 1],
    ],
)
def test_arrays_of_any_kind_are_taken(function):
    law = fmm.Law("level", function, STRAIGHT[:1])
    own = fmm.compare(RUNS[0], law=law, to=1.0)
    assert near(own, fmm.compare(RUNS[0], law="coulomb", to=1.0))


def test_terms_stand_beside_it():
    law = fmm.Law("level", lambda v, coefficient: coefficient, STRAIGHT[:1])
    own = fmm.identify(RUNS[0], law=law.beside("linear"), **MACHINE)
    listed = fmm.identify(RUNS[0], law="coulomb+linear", **MACHINE)
    assert own.preferred == "level + linear" and near(own, listed)
    held = fmm.identify(RUNS[0], law=law.beside("linear"), hold={"level.damping_per_mass": 0.03}, **MACHINE)
    assert held.findings["damping_per_mass"].value == 0.03


def test_forces_and_campaigns_take_it():
    law = fmm.Law("straight", straight, STRAIGHT)
    t = np.arange(0, 10, 1e-2)
    v = 0.1 * np.cos(np.pi * t)
    force = 3.0 * np.sign(v) + 20.0 * v + 0.01 * np.random.default_rng(1).standard_normal(len(t))
    own = fmm.force(t, velocity=v, force=force, model=[law, "coulomb+linear"])
    assert {model["model"] for model in own.document["models"]} == {"straight", "coulomb + linear"}
    campaign = fmm.batch(RUNS[:2], law=law, jobs=1, **MACHINE)
    assert set(campaign.to_frame()["law"]) == {"straight"}


SCENARIO = {
    "oscillator": {"mass": 2.0, "stiffness": 800.0},
    "normal_load": 10.0,
    "initial": {"position": 0.03},
    "duration": 1.598,
    "output": {"rate": 500.0},
}


def test_a_motion_under_it_is_simulated():
    law = fmm.Law("straight", straight, STRAIGHT)
    values = {"coefficient": 0.05, "viscous": 0.2}
    own = fmm.simulate({**SCENARIO, "law": {"straight": values}}, law=law)
    listed = fmm.simulate({**SCENARIO, "law": {"coulomb_viscous": values}})
    assert own.position == pytest.approx(listed.position, abs=1e-9 * 0.03)
    assert [event["kind"] for event in own.events] == [event["kind"] for event in listed.events]
    assert "law straight, engine runge_kutta" in str(own) and own.figures()


def test_what_was_simulated_is_found_again():
    law = fmm.Law("root", root, ROOT)
    motion = fmm.simulate({**SCENARIO, "law": {"root": {"coefficient": 0.05, "rise": 0.2}}}, law=[law])
    v = motion.velocity + 2e-4 * np.random.default_rng(1).standard_normal(len(motion.time))
    found = fmm.identify(motion.time, v, unit="m/s", mass=2, normal_load=10, law=law).findings
    level, rise = found["mu"], found["contact_rise"]
    assert abs(level.value - 0.05) < 3 * level.u < 0.01 and abs(rise.value - 2) < 3 * rise.u < 0.1


def test_a_simulation_says_what_it_cannot_take():
    law = fmm.Law("straight", straight, STRAIGHT)
    with pytest.raises(fmm.FmmError, match="the laws are straight, viscous"):
        fmm.simulate({**SCENARIO, "law": {"strait": {}}}, law=law)
    with pytest.raises(ValueError, match="from the oscillator"):
        fmm.simulate({**SCENARIO, "law": {"straight": {}}}, law=law.beside("linear"))

    def broken(v, coefficient, viscous):
        raise ZeroDivisionError("broken")

    scenario = {**SCENARIO, "law": {"broken": {"coefficient": 0.1, "viscous": 0.0}}}
    with pytest.raises(ZeroDivisionError, match="broken"):
        fmm.simulate(scenario, law=fmm.Law("broken", broken, STRAIGHT))


def test_its_functions_are_freed_with_it():
    def function(v, coefficient):
        return coefficient

    alive = weakref.ref(function)
    law = fmm.Law("level", function, STRAIGHT[:1])
    motion = fmm.simulate({**SCENARIO, "law": {"level": {"coefficient": 0.05}}}, law=law)
    del law, function
    gc.collect()
    assert alive() is not None and motion.figures()
    del motion
    gc.collect()
    assert alive() is None


def test_a_law_that_does_not_pickle_says_what_would():
    law = fmm.Law("level", lambda v, coefficient: coefficient, STRAIGHT[:1])
    with pytest.raises(
        pickle.PicklingError, match="'level' cannot be pickled, as its function is a lambda: define it by def"
    ):
        pickle.dumps(law)
    assert copy.copy(law) is law and copy.deepcopy(law) is law
    assert pickle.loads(pickle.dumps(fmm.Law("straight", straight, STRAIGHT))).function is straight


def test_faults_of_a_law_are_told(of_root):
    def broken(v, coefficient, viscous):
        raise ZeroDivisionError("broken")

    with pytest.raises(ZeroDivisionError, match="broken"):
        fmm.identify(RUNS[0], law=fmm.Law("broken", broken, STRAIGHT))
    with pytest.raises(ValueError, match="as long as its arguments"):
        fmm.identify(RUNS[0], law=fmm.Law("short", lambda v, a, b: np.zeros(7), STRAIGHT))
    with pytest.raises(ValueError, match="by the speed and by each parameter, 3"):
        fmm.identify(RUNS[0], law=fmm.Law("less", straight, STRAIGHT, derivatives=lambda v, a, b: [v]))
    with pytest.raises(fmm.FmmError):
        fmm.identify(RUNS[0], law=fmm.Law("pushes", lambda v, a, b: -a - b * v, STRAIGHT))
    with pytest.raises(ValueError, match="is a law of the list"):
        fmm.Law("coulomb", straight, STRAIGHT)
    with pytest.raises(ValueError, match="no name"):
        fmm.Law("a+b", straight, STRAIGHT)
    with pytest.raises(ValueError, match="two parameters called"):
        fmm.Law("twice", straight, [STRAIGHT[0], STRAIGHT[0]])
    with pytest.raises(ValueError, match="no role"):
        fmm.Law("own", straight, [fmm.Parameter("a", "levle")])
    with pytest.raises(fmm.FmmError, match="made of m, s"):
        fmm.identify(RUNS[0], law=fmm.Law("own", lambda v, a: a, [fmm.Parameter("a", "shape", "furlong")]))
