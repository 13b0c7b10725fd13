"""The examples of the README run as they stand, in a folder with the files that they name."""

import re
import shutil
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np
import pytest

import fmm_friction as fmm
from conftest import EXAMPLES, ROOT, RUNS

README = (Path(__file__).resolve().parents[1] / "README.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_the_examples_run(tmp_path, monkeypatch):
    pandas, io = pytest.importorskip("pandas"), pytest.importorskip("scipy.io")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(EXAMPLES)
    (tmp_path / "runs").mkdir()
    for path in RUNS[:3]:
        shutil.copy(path, tmp_path / "runs")
    t, v = np.loadtxt(RUNS[0], delimiter=",", skiprows=1).T
    v = v * 1e3  # The first task takes mm/s.
    motion = fmm.simulate(
        {
            "oscillator": {"mass": 1, "stiffness": 200},
            "law": {"coulomb": {"mu": 0.1}},
            "normal_load": 1,
            "initial": {"position": 0.02},
            "duration": 3,
        }
    )
    acceleration = np.gradient(motion.velocity, motion.time) / 9.80665
    io.savemat(tmp_path / "run.mat", {"t": motion.time, "accel": acceleration + 1e-4 * np.sin(np.arange(1000) ** 2)})
    lines = ["# header"] * 12 + ["t;velocity", *(f"{a};{b / 1e3}".replace(".", ",") for a, b in zip(t, v, strict=True))]
    (tmp_path / "odd.csv").write_text("\n".join(lines))
    files = [str(path.relative_to(ROOT)) for path in RUNS[:3]]
    clock = np.arange(0, 10, 0.01)
    speed = 0.1 * np.cos(np.pi * clock)
    force = 3 * np.tanh(speed / 1e-4) + 20 * speed + 0.01 * np.random.default_rng(1).standard_normal(len(clock))
    of_blocks = {
        "frame": pandas.DataFrame({"file": files, "operator": ["a", "a", "b"], "mass": 10.391, "normal_load": 14}),
        "t1": t,
        "v1": v / 1e3,
        "t2": t,
        "v2": v / 1e3 + 1e-5 * np.sin(t),
        "x": 100 / np.pi * np.sin(np.pi * clock),
        "f": force,
        "n": np.full(len(clock), 10.0),
    }
    names = {"t": t, "v": v, "plt": MagicMock(), "pandas": pandas, "np": np, "speeds": np.linspace(0, 0.2)}
    for block in BLOCKS:
        if "position=x" in block:
            names.update(t=clock, v=speed)
        if "fmm.Law" in block:
            names.update(t=t, v=v)
        if "read_csv" not in block:
            names.update(of_blocks)
        exec(block, names)
    assert len(BLOCKS) >= 7 and names["campaign"].consensus["mu"].value > 0
