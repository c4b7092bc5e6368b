import os
import pathlib
import signal
import subprocess
import urllib.parse

import pytest

PROGRAM = os.environ["POSTLENS_PROGRAM"]
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = str(ROOT / "samples" / "scenes" / "bars.toml")
DEEP = str(ROOT / "tests" / "data" / "exr" / "deep_alpha.exr")


def traced(scene, path, size):
    subprocess.run([PROGRAM, "trace", scene, "-o", path, "--size", size, "--for-f-number", "1.4", "--for-focus", "5",
                    "--overscan", "auto", "--quiet"], check=True)  # fmt: skip
    return path


@pytest.fixture(scope="session")
def frame(tmp_path_factory):
    # Of few pixels, because most tests of the page wait for the best picture. The name has a space, for what is copied as a
    # command.
    return traced(SCENE, str(tmp_path_factory.mktemp("frame") / "a frame.exr"), "120x68")


@pytest.fixture(scope="session")
def flat(frame, tmp_path_factory):
    """The frame as another program would write it: colour, depth and a Cryptomatte."""
    path = str(tmp_path_factory.mktemp("flat") / "flat.exr")
    subprocess.run([os.environ["POSTLENS_EXPORT"], frame, path, "most", "cryptomatte"], check=True)
    return path


class Viewer:
    def __init__(self, *words):
        self.process = subprocess.Popen([PROGRAM, "view", *words], stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        parts = urllib.parse.urlsplit(self.url)
        self.host, self.port, self.path = parts.hostname, parts.port, parts.path

    def close(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(20)


@pytest.fixture(scope="session")
def viewer(frame):
    made = Viewer(frame, SCENE)
    yield made
    assert made.close() == 0
