"""Paths of the repository, and the program as another process."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
RUNS = sorted((EXAMPLES / "data/flexure").glob("run_*.csv"))
MACHINE = {"mass": 10.391, "mass_u": 0.005, "normal_load": 14, "normal_load_u": 0.07}


@pytest.fixture(autouse=True)
def _in_the_repository(monkeypatch):
    """Paths of the golden documents are relative to the repository."""
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="session")
def program():
    """The program's standard output for a line of arguments; skipped where it was not built."""
    path = Path(os.environ.get("FMM_PROGRAM", ROOT / "target/debug/fmm"))
    if not path.exists():
        pytest.skip(f"no program at {path}: build it by cargo build -p fmm-cli, or name it by FMM_PROGRAM")

    def run(arguments):
        return subprocess.run([path, *arguments], capture_output=True, text=True, cwd=ROOT, check=False).stdout

    return run
