"""The page for users of other packages: each section runs where that package is installed, and both agree."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "coming-from.md"
SECTIONS = dict(
    re.findall(r"^## From (\w+)\n(.*?)(?=^## |\Z)", PAGE.read_text(encoding="utf-8"), re.M | re.S)
)


@pytest.mark.parametrize("name", ["SciPy", "heyoka", "REBOUND", "diffrax"])
def test_both_programs_agree(name):
    if importlib.util.find_spec(name.lower()) is None:
        pytest.skip(f"{name} is not installed")
    names = {}
    theirs, ours = re.findall(r"```python\n(.*?)```", SECTIONS[name], re.S)
    for block in (theirs, ours):
        exec(compile(block, PAGE.name, "exec"), names)
        # The figure beside the last line of a program is its error, within a factor of 10.
        stated = re.search(r"error = .*  # (\S+)$", block.rstrip().splitlines()[-1])
        if stated:
            error = float(names["error"])
            print(name, error)
            assert error < 10 * float(stated[1])
    if name == "SciPy":
        roots, found = names["ours"].t_events[0], names["theirs"].t_events[0]
        assert np.abs(roots - np.pi * (2 * np.arange(10) + 1)).max() < 1e-10
        assert np.abs(roots - found).max() < 1e-7


def test_every_section_is_here():
    assert set(SECTIONS) == {"SciPy", "heyoka", "REBOUND", "diffrax"}
