"""Finds the module that the tests share. These tests are for with_vcan.sh, but for test_vcan_results.py."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
