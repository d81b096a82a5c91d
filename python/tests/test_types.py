"""Annotations: checked by mypy, and the stub of the native part against the module itself."""

import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).parent.parent / "pyproject.toml"


def test_annotations_hold():
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", PROJECT, "-p", "equip"],
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stdout + found.stderr


def test_the_stub_describes_the_native_part():
    found = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "equip", "--mypy-config-file", PROJECT],
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stdout + found.stderr
