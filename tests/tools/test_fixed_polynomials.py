"""The coefficients in src/base/fixed.c and src/base/power_of_half.c are those that fixed_polynomials.py prints."""
import re
import subprocess
import sys

from conftest import ROOT


def test_coefficients_are_fresh():
    printed = subprocess.run([sys.executable, "-m", "tools.design.fixed_polynomials"], cwd=ROOT,
                             capture_output=True, text=True, check=True).stdout
    made = {abs(int(number)) for number in re.findall(r"^\s+(-?\d+)\s+Q\d+", printed, re.M)}
    source = "".join((ROOT / "src/base" / name).read_text(encoding="utf-8") for name in ("fixed.c", "power_of_half.c"))
    used = {int(number) for number in re.findall(r"\b(\d{6,10})u\b", source)}
    assert len(made) == 21
    assert used == made
