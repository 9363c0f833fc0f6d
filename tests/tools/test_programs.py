"""The tools as programs: help, and the exit status of a wrong command line."""
import contextlib
import io
import runpy
import warnings
from types import SimpleNamespace
from unittest import mock

import pytest
from conftest import assert_one_line_error

PROGRAMS = ["measure.bench_plan", "measure.figures", "design.gain_design", "design.identify", "design.import_map",
            "design.lattice", "identify.log_identify", "operate.excite", "report.navigate_report",
            "report.patrol_report", "report.plan_report", "report.report"]


def run(name, option):
    """As python -m does it, but in this process, where NumPy is imported already."""
    out, err = io.StringIO(), io.StringIO()
    with (mock.patch("sys.argv", [name, option]), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err),
          warnings.catch_warnings(), pytest.raises(SystemExit) as end):
        warnings.simplefilter("ignore", RuntimeWarning)  # that the module is imported too
        runpy.run_module(f"tools.{name}", run_name="__main__")
    return SimpleNamespace(returncode=end.value.code, stdout=out.getvalue(), stderr=err.getvalue())


@pytest.mark.parametrize("name", PROGRAMS)
def test_help_and_wrong_options(name):
    assert run(name, "--help").stdout.startswith("usage:")
    assert_one_line_error(run(name, "--nonsense"))
