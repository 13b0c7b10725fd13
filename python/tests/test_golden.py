"""Documents are those of the program to the last bit, on the lines of the golden documents, and fit their schemas."""

import json
import shlex

import jsonschema
import pytest

import fmm_friction as fmm
from conftest import ROOT

GOLDEN = ["commands", "designs", "forces", "records_by_law", "simulations", "impacts"]
#: The budget of a plan, and commands that take a minute, are left to the tests of the program.
LINES = [
    line
    for name in GOLDEN
    for line in json.loads((ROOT / f"tests/data/golden/{name}.json").read_text())
    if line.split()[0] in ("identify", "compare", "backbone", "budget", "frf", "force", "design", "simulate")
]
RUNS = " ".join(f"examples/data/flexure/run_{number}.csv" for number in (1, 2, 3))
#: Several records of one machine, each under its load.
LINES.append(f"identify {RUNS} --law coulomb_viscous --mass 10.391 --normal-loads 14,14.5,15")
LINES.append(f"compare {RUNS} --law viscous,coulomb --normal-load 14")
FLAGS = {"posterior", "repair", "turn-sign"}


def called(line):
    """The call of the package that a line of the program is: command, files, keywords."""
    command, *words = shlex.split(line)
    files, keywords = [], {}
    while words:
        word = words.pop(0)
        if not word.startswith("--"):
            files.append(word)
            continue
        name, sign, value = word[2:].partition("=")
        if not sign and name not in FLAGS and words and not words[0].startswith("--"):
            value = words.pop(0)
        key = {"from": "from_"}.get(name, name.replace("-", "_"))
        if key == "hold":
            held, _, number = value.partition("=")
            keywords.setdefault("hold", {})[held] = float(number)
        else:
            keywords[key] = value or True
    return command, files, keywords


def answer(line):
    command, files, keywords = called(line)
    function = getattr(fmm, command)
    if command in ("identify", "compare") and len(files) > 1:
        return function(files, **keywords)
    if command in ("force", "frf"):
        if "channels" in keywords:
            keywords["channels"] = keywords["channels"].split(",")
        return function(files, **keywords)
    return function(*files, **keywords)


@pytest.mark.parametrize("line", LINES)
def test_documents_are_those_of_the_program(line, program):
    words = shlex.split(line)
    assert answer(line).to_json() == program([*words, "--json"]).rstrip("\n")


@pytest.mark.parametrize("line", LINES)
def test_documents_fit_their_schemas(line):
    document = answer(line).document
    schema = json.loads((ROOT / f"docs/schemas/{document['schema']}.json").read_text())
    jsonschema.validate(document, schema)


def test_a_full_document_fits_as_well(program):
    result = fmm.identify("examples/data/flexure/run_1.csv", law="coulomb_viscous")
    document = json.loads(result.to_json(full=True))
    jsonschema.validate(document, json.loads((ROOT / "docs/schemas/identify-1.json").read_text()))
    line = "identify examples/data/flexure/run_1.csv --law coulomb_viscous --json=full"
    assert result.to_json(full=True) == program(line.split()).rstrip("\n")


@pytest.mark.parametrize("line", ["laws", "formats", "identify no_such_file.csv", "identify --no-such-option"])
def test_other_documents_of_the_program_fit(line, program):
    document = json.loads(program([*line.split(), "--json"]))
    jsonschema.validate(document, json.loads((ROOT / f"docs/schemas/{document['schema']}.json").read_text()))
