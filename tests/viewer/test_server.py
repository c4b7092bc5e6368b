"""Who may ask the viewer's server, and for what; hostile requests get 4xx or are cut and harm nothing."""

import concurrent.futures
import http.client
import json
import os
import re
import signal
import socket
import struct
import subprocess
import time

import pytest

from conftest import DEEP, PROGRAM, ROOT, SCENE, Viewer, traced


UNWRITTEN = f"/tmp/postlens-viewer-test-{os.getpid()}"  # a file that no request may write


def get(viewer, path, **headers):
    connection = http.client.HTTPConnection(viewer.host, viewer.port, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer, body


def is_well(viewer):
    return get(viewer, viewer.path + "frame")[0].status == 200


@pytest.fixture(scope="module", autouse=True)
def behind_idle_connections(frame):
    """Whether a viewer answers behind 200 connections that say nothing, and after how many seconds.

    32 at a time are cut after 2 s. The other tests run meanwhile, because 14 s of waiting take no processor."""
    made = Viewer(frame)

    def answer():
        idle = [socket.create_connection((made.host, made.port)) for _ in range(200)]
        started = time.monotonic()
        well = is_well(made)
        seconds = time.monotonic() - started
        for connection in idle:
            connection.close()
        return well, seconds

    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        yield executor.submit(answer)
    assert made.close() == 0


def test_the_address_is_the_result_and_the_viewer_ends_at_once(frame):
    words = [PROGRAM, "view", frame, "--json", "--quiet"]

    def printed(_):
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
            text = "".join(iter(process.stdout.readline, "}\n")) + "}"
            process.send_signal(signal.SIGINT)
            try:
                assert process.communicate(timeout=30)[0] == ""
            finally:
                process.kill()
        return json.loads(text)["address"]

    # Many at a time, so that the signal often arrives before the server accepts connections.
    with concurrent.futures.ThreadPoolExecutor(8) as executor:
        for address in executor.map(printed, range(80)):
            assert address.startswith("http://127.0.0.1:")


def test_the_address_is_local_and_secret(viewer):
    assert viewer.host == "127.0.0.1"
    assert len(viewer.path.strip("/")) == 32
    # Nothing listens on other addresses of this machine.
    with open("/proc/net/tcp") as table:
        listening = [line.split()[1] for line in table.readlines()[1:] if line.split()[3] == "0A"]
    assert [a for a in listening if a.endswith(f":{viewer.port:04X}")] == [f"0100007F:{viewer.port:04X}"]


def test_the_page_loads_nothing_from_elsewhere(viewer):
    for name in ("", "viewer.css", "viewer.js"):
        answer, body = get(viewer, viewer.path + name)
        assert answer.status == 200
        assert b"http://" not in body and b"https://" not in body and b"//cdn" not in body
        policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy
        assert answer.headers["Cache-Control"] == "no-store"
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert "Access-Control-Allow-Origin" not in answer.headers


@pytest.mark.parametrize("path", [
    "/", "/frame", "//frame", "/" + "0" * 32 + "/", "/" + "0" * 32 + "/frame", "/../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
    "/index.html", "/favicon.ico",
])  # fmt: skip
def test_without_the_token_nothing_is_there(viewer, path):
    answer, body = get(viewer, path)
    assert answer.status == 404 and body == b"not here\n"


@pytest.mark.parametrize("name", ["../frame", "..%2f..%2fetc/passwd", "viewer.js/..", "nothing", "%00", "frame/", "etc/passwd"])
def test_with_the_token_only_its_own_names(viewer, name):
    assert get(viewer, viewer.path + name)[0].status in (400, 404)


def test_other_pages_and_names_of_hosts_are_refused(viewer):
    for headers in (
        {"Host": "evil.example"}, {"Host": f"127.0.0.1.evil.example:{viewer.port}"}, {"Host": ""},
        {"Host": "localhost:80@evil.example"}, {"Origin": "http://evil.example"}, {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"},
    ):  # fmt: skip
        assert get(viewer, viewer.path + "frame", **headers)[0].status in (400, 404), headers
    # Through ssh -L the port is another one.
    for host in ("localhost:9000", "127.0.0.1", f"[::1]:{viewer.port}"):
        assert get(viewer, viewer.path + "frame", Host=host)[0].status == 200
        assert get(viewer, viewer.path + "frame", Host=host, Origin="http://" + host)[0].status == 200


def test_a_picture_has_the_values_of_the_command(viewer, frame, tmp_path):
    answer, body = get(viewer, viewer.path + "picture?f-number=2&focus=3&method=lightfield&views=16")
    assert answer.status == 200
    length = struct.unpack_from("<I", body)[0]
    report = json.loads(body[4 : 4 + length])
    assert (report["width"], report["height"], report["views"]) == (120, 68, 16)
    halves = body[(4 + length + 3) // 4 * 4 :]
    assert len(halves) == 120 * 68 * 3 * 2
    out = tmp_path / "x.exr"
    subprocess.run([PROGRAM, "focus", frame, "-o", out, "--f-number", "2", "--focus", "3", "--method", "lightfield", "--views",
                    "16", "--quiet"], check=True)  # fmt: skip
    saved, file = get(viewer, viewer.path + "save?format=exr&f-number=2&focus=3&method=lightfield&views=16")
    assert saved.status == 200 and file == out.read_bytes()


def test_a_coarse_picture_is_that_of_the_frame_with_wider_pixels(tmp_path):
    large = tmp_path / "large.exr"
    subprocess.run([PROGRAM, "trace", SCENE, "-o", large, "--size", "561x271", "--quiet"], check=True)
    made = Viewer(str(large))
    lens = "?method=scatter&f-number=1.4&focus=2"
    pictures = []
    for what in ("coarse", "picture"):
        answer, body = get(made, made.path + what + lens)
        assert answer.status == 200
        length = struct.unpack_from("<I", body)[0]
        report = json.loads(body[4 : 4 + length])
        width, height = report["width"], report["height"]
        assert (width, height, report.get("by", 1)) == ((280, 135, 2) if what == "coarse" else (561, 271, 1))
        pictures.append(struct.unpack_from(f"<{width * height * 3}e", body, (4 + length + 3) // 4 * 4))
    for wrong in ("&crop=0,0,9,9", "&focus-at=3,4", "&f-number=0"):
        assert get(made, made.path + "coarse" + lens + wrong)[0].status == 400
    assert made.close() == 0
    coarse, fine = pictures

    def difference(dx, dy):
        """Of the coarse picture from the fine one, shifted by whole pixels, inside a border."""
        total = 0
        for y in range(2, 133):
            for x in range(2, 278):
                at = 3 * (561 * (2 * y + dy) + 2 * x + dx)
                mean = sum(fine[at + step] for step in (0, 3, 3 * 561, 3 * 561 + 3)) / 4
                total += abs(coarse[3 * (280 * y + x)] - mean)
        return total

    assert all(difference(0, 0) < difference(dx, dy) for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)))


def coarse_width(frame, query):
    """Of a coarse picture and of its pixels, px."""
    made = Viewer(str(frame))
    answer, body = get(made, made.path + "coarse?" + query)
    assert made.close() == 0
    assert answer.status == 200, body[:200]
    report = json.loads(body[4 : 4 + struct.unpack_from("<I", body)[0]])
    return report["width"], report["by"]


def test_a_frame_of_few_pixels_and_many_records_has_a_coarse_picture_too(tmp_path):
    deep = tmp_path / "deep.exr"
    subprocess.run([PROGRAM, "trace", SCENE, "-o", deep, "--size", "480x300", "--hidden-layers", "4", "--quiet"], check=True)
    assert coarse_width(deep, "method=scatter&f-number=2&focus=3") == (240, 2)


def test_a_coarse_picture_has_a_shutter(tmp_path):
    keys = tmp_path / "keys.exr"
    subprocess.run([PROGRAM, "trace", str(ROOT / "samples" / "scenes" / "motion.toml"), "-o", keys, "--size", "561x271",
                    "--for-shutter", "0:1", "--quiet"], check=True)  # fmt: skip
    assert coarse_width(keys, "method=lightfield&views=4&f-number=8&focus=5&shutter=0:1") == (280, 2)


def test_a_coarse_picture_of_a_small_frame_has_its_pixels(frame):
    assert coarse_width(frame, "method=lightfield&views=4&f-number=2&focus=3") == (120, 1)


@pytest.mark.parametrize("query", [
    "f-number=-1", "f-number=nan", "f-number=1e999", "f-number=2&focus=0", "views=99999999999999999999&f-number=2",
    "views=1e9", f"output={UNWRITTEN}.exr", f"explain={UNWRITTEN}.png", "scene=/etc/passwd", "paths=/etc/passwd", "impulse=file:/etc/passwd",
    "impulse=lens:/etc/passwd", "shutter-curve=/etc/passwd", "frames=1-9", "f-number=2%20--output%3Dx", "f-number=" + "1" * 500,
    "method=magic", "threads=4096", "crop=0,0,99999,99999", "f-number=%00",
])  # fmt: skip
def test_wrong_questions_get_one_line(viewer, query):
    answer, body = get(viewer, viewer.path + "picture?" + query)
    assert answer.status == 400, body[:200]
    assert "\n" not in json.loads(body)["error"]
    assert not os.path.exists(UNWRITTEN + ".exr") and not os.path.exists(UNWRITTEN + ".png")


@pytest.mark.parametrize("kind", ["image", "lens"])
def test_the_page_names_no_file(viewer, kind):
    answer, body = get(viewer, viewer.path + f"picture?f-number=2&focus=3&impulse={kind}:a.png")
    assert answer.status == 400 and "no file may be read from here" in json.loads(body)["error"]


def test_rays_show_what_the_frame_shows(frame, tmp_path):
    """Also where the frame was traced with another film than the scene's camera has."""
    narrow = tmp_path / "narrow.exr"
    subprocess.run([PROGRAM, "trace", SCENE, "-o", narrow, "--size", "120x68", "--film-width", "18", "--quiet"], check=True)
    made = Viewer(str(narrow), SCENE)
    means = []
    for what in ("rays?spp=64&f-number=22&focus=10", "picture?method=lightfield&views=16&f-number=22&focus=10"):
        answer, body = get(made, made.path + what)
        assert answer.status == 200
        length = struct.unpack_from("<I", body)[0]
        begin = (4 + length + 3) // 4 * 4
        means.append(struct.unpack_from(f"<{120 * 68 * 3}e", body, begin))
    assert made.close() == 0
    # Twice the film would show a board of half the size: a mean difference of some 0.2.
    assert sum(abs(a - b) for a, b in zip(*means)) / len(means[0]) < 0.03


def test_pixels(viewer):
    _, body = get(viewer, viewer.path + "pixel?x=60&y=35&f-number=2&focus=5")
    nodes = json.loads(body)["nodes"]
    assert abs(sum(n["share"] for n in nodes) - 1) < 1e-9
    assert nodes == sorted(nodes, key=lambda n: -n["share"])
    assert nodes[0]["focus_m"] == pytest.approx(nodes[0]["z_m"], rel=0.05)
    for query in ("x=1e9&y=0", "x=nan&y=1", "y=1", "x=&y="):
        assert get(viewer, viewer.path + "pixel?" + query)[0].status == 400 or query == "x=1e9&y=0"
    answer, depths = get(viewer, viewer.path + "depths")
    assert answer.status == 200 and len(depths) == 120 * 68 * 6


def focus_at(picture, x, y, out):
    """The distance on which `focus --focus-at` focuses, m; None: infinity."""
    made = subprocess.run([PROGRAM, "focus", picture, "-o", out, "--f-number", "2", "--focus-at", f"{x + 0.5},{y + 0.5}",
                           "--crop", f"{x},{y},1,1", "--json"], check=True, capture_output=True)  # fmt: skip
    return json.loads(made.stdout)["focus_m"]


@pytest.mark.parametrize("kind", ["flat", "deep"])
def test_pictures_of_other_programs(flat, kind, tmp_path):
    picture = flat if kind == "flat" else DEEP
    made = Viewer(picture)
    facts = json.loads(get(made, made.path + "frame")[1])
    width, height = facts["width"], facts["height"]
    assert not facts["records_kept"] and facts["pixel_pitch_mm"] > 0 and facts["film_distance_mm"] > 0
    answer, body = get(made, made.path + "depths")
    assert answer.status == 200 and len(body) == width * height * 6
    ids = struct.unpack_from(f"<{width * height}I", body)
    inverse = struct.unpack_from(f"<{width * height}e", body, 4 * width * height)
    found = set()
    for x, y in ((0, 0), (width // 2, height // 2), (width // 4, height - 1), (3 * width // 4, height // 3)):
        answer, body = get(made, made.path + f"pixel?x={x}.5&y={y}.5&f-number=2&focus=3")
        assert answer.status == 200, body
        pixel = json.loads(body)
        clicked, wanted = pixel["clicked"], focus_at(picture, x, y, tmp_path / "x.exr")
        assert clicked["focus_m"] == pytest.approx(wanted) if wanted else clicked["focus_m"] is None
        assert inverse[y * width + x] == pytest.approx(1 / wanted if wanted else 0, rel=1e-3)
        assert ids[y * width + x] == clicked["id"]
        if pixel["nodes"]:
            assert sum(node["share"] for node in pixel["nodes"]) == pytest.approx(1)
        coc = facts["focal_length_mm"] / 2 * facts["film_distance_mm"] / 1000 / facts["pixel_pitch_mm"]
        assert clicked["coc_px"][0] == pytest.approx(coc * abs(1 / 3 - (1 / wanted if wanted else 0)), rel=1e-4)
        found.add(clicked["name"])
    if kind == "flat":
        assert found == {"board", "wall"}
    for query in ("x=-1&y=0", f"x={width}&y=0", "x=1e9&y=0", "x=nan&y=1", "y=1", "x=1&y=1&focus=3&f-number=0",
                  "x=1&y=1&focus=3&f-number=-2", "x=1&y=1&f-number=2&focus=0", "x=1&y=1&f-number=2&focus=3&focal-length=-1"):  # fmt: skip
        answer, body = get(made, made.path + "pixel?" + query)
        assert answer.status == 400 and "\n" not in json.loads(body)["error"], query
    assert get(made, made.path + "causes?f-number=2&focus=3")[0].status == 400  # needs records and the scene
    assert made.close() == 0


def test_causes_of_the_error(tmp_path):
    # Of two flat objects: to find the causes, the scene is traced again with finer cells, which takes seconds for the many
    # objects of SCENE.
    scene = str(ROOT / "tests" / "stability" / "scenes" / "near_edge.toml")
    made = Viewer(traced(scene, str(tmp_path / "near_edge.exr"), "120x68"), scene)
    answer, body = get(made, made.path + "causes?f-number=1.4&focus=5&method=scatter&depths=2")
    assert made.close() == 0
    assert answer.status == 200, body
    length = struct.unpack_from("<I", body)[0]
    report = json.loads(body[4 : 4 + length])
    found = body[(4 + length + 3) // 4 * 4 :]
    causes = report["causes"]
    assert (report["width"], report["height"], len(found)) == (120, 68, 120 * 68)
    assert 32 <= report["spp"] <= 1024 and report["seconds"] > 0
    assert causes[0]["name"] == "none" and causes[0]["error_share"] == 0 and len(causes) == 9
    assert len({tuple(cause["colour"]) for cause in causes}) == 9
    assert sum(cause["error_share"] for cause in causes) == pytest.approx(1)
    for i, cause in enumerate(causes[1:], 1):
        assert (found.count(i) > 0) == (cause["error_share"] > 0), cause
    # scatter mixes surfaces of which one hides the other. Of these two, it leaves out no kernel that matters.
    shares = {cause["name"]: cause["error_share"] for cause in causes}
    assert shares["visibility"] > 0.5 and shares["kernel-truncation"] < 0.1


@pytest.mark.parametrize("query", [
    "f-number=-1&focus=5", "f-number=nan&focus=5", "f-number=2&focus=0", "spp=100000&f-number=2&focus=5", f"output={UNWRITTEN}.exr",
    f"map-causes={UNWRITTEN}.png", "scene=/etc/passwd", "impulse=image:/etc/passwd&f-number=2&focus=5", "impulse=lens:/etc/passwd",
    "crop=0,0,9,9&f-number=2&focus=5", "method=magic&f-number=2&focus=5", "views=1e9&f-number=2&focus=5", "f-number=%00",
    "shutter=0:1:2&f-number=2&focus=5", "depths=1e9&f-number=2&focus=5&method=scatter", "halves=1",
])  # fmt: skip
def test_wrong_questions_about_causes(viewer, query):
    answer, body = get(viewer, viewer.path + "causes?" + query)
    assert answer.status == 400, body[:200]
    assert "\n" not in json.loads(body)["error"]
    assert not os.path.exists(UNWRITTEN + ".exr") and not os.path.exists(UNWRITTEN + ".png")


def test_causes_are_dropped(viewer):
    asked = http.client.HTTPConnection(viewer.host, viewer.port, timeout=120)
    asked.request("GET", viewer.path + "causes?f-number=1.4&focus=5&method=scatter")
    time.sleep(1)
    started = time.monotonic()
    assert get(viewer, viewer.path + "drop_causes")[0].status == 200
    assert asked.getresponse().status == 409
    assert time.monotonic() - started < 5


def test_other_methods_and_long_requests(viewer):
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT"):
        connection = http.client.HTTPConnection(viewer.host, viewer.port, timeout=60)
        connection.request(method, viewer.path + "frame")
        assert connection.getresponse().status in (400, 404, 405), method
    assert get(viewer, viewer.path + "frame?" + "a" * 20000)[0].status in (400, 414)
    assert is_well(viewer)


def test_half_a_request_is_cut(viewer):
    with socket.create_connection((viewer.host, viewer.port)) as connection:
        connection.settimeout(30)
        connection.sendall(b"GET " + viewer.path.encode())
        assert not connection.recv(1000).startswith(b"HTTP/1.1 200")
    with socket.create_connection((viewer.host, viewer.port)) as connection:
        connection.settimeout(30)
        connection.sendall(os.urandom(3000))
        connection.shutdown(socket.SHUT_WR)
        assert not connection.recv(1000).startswith(b"HTTP/1.1 200")
    assert is_well(viewer)


def test_idle_connections_are_cut_and_harm_nothing(behind_idle_connections):
    well, seconds = behind_idle_connections.result()
    assert well and seconds < 40


def test_a_newer_picture_cancels_the_older(viewer):
    older = http.client.HTTPConnection(viewer.host, viewer.port, timeout=120)
    older.request("GET", viewer.path + "picture?f-number=2&focus=3&method=lightfield&views=4096")
    time.sleep(0.3)
    started = time.monotonic()
    assert get(viewer, viewer.path + "picture?f-number=2&focus=3&method=lightfield&views=4")[0].status == 200
    # All of the older takes many times as long as both tests together.
    assert time.monotonic() - started < 20
    assert older.getresponse().status == 409


def test_what_cannot_be_viewed(tmp_path):
    (tmp_path / "x.exr").write_text("no picture")
    for words in (["missing.exr"], [str(tmp_path)], [str(tmp_path / "x.exr")], [SCENE], [], ["--port", "99999", SCENE]):
        run = subprocess.run([PROGRAM, "view", *words], capture_output=True, text=True, timeout=60)
        assert run.returncode in (2, 3) and run.stderr.count("\n") == 1 and run.stderr.startswith("postlens: ")


def test_an_orthographic_frame_has_no_lens_to_change(tmp_path):
    scene, frame = tmp_path / "parallel.toml", str(tmp_path / "parallel.exr")
    text = (ROOT / "samples" / "scenes" / "ruler.toml").read_text()
    text = re.sub(r"(f_number|focus_m) = .*\n", "", text)
    scene.write_text(text.replace("focal_length_mm = 50", 'projection = "orthographic"\northographic_width_m = 3'))
    subprocess.run([PROGRAM, "trace", scene, "-o", frame, "--size", "48x27", "--quiet"], check=True)
    for words in ([], ["--export", str(tmp_path / "page.html")]):
        run = subprocess.run([PROGRAM, "view", frame, *words], capture_output=True, text=True, timeout=60)
        assert run.returncode == 3 and run.stderr.count("\n") == 1 and "orthographic" in run.stderr


def test_the_scene_is_the_frames(frame):
    other = str(ROOT / "samples" / "scenes" / "still_life.toml")
    run = subprocess.run([PROGRAM, "view", frame, other], capture_output=True, text=True, timeout=60)
    assert run.returncode == 3 and run.stderr.count("\n") == 1 and "is not the scene that" in run.stderr
    for words, code, said in (([frame, DEEP], 3, "not a scene"), ([frame, frame], 3, "not a scene"),
                              ([DEEP, SCENE], 2, "SCENE: not for a picture of another program")):
        run = subprocess.run([PROGRAM, "view", *words], capture_output=True, text=True, timeout=60)
        assert run.returncode == code and run.stderr.count("\n") == 1 and said in run.stderr


def test_a_port_that_is_taken(viewer, frame):
    run = subprocess.run([PROGRAM, "view", frame, "--port", str(viewer.port)], capture_output=True, text=True, timeout=60)
    assert run.returncode == 2 and "--port: cannot be used" in run.stderr


def test_an_end_while_a_picture_is_made(frame):
    made = Viewer(frame)
    busy = http.client.HTTPConnection(made.host, made.port, timeout=120)
    busy.request("GET", made.path + "picture?f-number=2&focus=3&method=lightfield&views=4096")
    time.sleep(0.3)
    started = time.monotonic()
    assert made.close() == 0
    assert time.monotonic() - started < 15
