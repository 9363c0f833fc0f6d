"""What the tests of the image share: tests/programs.py, and that each worker has a CPU."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from programs import stay_on_one_cpu  # noqa: E402


@pytest.fixture(scope="session", autouse=True)
def fixture_one_cpu():
    stay_on_one_cpu()
