"""The coefficients in src/base/fixed.c and src/base/power_of_half.c are those of fixed_polynomials.py."""
import re

from conftest import ROOT

from tools.design.fixed_polynomials import polynomials


def test_coefficients_are_fresh():
    made = [abs(number) for polynomial in polynomials() for number in polynomial.raw()]
    source = "".join((ROOT / "src/base" / name).read_text(encoding="utf-8") for name in ("fixed.c", "power_of_half.c"))
    used = {int(number) for number in re.findall(r"\b(\d{6,10})u\b", source)}
    assert len(made) == 21
    assert used == {*made}
