"""Tests that the module returns the same pictures, frames and figures as the command."""

import gc
import inspect
import json
import math
import re
import subprocess

import numpy as np
import pytest

import postlens


def test_a_picture_has_the_bits_of_the_command(frame, frame_path, command, tmp_path):
    picture = frame.focus(f_number=1.4, focus_m=2)
    assert picture.array.dtype == np.float32 and picture.array.shape == (54, 96, 3)
    assert picture.array.flags.c_contiguous and picture.array.flags.writeable
    out = tmp_path / "command.exr"
    subprocess.run(
        [command, "focus", frame_path, "-o", out, "--f-number", "1.4", "--focus", "2", "--quiet"], check=True
    )
    assert np.array_equal(picture.array, postlens.read_picture(out).array)
    # The second image must be equal although it is made from the records that the frame keeps in memory.
    assert np.array_equal(picture.array, frame.focus(f_number=1.4, focus_m=2).array)
    picture.save(tmp_path / "saved.jpg")  # written by the extension module, which has OpenImageIO
    assert postlens.read_picture(tmp_path / "saved.jpg").shape == picture.shape
    picture.save(tmp_path / "saved.exr")
    assert (tmp_path / "saved.exr").read_bytes() == out.read_bytes()


@pytest.mark.parametrize("method", ["scatter", "layers", "lightfield", "hybrid", "auto", "pinhole"])
def test_every_method(frame, frame_path, command, tmp_path, method):
    picture = frame.focus(f_number=2, focus_m=2, method=method)
    out = tmp_path / "command.exr"
    words = [command, "focus", frame_path, "-o", out, "--f-number=2", "--focus=2", "--method", method, "--json"]
    said = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    assert np.array_equal(picture.array, postlens.read_picture(out).array)
    for key, value in said.items():
        if key in ("seconds", "peak_memory_bytes"):
            continue
        assert picture.report[key] == value, key
    assert picture.geometry["method"] == said["method"]


def test_a_kept_frame_gives_the_same_for_other_exposures(frame, frame_path):
    for exposure in (0, 1, "auto", None):
        again = postlens.open(frame_path).focus(f_number=2, focus_m=2, exposure=exposure)
        assert np.array_equal(frame.focus(f_number=2, focus_m=2, exposure=exposure).array, again.array)
    bright, plain = (frame.image(exposure=stops).array for stops in (1, 0))
    assert np.allclose(bright, 2 * plain, rtol=1e-5)


def test_what_is_stated_holds(frame, bars):
    picture = frame.focus(f_number=1.4, focus_m=2, method="auto", scene=bars, target_db=35)
    low, high = picture.stated_range_db
    assert low < picture.stated_db < high and picture.stated_db > 35
    reference = postlens.render(bars, size=(96, 54), spp=1024, f_number=1.4, focus_m=2, seed=7)
    measured = postlens.compare(picture, reference)
    # The noise of 1024 rays per pixel adds at most 12 % (0.5 dB) to an error of 35 dB. The stated interval has a
    # confidence of 95 %. The margin of 1 dB covers both.
    assert low - 1 < measured["psnr_db"] < high + 1
    assert frame.focus(f_number=2, focus_m=2).stated_db is None


def test_crop(frame):
    whole = frame.focus(f_number=2, focus_m=2)
    part = frame.focus(f_number=2, focus_m=2, crop=(10, 5, 30, 20))
    assert part.shape == (20, 30, 3)
    assert np.array_equal(part.array, whole.array[5:25, 10:40])
    assert part.geometry["crop"] == {"x": 10, "y": 5, "width": 30, "height": 20}


def test_values_may_be_arrays(frame):
    """A position computed by numpy, or a number without dimensions, is as good as a tuple or a float."""
    right = frame.focus(f_number=2, focus_at=(40, 30), crop=(5, 6, 20, 10))
    arrays = frame.focus(f_number=np.array(2.0), focus_at=np.array([40, 30]), crop=np.array([5, 6, 20, 10]))
    assert np.array_equal(right, arrays)
    with pytest.raises(postlens.ArgumentError, match="^focus_at: wrong type .got ndarray;"):
        frame.focus(f_number=2, focus_at=np.zeros((2, 2)))
    with pytest.raises(postlens.ArgumentError, match="^focus_at: empty"):
        frame.focus(f_number=2, focus_at=np.zeros(0))


def test_alpha_is_the_fourth_channel(command, tmp_path):
    from conftest import SCENES

    deep = SCENES.parents[1] / "tests" / "data" / "exr" / "deep_alpha.exr"
    picture = postlens.open(deep).image()
    height, width, channels = picture.shape
    assert channels == 4
    assert 0 <= picture.array[:, :, 3].min() < picture.array[:, :, 3].max() <= 1
    out = tmp_path / "command.exr"
    subprocess.run([command, "image", deep, "-o", out, "--quiet"], check=True)
    picture.save(tmp_path / "saved.exr")
    assert (tmp_path / "saved.exr").read_bytes() == out.read_bytes()


def test_render_keeps_its_halves(bars):
    picture = postlens.render(bars, size=(48, 27), spp=8, seed=3, halves=True, f_number=2, focus_m=2)
    assert len(picture.halves) == 2
    mean = (picture.halves[0].array + picture.halves[1].array) / 2
    assert np.allclose(mean, picture.array, atol=1e-5)
    assert not np.array_equal(picture.halves[0].array, picture.halves[1].array)
    assert np.array_equal(picture.array, postlens.render(
        bars, size=(48, 27), spp=8, seed=3, halves=True, f_number=2, focus_m=2, threads=1).array)  # fmt: skip


def test_trace_for_rays_is_coarser():
    from conftest import SCENES

    lens = {"size": (96, 54), "for_f_number": 1.4, "for_focus_m": 2}
    records = [postlens.trace(SCENES / "bars.toml", for_rays=for_rays, **lens).trace_report["records"]
               for for_rays in (True, False)]  # fmt: skip
    assert records[0] < records[1]


def test_motion_blur_and_shoot(tmp_path):
    from conftest import SCENES

    frame = postlens.trace(SCENES / "motion.toml", size=(96, 54), for_shutter=(0, 0.5))
    blurred = frame.motionblur(shutter=(0, 0.5))
    assert blurred.geometry["shutter_close_s"] == 0.5
    assert not np.array_equal(blurred.array, frame.image().array)
    shot = frame.shoot(shutter=(0, 0.5), f_number=4, focus_m=3, views=16)
    assert shot.geometry["views"] == 16 and shot.shape == blurred.shape


def test_sweep_is_an_iterator_over_all_combinations(frame):
    pictures = frame.sweep(f_number=[1, 4], focus_m=(1.5, 2))
    assert inspect.isgenerator(pictures)
    with pytest.warns(postlens.PostlensWarning):  # the file is traced for f/1.4
        made = [(p.geometry["f_number"], p.geometry["focus_m"], p.array) for p in pictures]
    assert [m[:2] for m in made] == [(1, 1.5), (1, 2), (4, 1.5), (4, 2)]
    assert np.array_equal(made[3][2], frame.focus(f_number=4, focus_m=2).array)


def test_records_are_views(frame):
    records = frame.records()
    assert len(records) == frame.info["records"] == len(records.x) == records.offsets[-1]
    assert records.offsets.shape == (records.rows * records.columns + 1,)
    assert records.w.shape == (len(records), 2, 2)
    assert not records.x.flags.owndata and not records.x.flags.writeable
    assert records.x.dtype == np.float32 and records.id.dtype == np.uint32 and records.mark.dtype == np.uint8
    # The shading tree at a pixel must have the same nodes as the arrays.
    tree = frame.tree_at(40, 20)
    corner = [s for s in tree["samples"] if (s["x"], s["y"]) == (40, 20)][0]["nodes"][0]
    k = (20 - records.y_begin) * records.columns + 40 - records.x_begin
    first = slice(records.offsets[k], records.offsets[k + 1])
    at = np.flatnonzero((records.x[first] == 40) & (records.y[first] == 20) & (records.path[first] == 0))[0]
    at += first.start
    assert records.id[at] == corner["id"]
    assert [records.r[at], records.g[at], records.b[at]] == pytest.approx(corner["rgb"])
    assert records.z[at] == pytest.approx(corner["z_m"])
    assert records.w[at] == pytest.approx(np.array(corner["w_per_m"]))
    column = records.z
    del records
    gc.collect()
    assert np.isfinite(column[column < math.inf]).all()


def test_compare_names_its_arguments():
    image, reference = np.zeros((10, 12, 3)), np.zeros((8, 12, 3))
    with pytest.raises(postlens.InputError, match=r"^image: size differs from that of reference \(got 12x10; expected 12x8\)$"):
        postlens.compare(image, reference)
    assert postlens.compare(image, image)["text"].startswith("image against reference, 12x10 px")
    with pytest.raises(postlens.ArgumentError, match="^reference: has masked values"):
        postlens.compare(image, np.ma.masked_less(image, 1))


def test_compare_takes_arrays_of_any_order(frame, tmp_path):
    a, b = frame.focus(f_number=2, focus_m=2), frame.image()
    said = postlens.compare(a, b)
    mse = np.mean((srgb(a.array) - srgb(b.array)) ** 2)
    assert said["psnr_db"] == pytest.approx(-10 * math.log10(mse), abs=1e-3)
    for same in (a.array, a.array.astype(np.float64), np.asfortranarray(a.array), a.array[::-1][::-1],
                 a.array.astype(">f4"), a.array.astype(np.longdouble)):  # fmt: skip
        assert postlens.compare(same, b)["psnr_db"] == said["psnr_db"]
    b.save(tmp_path / "b.exr")
    assert postlens.compare(a, tmp_path / "b.exr")["psnr_db"] == said["psnr_db"]


def srgb(linear):
    v = np.clip(linear.astype(np.float64), 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


def test_lens(tmp_path):
    coc = postlens.lens.coc(focal_length_mm=50, f_number=2, focus_m=2, depth_m=3)
    # Diameter of the circle of confusion [Potmesil and Chakravarty]: |z - s| / z * F^2 / (n (s - F)).
    assert coc["coc_mm"] == pytest.approx((3 - 2) / 3 * 50**2 / (2 * (2000 - 50)))
    dof = postlens.lens.dof(focal_length_mm=50, f_number=2, focus_m=2)
    assert dof["near_m"] < 2 < dof["far_m"]
    psf = postlens.lens.psf(focal_length_mm=50, f_number=2, focus_m=2, depth_m=3, size_px=33)
    assert psf.shape == (33, 33, 3)
    assert 0.9 < psf.array[:, :, 0].sum() < 1.001


def test_any_other_command(frame_path, command):
    assert postlens.run("info", frame_path)["kind"] == "samples"
    assert "Usage: postlens focus" in postlens.run("focus", "--help")["text"]


def test_png_in_a_notebook(frame):
    picture = frame.image()
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert re.fullmatch(r"<postlens.Picture 96x54.*>", repr(picture))
    assert np.asarray(picture) is picture.array


def test_keywords_are_the_commands_options(command):
    """Tests that every option of a command that makes a picture has a keyword, and that every keyword has an option."""
    from postlens._command import option_name

    left_out = {"--help", "--json", "--quiet", "--output", "--frames", "--keep", "--fps", "--resume",
                "--share", "--share-by", "--dry-run", "--requeue-code"}  # fmt: skip
    of_frame = {"--salvage"}  # an option of Frame itself
    for name, call in (
        ("focus", postlens.Frame.focus), ("shoot", postlens.Frame.shoot),
        ("motionblur", postlens.Frame.motionblur), ("trace", postlens.trace), ("render", postlens.render),
    ):  # fmt: skip
        text = subprocess.run([command, name, "--help"], check=True, capture_output=True, text=True).stdout
        options = set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", text, re.M)) - left_out - of_frame
        keywords = {
            option_name(k)
            for k in inspect.signature(call).parameters
            if k not in ("self", "progress", "scene" if name in ("trace", "render") else "", "output")
        }
        assert keywords == options, name
