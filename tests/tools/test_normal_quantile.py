"""The table in src/learn/normal_quantile.c is the one that normal_quantile.py makes, and as good as the header says."""
import re
from statistics import NormalDist

import pytest
from conftest import ROOT, run_tool

from tools.design import normal_quantile

STATED_ERROR = 0.001


def test_table_is_fresh():
    source = (ROOT / "src/learn/normal_quantile.c").read_text(encoding="utf-8")
    table = re.search(r"quantiles\[\] = \{(.*?)\}", source, re.S)[1]
    assert [int(number) for number in re.findall(r"\d+", table)] == normal_quantile.table()


def test_error_is_as_stated():
    assert 0 < normal_quantile.largest_error(normal_quantile.table()) < STATED_ERROR
    assert run_tool("design.normal_quantile").returncode == 0


def test_entries_halve_the_tail_every_octave():
    assert normal_quantile.tail(0) == 0.5
    for entry in range(1, 60):
        assert normal_quantile.tail(entry + normal_quantile.STEPS) == normal_quantile.tail(entry) / 2
    assert normal_quantile.quantile(normal_quantile.tail(8)) == pytest.approx(NormalDist().inv_cdf(0.75))
