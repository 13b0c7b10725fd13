"""The notebooks run from top to bottom, and the comparison with SciPy says what the documentation says."""

import subprocess
import sys
from pathlib import Path

import pytest

PYTHON = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize("path", sorted((PYTHON / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs(path):
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient")
    notebook = nbformat.read(path, as_version=4)
    client.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    assert all(not cell.get("outputs") for cell in nbformat.read(path, as_version=4).cells), "kept without outputs"


def test_scipy_finds_the_same():
    pytest.importorskip("scipy")
    run = subprocess.run([sys.executable, PYTHON / "compare/scipy_fit.py"], capture_output=True, text=True, check=True)
    scipy, ours = (float(line.split("mu = ")[1].split(",")[0]) for line in run.stdout.splitlines()[:2])
    assert scipy == pytest.approx(ours, abs=5e-5), run.stdout
