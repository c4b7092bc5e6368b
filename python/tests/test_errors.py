"""Tests that a failure raises the right kind of exception with one clear line of text, and leaves no incomplete
file."""

import fractions
import math
import os
import pickle
import shutil

import numpy as np
import pytest

import postlens


def test_kinds_of_errors(frame, tmp_path):
    with pytest.raises(postlens.ArgumentError, match="^f_number: out of range") as caught:
        frame.focus(f_number=-1, focus_m=2)
    assert caught.value.exit_code == 2 and isinstance(caught.value, ValueError)
    with pytest.raises(postlens.ArgumentError, match="^focus_m: out of range"):
        frame.focus(f_number=2, focus_m=0)
    with pytest.raises(postlens.ArgumentError, match="^--focus: out of range"):
        postlens.run("focus", frame.path, "-o", "x.exr", "--f-number", "2", "--focus", "0")
    with pytest.raises(postlens.InputError, match="no such file") as caught:
        postlens.open(tmp_path / "missing.exr")
    assert caught.value.exit_code == 3 and isinstance(caught.value, OSError)
    with pytest.raises(postlens.OutputError) as caught:
        frame.image().save("/proc/nowhere/x.exr")
    assert caught.value.exit_code == 4 and isinstance(caught.value, OSError)
    with pytest.raises(postlens.OutOfMemoryError) as caught:
        postlens.render(frame_scene(), size=(65536, 65536), spp=1)
    assert isinstance(caught.value, MemoryError) and isinstance(caught.value, postlens.Error)
    assert "\n" not in str(caught.value)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value) and again.exit_code == 5


def frame_scene():
    from conftest import SCENES

    return SCENES / "bars.toml"


@pytest.mark.parametrize("bad", [math.nan, 0, -1, 1e400 * 0, "two", b"2", object(), 2j, True, False, np.True_,
                                 np.array(True), np.array(math.nan), np.zeros((2, 2)), fractions.Fraction(10**400)])  # fmt: skip
def test_wrong_f_numbers(frame, bad):
    for make in (frame.focus, lambda **options: next(frame.sweep(**options))):
        with pytest.raises(postlens.ArgumentError, match="^f_number: .*expected") as caught:
            make(f_number=bad, focus_m=2)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name, bad", [
    ("threads", -1), ("threads", 2.5), ("threads", True), ("threads", 10**9), ("progress", 3), ("views", 0),
    ("crop", (0, 0, 0, 0)), ("crop", (90, 50, 20, 20)), ("crop", 3), ("method", "magic"), ("focus_at", (1e9, 0)),
    ("scene", ""), ("exposure", "much"), ("predict", 1), ("strict", "no"), ("views", False), ("crop", False),
    ("f_number", [1, 2]),
    ("focus_at", (True, 3)), ("threads", np.zeros((2, 2))),
])  # fmt: skip
def test_wrong_arguments(frame, name, bad):
    with pytest.raises(postlens.Error) as caught:
        frame.focus(**{"f_number": 2, "focus_m": 2, name: bad} if name != "focus_at" else
                    {"f_number": 2, name: bad})  # fmt: skip
    assert str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("bad", [
    np.zeros((4, 4)), np.zeros((4, 4, 2), np.float32), np.zeros((4, 4, 3), np.uint8), np.zeros((0, 4, 3)),
    np.zeros((4, 4, 3), complex), None, "", [[1, 2], [3]],
])  # fmt: skip
def test_wrong_pictures(bad, frame):
    with pytest.raises((postlens.Error, ValueError)):
        postlens.compare(bad, frame.image())


def test_files_that_are_none(tmp_path):
    (tmp_path / "empty.exr").write_bytes(b"")
    (tmp_path / "text.exr").write_text("hello")
    for path in (tmp_path, tmp_path / "empty.exr", tmp_path / "text.exr", "/dev/null", "", None, 3, b"x"):
        with pytest.raises(postlens.Error) as caught:
            postlens.open(path)
        assert "\n" not in str(caught.value)


def test_a_truncated_frame(frame_path, tmp_path):
    whole = open(frame_path, "rb").read()
    cut = tmp_path / "cut.exr"
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    with pytest.raises(postlens.InputError):
        postlens.open(cut).focus(f_number=2, focus_m=2)
    with pytest.warns(postlens.PostlensWarning) as caught:
        postlens.open(cut, salvage=True).focus(f_number=2, focus_m=2)
    assert any(w.message.code == "salvaged" for w in caught)


def test_names_of_files_need_not_be_text(frame, frame_path, tmp_path):
    name = os.fsdecode(bytes(tmp_path) + b"/caf\xe9.exr")
    os.link(frame_path, name)
    other = postlens.open(name)
    assert np.array_equal(other.focus(f_number=2, focus_m=2), frame.focus(f_number=2, focus_m=2))
    assert len(other.records()) == len(frame.records())
    frame.image().save(os.fsdecode(bytes(tmp_path) + b"/\xff.exr"))
    with pytest.raises(postlens.InputError, match="^.*\udce9.exr: cannot read"):
        postlens.read_picture(os.fsdecode(b"nope\xe9.exr"))
    with pytest.raises(postlens.ArgumentError, match="NUL"):
        postlens.open(frame_path + "\0")
    with pytest.raises(postlens.ArgumentError, match="NUL"):
        postlens.run("focus", frame_path, "-o", str(tmp_path / "a.png\0.exr"), "--f-number", "2")
    with pytest.raises(postlens.ArgumentError, match="NUL"):
        frame.image().save(str(tmp_path / "a\0.png"))


def test_errors_are_one_line(frame):
    with pytest.raises(postlens.Error) as error:
        postlens.open("no\nsuch\tfile")
    assert "\n" not in str(error.value) and "\t" not in str(error.value)


@pytest.mark.parametrize("wrong", [{"f_number": True}, {"views": True}, {"passes": []}, {"method": ""}])
def test_an_option_without_a_value_takes_no_other_word(frame, wrong):
    right = {"f_number": 2, "focus_m": 3}
    with pytest.raises(postlens.ArgumentError) as error:
        frame.focus(**{**right, **wrong})
    said = str(error.value)
    assert "focus" not in said.replace("(see postlens focus --help)", "")
    assert "focus help" not in said


def test_a_flag_is_a_truth_value(frame):
    right = {"f_number": 2, "focus_m": 3}
    without, breathing = frame.focus(**right).array, frame.focus(**right, breathing=True).array
    assert np.array_equal(frame.focus(**right, breathing=np.False_).array, without)
    assert np.array_equal(frame.focus(**right, breathing=np.True_).array, breathing)
    for wrong in (0, 1, "no", "false"):
        with pytest.raises(postlens.ArgumentError, match="^breathing: wrong type"):
            frame.focus(**right, breathing=wrong)


def test_a_frame_is_that_of_one_file(frame_path, tmp_path):
    path = tmp_path / "copy.exr"
    shutil.copy(frame_path, path)
    frame = postlens.open(path)
    first = frame.focus(f_number=2, focus_m=2)
    os.remove(path)  # the records are still in memory
    assert np.array_equal(frame.focus(f_number=2, focus_m=2), first)
    postlens.trace(frame_scene(), output=path, size=(20, 10))
    for call in (lambda: frame.focus(f_number=2, focus_m=2), frame.records, lambda: frame.tree_at(1, 1)):
        with pytest.raises(postlens.InputError, match="has changed since it was opened"):
            call()


def test_numbers_may_be_those_of_numpy(frame):
    made = list(frame.sweep(f_number=np.array(2.0), focus_m=np.int64(3)))
    assert [picture.geometry["f_number"] for picture in made] == [2]
    with pytest.raises(postlens.ArgumentError, match="^key: out of range"):
        frame.records(key=2**64)
    for stops in (200, math.nan, "auto"):
        with pytest.raises(postlens.ArgumentError, match="^exposure_stops: out of range"):
            postlens.Picture(np.ones((2, 2, 3), np.float32), exposure_stops=stops).save("x.exr")


def test_warnings_name_the_users_line(frame):
    with pytest.warns(postlens.PostlensWarning, match="traced for f-numbers") as caught:
        frame.focus(f_number=1, focus_m=2)
    assert caught[0].filename == __file__
    assert caught[0].message.code == "insufficient"


def test_a_failed_trace_leaves_nothing(tmp_path):
    with pytest.raises(postlens.Error):
        postlens.trace(tmp_path / "missing.toml", output=tmp_path / "x.exr")
    assert os.listdir(tmp_path) == []


def test_a_picture_that_no_one_would_get_is_an_error():
    with pytest.raises(postlens.ArgumentError, match="output"):
        postlens.run("render", frame_scene(), "--size", "4x4", "--spp", "1", "--f-number", "2", "--focus", "2")
