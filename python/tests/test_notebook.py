"""Tests that the notebook in samples/notebooks runs from top to bottom and shows its pictures."""

import json
import subprocess
import sys

from conftest import SCENES

NOTEBOOK = SCENES.parent / "notebooks" / "depth_of_field.ipynb"


def test_the_notebook_runs(tmp_path):
    subprocess.run(
        [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", NOTEBOOK, "--output-dir", tmp_path],
        check=True,
    )
    cells = json.loads((tmp_path / NOTEBOOK.name).read_text())["cells"]
    outputs = [output for cell in cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 8
    text = "".join("".join(output.get("text", [])) for output in outputs)
    # The stated and the measured errors that the notebook prints must agree within 1 dB, plus 0.5 dB for the noise of
    # the reference.
    pairs = [line.split() for line in text.splitlines() if line.startswith("stated")]
    assert len(pairs) == 4
    for _, stated, _, _, measured, _ in pairs:
        assert abs(float(stated) - float(measured)) < 1.5
    assert all(not cell.get("outputs") for cell in json.loads(NOTEBOOK.read_text())["cells"])
