import os
import pathlib

import pytest

import postlens

SCENES = pathlib.Path(__file__).resolve().parents[2] / "samples" / "scenes"


@pytest.fixture(scope="session")
def bars() -> str:
    return str(SCENES / "bars.toml")


@pytest.fixture(scope="session")
def frame_path(bars, tmp_path_factory) -> str:
    path = str(tmp_path_factory.mktemp("frame") / "bars.exr")
    postlens.trace(bars, output=path, size=(96, 54), for_f_number=1.4, for_focus_m=2, overscan_px="auto")
    return path


@pytest.fixture
def frame(frame_path) -> postlens.Frame:
    return postlens.open(frame_path)


@pytest.fixture(scope="session")
def large_frame(bars) -> postlens.Frame:
    return postlens.trace(bars, size=(960, 540))


@pytest.fixture
def command():
    """The program postlens of the same build."""
    return os.environ["POSTLENS_PROGRAM"]
