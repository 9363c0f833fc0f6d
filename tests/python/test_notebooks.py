"""The notebooks run from top to bottom, and what they say in the end holds."""
import base64
import os

import nbformat
import pytest
from conftest import ROOT, SITE
from nbclient import NotebookClient

NOTEBOOKS = sorted((ROOT / "tools/python/notebooks").glob("*.ipynb"))
PNG = b"\x89PNG"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_and_shows_pictures_and_tables(path, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", f"{SITE}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs are made by running it, not kept"
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any(base64.b64decode(output["data"].get("image/png", "")).startswith(PNG) for output in outputs
               if "data" in output)
    assert any(output.output_type == "stream" and " J" in output.text for output in outputs)
    assert "assert " in notebook.cells[-1].source


def test_there_is_one_for_each_paper():
    assert [path.stem for path in NOTEBOOKS] == ["gao2018", "patrol", "zhang2018"]
