"""Arrays give what files give; results, refusals and interruptions are as the documentation says."""

import _thread
import json
import pickle
import signal
import threading
import time

import jsonschema
import numpy as np
import pytest

import fmm_friction as fmm
from conftest import EXAMPLES, MACHINE, ROOT, RUNS


@pytest.fixture(scope="module")
def run():
    return np.loadtxt(RUNS[0], delimiter=",", skiprows=1).T


@pytest.fixture(scope="module")
def found(run):
    return fmm.identify(*run, unit="m/s", law="coulomb_viscous", **MACHINE)


def test_arrays_give_what_a_file_gives(found):
    of_file = fmm.identify(RUNS[0], law="coulomb_viscous", **MACHINE)
    assert found.document["models"] == of_file.document["models"]
    assert found.findings["mu"] == of_file.findings["mu"]
    mu = found.findings["mu"]
    low, high = mu.interval_95
    assert mu.unit == "1" and low < mu.value < high and 0 < mu.u < 0.01 and float(mu) == mu.value


def test_lists_integers_and_views_are_taken(run):
    t, v = run
    first = fmm.identify(t, v, unit="m/s", law="coulomb")
    microns = fmm.identify(list(t), np.column_stack([v, v])[:, 0] * 1e6, unit="um/s", law=["coulomb"])
    assert microns.findings["friction_per_mass"].value == pytest.approx(first.findings["friction_per_mass"].value)


def test_a_rate_stands_for_times(run):
    t, v = run
    rate = (len(t) - 1) / (t[-1] - t[0])
    found = fmm.identify(None, v, rate=rate, unit="m/s", law="coulomb_viscous", **MACHINE)
    assert found.findings["mu"].value == pytest.approx(0.253, abs=1e-3)


def test_the_curve_is_the_record_and_its_fit(found, run):
    curve = found.curve
    assert curve.unit == "m/s" and len(curve.time) == len(curve.fitted) == found.document["preparation"]["samples"]
    assert np.array_equal(curve.residuals, found.residuals)
    assert np.std(found.residuals) == pytest.approx(found.document["models"][0]["rms_residual"], rel=0.05)
    assert np.isin(curve.measured, run[1]).all()


def test_results_are_shown_written_and_pickled(found, tmp_path):
    again = pickle.loads(pickle.dumps(found))
    assert again.to_json() == found.to_json() and str(again) == str(found)
    assert "mu" in str(found) and "mu" in found.findings and "mu = (" in repr(found.findings)
    again.report(tmp_path / "page.html")
    found.report(tmp_path / "other.html")
    page = (tmp_path / "page.html").read_text()
    assert page == (tmp_path / "other.html").read_text() and "Findings" in page
    figures = found.figures()
    assert {"fit.svg", "amplitude.svg", "residuals.svg"} <= set(figures)
    html = found._repr_html_()
    assert html.count("<svg") == len(figures) and "friction" in html
    assert len(found.save_figures(tmp_path / "figures")) == len(figures)


def test_a_frame_has_a_row_for_each_finding(found):
    frame = found.findings.to_frame()
    assert frame.loc["mu", "value"] == found.findings["mu"].value
    assert list(frame.columns) == ["value", "u", "low", "high", "unit", "status"]


def test_refusals_have_a_code_and_a_remedy_in_keywords(run):
    with pytest.raises(fmm.FmmError) as refused:
        fmm.identify(*run)
    assert refused.value.code == "unclear" and "unit=" in refused.value.remedy and "--" not in str(refused.value)
    again = pickle.loads(pickle.dumps(refused.value))
    assert (again.code, str(again)) == (refused.value.code, str(refused.value))
    with pytest.raises(ValueError, match="No such file"):
        fmm.identify("no_such_file.csv")
    with pytest.raises(fmm.FmmError, match="coulom"):
        fmm.identify(*run, unit="m/s", law="coulom")
    with pytest.raises(TypeError, match="did you mean channel"):
        fmm.identify(RUNS[0], chanel="v")
    with pytest.raises(ValueError, match="one length"):
        fmm.identify(run[0][:-1], run[1], unit="m/s")
    with pytest.raises(ValueError, match="one dimension"):
        fmm.identify(None, run, rate=1, unit="m/s")
    with pytest.raises(fmm.FmmError, match="no samples between"):
        fmm.identify(run[0], np.where(abs(run[0] - 0.6) < 0.1, np.nan, run[1]), unit="m/s")


def test_laws_are_compared(run):
    compared = fmm.compare(*run, unit="m/s", law=["viscous", "coulomb"])
    assert compared.preferred == "coulomb"
    assert "damping_per_mass" in compared.findings_of("viscous")
    with pytest.raises(KeyError, match="there are"):
        compared.findings_of("berger")


def test_records_of_one_machine_are_fitted_together(run, program):
    runs = [np.loadtxt(path, delimiter=",", skiprows=1).T for path in RUNS[:3]]
    law = {"unit": "m/s", "law": "coulomb_viscous"}
    loads = {"mass": 10.391, "normal_loads": [14, 14.5, 15], "normal_load_u": 0.07}
    of_files = fmm.identify(RUNS[:3], law="coulomb_viscous", mass=10.391, normal_loads=[14, 14.5, 15])
    line = "identify {} {} {} --law coulomb_viscous --mass 10.391 --normal-loads 14,14.5,15 --json"
    files = [path.relative_to(ROOT) for path in RUNS[:3]]
    assert of_files.document["models"] == json.loads(program(line.format(*files).split()))["models"]
    of_pairs = fmm.identify([[t, v] for t, v in runs], **law, mass=10.391, normal_loads=np.array([14, 14.5, 15]))
    of_names = fmm.identify(
        dict(zip("abc", ((t, v) for t, v in runs), strict=True)), **law, **loads | {"normal_load_u": None}
    )
    assert of_files.document["models"] == of_pairs.document["models"] == of_names.document["models"]
    assert len(of_pairs.curves) == 3 and len(of_pairs.curves[2].time) == len(of_pairs.curves[2].fitted)
    compared = fmm.compare([(t, v) for t, v in runs], unit="m/s", law=["viscous", "coulomb"])
    assert compared.preferred == "coulomb"
    with pytest.raises(fmm.FmmError, match="one for each record") as refused:
        fmm.identify([(t, v) for t, v in runs], **law, normal_loads=[14])
    assert refused.value.code == "contradiction"


def test_forces_are_fitted():
    rng = np.random.default_rng(1)
    t = np.arange(0, 10, 1e-2)
    v = 0.1 * np.cos(2 * np.pi * 0.5 * t)
    x = 0.1 / np.pi * np.sin(2 * np.pi * 0.5 * t)
    force = 3.0 * np.tanh(v / 1e-4) + 20.0 * v + 0.01 * rng.standard_normal(len(t))
    found = fmm.force(t, position=x, velocity=v, force=force, model="coulomb+linear")
    level = next(finding for name, finding in found.findings.items() if finding.unit == "N")
    assert level.value == pytest.approx(3.0, abs=0.02)
    assert np.nanstd(found.residuals) < 0.05 and len(found.curves) == 1
    schema = json.loads((ROOT / "docs/schemas/force-1.json").read_text())
    jsonschema.validate(json.loads(found.to_json(full=True)), schema)
    under_load = fmm.force(t, velocity=v, force=force, load=np.full(len(t), 10.0), model="coulomb+linear")
    assert any(abs(float(finding) - 0.3) < 0.01 for finding in under_load.findings.values())


def test_blows_are_averaged():
    rate, n = 1000.0, 2000
    t = np.arange(n) / rate
    force = np.where(t < 0.01, 100 * np.sin(np.pi * t / 0.01), 0.0)
    answer = np.exp(-6 * t) * np.sin(2 * np.pi * 40 * t)
    response = np.convolve(force, answer)[:n] / rate
    noise = np.random.default_rng(2).standard_normal((3, n)) * 1e-6
    found = fmm.frf(force=[force] * 3, response=response + noise, rate=rate, quantity="displacement")
    assert found.document["modes"][0]["natural_frequency_hz"]["value"] == pytest.approx(40, abs=0.1)
    assert found.h1.shape == found.frequencies.shape == found.coherence.shape
    with pytest.raises(ValueError, match="one shape"):
        fmm.frf(force=[force], response=[response[:-1]], rate=rate)


def test_all_modes_are_fitted_at_once(program):
    chain = "crates/fmm-frf/tests/data/chain_of_six.uff"
    found = fmm.frf(chain, modes=True, band=(1, 60), order=16)
    words = ["frf", chain, "--modes", "--band", "1", "60", "--order", "16", "--json"]
    assert found.to_json() == program(words).rstrip("\n")
    first = found.modes[0]["natural_frequency_hz"]
    assert first.unit == "Hz" and first.u is not None and len(found.to_frame()) == len(found.modes)
    near = fmm.frf(chain, modes=True, near=[first.value])
    assert len(near.modes) == 1 and near.modes[0]["natural_frequency_hz"].value == pytest.approx(first.value, rel=1e-3)


def test_documents_may_be_mappings():
    measurement = {
        "input": [{"name": "a", "unit": "m", "value": 2, "u": 0.1}],
        "result": [{"name": "y", "unit": "m", "formula": "3*a"}],
    }
    y = fmm.budget(measurement, trials=10_000).findings["y"]
    assert y.value == 6 and y.u == pytest.approx(0.3)
    measurement["result"][0]["tolerance"] = {"upper": 7}
    assert fmm.budget(measurement, trials=10_000).conformity["y"]["accepted"]
    scenario = {
        "oscillator": {"mass": 1, "stiffness": 100},
        "law": {"coulomb": {"mu": 0.1}},
        "normal_load": 1,
        "initial": {"position": 0.01},
        "duration": 2,
    }
    motion = fmm.simulate(scenario)
    assert (
        motion.position[0] == pytest.approx(0.01)
        and motion.time[-1] == pytest.approx(2)
        and motion.events[0]["kind"] == "start"
    )
    found = fmm.identify(motion.time, motion.velocity, unit="m/s", law="coulomb", mass=1, normal_load=1)
    assert found.findings["mu"].value == pytest.approx(0.1, rel=1e-3)
    with pytest.raises(TypeError, match="no page"):
        motion.report("page.html")


def test_a_folder_is_a_campaign(tmp_path):
    campaign = fmm.batch(EXAMPLES / "data/flexure", out=tmp_path / "campaign", jobs=1, **MACHINE)
    assert len(campaign.to_frame()) == len(RUNS) and campaign.consensus["mu"].u > 0
    assert (tmp_path / "campaign/campaign.json").read_text() == campaign.to_json()
    campaign.report(tmp_path / "campaign.html")
    jsonschema.validate(campaign.document, json.loads((ROOT / "docs/schemas/batch-1.json").read_text()))
    plan = fmm.design(from_=campaign)
    assert plan.chosen and "design.svg" in plan.figures()
    assert fmm.design(from_=fmm.identify(RUNS[0], law="coulomb_viscous", **MACHINE)).chosen


def test_arrays_and_frames_are_a_campaign():
    pandas = pytest.importorskip("pandas")
    records = {path.name: tuple(np.loadtxt(path, delimiter=",", skiprows=1).T) for path in RUNS[:3]}
    of_arrays = fmm.batch(records, unit="m/s", **MACHINE)
    files = [str(path.relative_to(ROOT)) for path in RUNS[:3]]
    frame = pandas.DataFrame({"file": files, "operator": ["a", "a", "b"], "mass": 10.391, "normal_load": 14.0})
    of_frame = fmm.batch(manifest=frame, group="operator")
    assert of_arrays.consensus["mu"].value == pytest.approx(of_frame.consensus["mu"].value, rel=1e-9)
    assert list(of_frame.to_frame()["operator"]) == ["a", "a", "b"]


def test_progress_is_told():
    told = []
    fmm.identify(
        "examples/data/single_pendulum_55s_1khz.csv",
        channel="theta_rad",
        pendulum=True,
        law="coulomb",
        progress=told.append,
    )
    assert told and any("step" in sentence or "friction" in sentence for sentence in told)


def test_ctrl_c_ends_a_search():
    # A shell that runs the tests in the background has them ignore the signal.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(1.0, _thread.interrupt_main)
    timer.start()
    begun = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            fmm.identify("examples/data/single_pendulum_55s_1khz.csv", channel="theta_rad", pendulum=True)
    finally:
        signal.signal(signal.SIGINT, handler)
    assert time.monotonic() - begun < 3
    timer.join()


def test_other_threads_go_on_meanwhile(run):
    results = []
    threads = [
        threading.Thread(target=lambda: results.append(fmm.identify(*run, unit="m/s", law="coulomb_viscous")))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({result.to_json() for result in results}) == 1 and len(results) == 4


def test_lists_name_laws_and_formats():
    assert "coulomb" in {law["name"] for law in fmm.laws()}
    assert "matlab" in {entry["name"] for entry in fmm.formats()}
