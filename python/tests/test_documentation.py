"""Examples in the documentation run, and say what comes out."""

import doctest
import importlib
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import equip

README = Path(__file__).parent.parent / "README.md"


@pytest.mark.parametrize(
    "name", ["_hamiltonian", "_functions", "_solve", "_steps", "_many.run", "_many.starts"]
)
def test_examples_of_docstrings(name):
    failed, tried = doctest.testmod(importlib.import_module(f"equip.{name}"))
    assert tried > 0 and failed == 0


ROOT = README.parent.parent


@pytest.mark.parametrize(
    "page", [README, ROOT / "README.md", ROOT / "docs" / "python.md", ROOT / "docs" / "brackets.md"], ids=str
)
def test_programs_of_the_pages(page):
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(blocks) >= (3 if page == README else 1)
    names = {}
    for block in blocks:
        exec(compile(block, page.name, "exec"), names)


def test_all_that_is_exported_is_documented():
    for name in set(equip.__all__) - {"__version__"}:
        assert getattr(equip, name).__doc__, name


def test_sources_without_their_native_part_say_so(tmp_path):
    sources = Path(equip.__file__).parent
    shutil.copytree(
        sources, tmp_path / "equip", ignore=shutil.ignore_patterns("*.so", "*.pyd", "__pycache__")
    )
    command = [sys.executable, "-c", "import equip"]
    ended = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert "start Python in another folder, where it finds the installed package" in ended.stderr


@pytest.mark.parametrize("folder", [README.parent, README.parent.parent, README.parent / "tests"])
def test_the_installed_package_is_found_in_the_folders_of_the_repository(folder):
    """Python puts the folder in which it is started before the installed packages."""
    program = "import equip; print(equip.Hamiltonian(lambda q, p: p @ p / 2, 1)([0.0], [2.0]))"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder)
    assert ended.stdout == "2.0\n", ended.stderr
    found = [path for path in folder.glob("equip*") if path.suffix == ".py" or path.is_dir()]
    assert not found
