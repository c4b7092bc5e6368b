"""The page in a real browser: what the hand does, and what is seen."""

import base64
import json
import re
import shlex
import shutil
import subprocess
import time

import numpy
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from conftest import PROGRAM, ROOT, SCENE, Viewer, traced


@pytest.fixture(scope="module")
def one_browser():
    """A browser for all tests: to start one takes longer than most of them. Each page that is loaded begins anew."""
    options = webdriver.ChromeOptions()
    # WebGL is the page's own. Without a graphics card, the browser puts its windows together faster without it.
    for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
                 "--enable-unsafe-swiftshader", "--disable-gpu-compositing"):  # fmt: skip
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    driver.set_script_timeout(120)
    yield driver
    driver.quit()


@pytest.fixture
def browser(one_browser):
    """The browser with one empty window. What a page reports fails its test."""
    # Without a graphics card, to paint the canvas of a window of 1280 x 800 px takes 0.15 s, and of this one a third of it.
    one_browser.set_window_size(800, 600)
    yield one_browser
    wrong = errors(one_browser)
    first, *others = one_browser.window_handles
    for other in others:
        one_browser.switch_to.window(other)
        one_browser.close()
    one_browser.switch_to.window(first)
    one_browser.get("about:blank")  # so that the page stops asking for pictures, which would delay the next test
    assert not wrong


@pytest.fixture
def page(browser, viewer):
    browser.get(viewer.url)
    wait(browser)
    return browser


def errors(driver):
    """What the page reported, but for requests that a newer one cancelled."""
    return [entry for entry in driver.get_log("browser") if entry["level"] == "SEVERE" and " 409 " not in entry["message"]]


def until(driver, condition, value=None):
    """Waits until a condition of JavaScript holds, which may use the state `s`, the `lens` and the `value`."""
    # The page itself looks again and again: a call from here each time takes much of the processor that is waited for.
    driver.execute_async_script("""
      const [value, done] = arguments;
      const look = () => {
        const s = window.postlens?.state(), lens = s?.lens;
        if (%s) done(); else setTimeout(look, 20);
      };
      look();""" % condition, value)


def wait(driver):
    """Until the best picture is there and painted."""
    until(driver, "s.shown && !s.working")
    driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")


def show(driver, mode):
    """Selects what is painted, and waits until it can be."""
    Select(driver.find_element(By.ID, "show")).select_by_value(mode)
    if mode in ("in_focus", "coc", "depth", "id"):
        until(driver, "s.depths")


def lens(driver):
    return driver.execute_script("return postlens.state().lens")


def pixels(driver):
    """The canvas as it is painted, three bytes a pixel."""
    # As text: millions of numbers of their own take the browser and WebDriver seconds a picture. In a loop: a call of a
    # function for each of them takes a third of a second.
    text = driver.execute_async_script("""
      const done = arguments[0], from = document.getElementById("picture"), to = document.createElement("canvas");
      [to.width, to.height] = [from.width, from.height];
      document.getElementById("exposure").dispatchEvent(new Event("input"));  // paint, and read in the same frame
      requestAnimationFrame(() => {
        const context = to.getContext("2d");
        context.drawImage(from, 0, 0);
        const rgba = context.getImageData(0, 0, to.width, to.height).data, bytes = new Uint8Array(rgba.length / 4 * 3);
        for (let i = 0, k = 0; i < rgba.length; i += 4) for (let c = 0; c < 3; ++c) bytes[k++] = rgba[i + c];
        let text = "";
        for (let i = 0; i < bytes.length; i += 16384) text += String.fromCharCode(...bytes.subarray(i, i + 16384));
        done(btoa(text));
      });""")
    return base64.b64decode(text)


def numbers(picture):
    return numpy.frombuffer(picture, numpy.uint8).astype(int)


def at_picture(driver, x, y):
    """The offset from the canvas's middle of a place in the picture, px."""
    return driver.execute_script("""
      const s = postlens.state().frame, c = document.getElementById("picture"), scale = Math.min(c.clientWidth / s.width, c.clientHeight / s.height);
      return [(arguments[0] - s.width / 2) * scale, (arguments[1] - s.height / 2) * scale];""", x, y)


def click(driver, x, y):
    canvas = driver.find_element(By.ID, "picture")
    ActionChains(driver).move_to_element_with_offset(canvas, *(int(v) for v in at_picture(driver, x, y))).click().perform()


def test_a_click_focuses_there(page, viewer):
    # The chequered board at the middle is 10 m away, the wall 20 m (samples/scenes/bars.toml).
    click(page, 75, 42)
    until(page, "lens.focus !== 5")
    wait(page)
    first = lens(page)["focus"]
    click(page, 15, 60)
    until(page, "lens.focus !== value", first)
    wait(page)
    assert lens(page)["focus"] > first
    assert page.execute_script("return postlens.state().shown.options.focus") == str(lens(page)["focus"]).removesuffix(".0")


def test_wheel_and_keys(page):
    canvas = page.find_element(By.ID, "picture")
    before = lens(page)["fNumber"]
    ActionChains(page).scroll_from_origin(
        webdriver.common.actions.wheel_input.ScrollOrigin.from_element(canvas), 0, 100
    ).perform()  # fmt: skip
    until(page, "lens.fNumber > value", before)
    body = page.find_element(By.TAG_NAME, "body")
    body.send_keys("[")
    until(page, "lens.fNumber === value", before)
    body.send_keys("[")
    until(page, "lens.fNumber < value", before)
    body.send_keys("u")
    until(page, "lens.fNumber === value", before)
    near = lens(page)["focus"]
    body.send_keys(",")
    until(page, "lens.focus < value", near)
    body.send_keys("?")
    assert page.find_element(By.ID, "shortcuts").is_displayed()
    page.find_element(By.ID, "shortcuts").send_keys(Keys.ESCAPE)
    canvas.send_keys(Keys.ENTER)  # by keyboard alone: focus at the middle
    wait(page)


def test_the_command_that_is_copied_makes_the_picture(page, tmp_path):
    Select(page.find_element(By.ID, "blades")).select_by_value("polygon:6")
    wait(page)
    page.find_element(By.ID, "copy").click()
    until(page, "postlens.copied")
    command = page.execute_script("return postlens.copied")
    words = shlex.split(command)
    assert words[0] == "postlens" and "--impulse" in words
    words[0] = PROGRAM
    subprocess.run([*words, "--quiet"], check=True, cwd=tmp_path)
    shown = page.execute_script("return Array.from(postlens.state().shown.halves)")
    code = ("import json, sys, numpy, postlens; print(json.dumps(postlens.read_picture(sys.argv[1]).array"
            ".astype(numpy.float16).view(numpy.uint16).ravel().tolist()))")  # fmt: skip
    made = json.loads(subprocess.run(["/usr/bin/python3", "-c", code, tmp_path / "picture.exr"], check=True,
                                     capture_output=True, text=True).stdout)  # fmt: skip
    assert made == shown


def test_a_frame_is_first_focused_where_it_says(browser, tmp_path):
    scene = tmp_path / "far.toml"
    scene.write_text(re.sub(r"focus_m = \S+", "focus_m = inf", (ROOT / "samples" / "scenes" / "ruler.toml").read_text()))
    frame = str(tmp_path / "far.exr")
    subprocess.run([PROGRAM, "trace", scene, "-o", frame, "--size", "120x68", "--quiet"], check=True)
    made = Viewer(frame)
    browser.get(made.url)
    wait(browser)
    assert browser.execute_script("return postlens.state().shown.options.focus") == "inf"
    assert made.close() == 0


def test_what_is_under_the_pointer_is_of_the_lens_shown(page):
    click(page, 15, 60)  # the pointer stays there
    until(page, "lens.focus !== 5")
    wait(page)
    until(page, "document.getElementById('under').innerText.includes('CoC 0.0 px')")


def test_undo_compares_with_rays_of_the_lens_shown(page):
    select = Select(page.find_element(By.ID, "compare"))
    body = page.find_element(By.TAG_NAME, "body")
    body.send_keys("]")
    wait(page)
    select.select_by_value("rays")
    rays_are_of_the_lens = "s.other?.samples > 0 && s.other.report.f_number === lens.fNumber"
    until(page, rays_are_of_the_lens)
    body.send_keys("u")
    wait(page)
    until(page, rays_are_of_the_lens)
    # "Before" is what was shown before the last change, also if that was an undo.
    body.send_keys("]")
    wait(page)
    narrow = lens(page)["fNumber"]
    select.select_by_value("before")
    body.send_keys("u")
    wait(page)
    assert page.execute_script("return postlens.state().other.options['f-number']") == str(narrow)


# Answers the first request for something as if another one had cancelled it, and counts the requests for pictures meanwhile.
CANCEL_FIRST = """
  const fetched = window.fetch, [what] = arguments;
  let cancelled = false;
  window.requests = { during: 0, underWay: false };
  window.fetch = async (asked, ...more) => {
    if (!String(asked).startsWith(what)) {
      if (requests.underWay && String(asked).startsWith("picture")) ++requests.during;
      return fetched(asked, ...more);
    }
    requests.underWay = true;
    if (!cancelled) {
      cancelled = true;
      return new Response("{}", { status: 409 });
    }
    const answer = await fetched(asked, ...more);
    requests.underWay = false;
    return answer;
  };"""


def test_saving_outlasts_other_requests(page):
    page.execute_script(CANCEL_FIRST, "save")
    # In the same call: the click on the button, and a new lens, whose finer pictures wait.
    before = lens(page)
    page.execute_script("""
      window.saved = [];
      HTMLAnchorElement.prototype.click = function () { saved.push(this.download); };
      const slider = document.getElementById("f_number");
      slider.value = 3 + Number(slider.value);
      document.getElementById("save_png").click();
      slider.dispatchEvent(new Event("input"));
      slider.dispatchEvent(new Event("change"));""")
    until(page, "!requests.underWay")
    assert page.execute_script("return requests.during") == 0
    wait(page)
    assert lens(page)["fNumber"] != before["fNumber"]
    assert page.execute_script("return saved") == [f"a frame_f{before['fNumber']}_{before['focus']}m.png"]


def test_a_picture_to_compare_with_outlasts_other_requests(page):
    page.execute_script(CANCEL_FIRST, "picture?method=pinhole")
    select = Select(page.find_element(By.ID, "compare"))
    select.select_by_value("pinhole")
    until(page, "s.other?.report.method === 'pinhole'")
    # The answer to a request that is no longer wanted is not shown.
    select.select_by_value("nothing")
    select.select_by_value("pinhole")
    select.select_by_value("nothing")
    until(page, "!requests.underWay")
    wait(page)
    assert not page.execute_script("return Boolean(postlens.state().other)")


def test_depths_outlast_other_requests(page):
    page.execute_script(CANCEL_FIRST, "depths")
    show(page, "depth")


def test_an_unreachable_server_is_named(page):
    Select(page.find_element(By.ID, "compare")).select_by_value("rays")
    page.execute_script("window.fetch = () => Promise.reject(new TypeError('Failed to fetch'));")
    page.find_element(By.TAG_NAME, "body").send_keys("]")
    until(page, "document.getElementById('status').innerText.includes('postlens view has ended')")


def test_values_that_are_none(page):
    shutter, focal_length = page.find_element(By.ID, "shutter"), page.find_element(By.ID, "focal_length")
    before = lens(page)
    for text in ("hello", "0.01", "0:x"):
        shutter.clear()
        shutter.send_keys(text, Keys.ENTER)
        assert not page.execute_script("return document.getElementById('shutter').checkValidity()")
    focal_length.send_keys(Keys.CONTROL + "a")
    focal_length.send_keys("0", Keys.ENTER)
    assert focal_length.get_attribute("value") == "50"
    assert lens(page) == before
    shutter.clear()
    shutter.send_keys("-0.01:1e-2", Keys.ENTER)
    until(page, "lens.shutter === '-0.01:1e-2'")
    wait(page)


def test_wipe_and_exposure(page):
    Select(page.find_element(By.ID, "compare")).select_by_value("pinhole")
    until(page, "s.other")
    half = pixels(page)
    wipe = page.find_element(By.ID, "wipe")
    assert wipe.is_displayed()
    for _ in range(10):
        wipe.send_keys(Keys.ARROW_RIGHT)
    assert wipe.get_attribute("aria-valuenow") == "70"
    more = pixels(page)
    assert more != half
    page.find_element(By.TAG_NAME, "body").send_keys("e")
    assert sum(pixels(page)) > sum(more)
    Select(page.find_element(By.ID, "compare")).select_by_value("rays")
    until(page, "s.other?.samples >= 16")
    Select(page.find_element(By.ID, "compare")).select_by_value("nothing")
    assert not wipe.is_displayed()


def test_what_is_shown(page):
    seen = []
    for mode in ("picture", "in_focus", "coc", "depth", "id", "brightness", "unsure", "noise"):
        show(page, mode)
        seen.append(pixels(page))
    assert len(set(seen)) == len(seen)


def test_dragging_shows_pictures_on_the_way(page):
    f_number = lens(page)["fNumber"]
    # The drag goes on, 60 steps a second, until three pictures have been shown.
    page.execute_async_script("""
      const done = arguments[0], slider = document.getElementById("f_number"), before = postlens.timings.length;
      let step = 0;
      const timer = setInterval(() => {
        slider.value = 3 + step % 12;
        slider.dispatchEvent(new Event("input"));
        if (++step < 20 || postlens.timings.length < before + 3) return;
        clearInterval(timer);
        slider.dispatchEvent(new Event("change"));
        done();
      }, 16);""")
    wait(page)
    assert page.execute_script("return postlens.state().shown.options['f-number']") == str(lens(page)["fNumber"])
    page.find_element(By.ID, "undo").click()  # the drag is one step
    wait(page)
    assert lens(page)["fNumber"] == f_number


@pytest.fixture(scope="module")
def large_viewer(tmp_path_factory):
    """Of a frame so large that its first picture is a coarse one."""
    # Without warnings, whose lines of text would take room from the picture.
    made = Viewer(traced(SCENE, str(tmp_path_factory.mktemp("large") / "large.exr"), "561x271"))
    yield made
    assert made.close() == 0


@pytest.mark.parametrize("painter", ["", "?plain"])
def test_the_first_picture_lies_where_the_best_one_does(painter, browser, large_viewer):
    browser.set_window_size(1280, 800)
    browser.get(large_viewer.url + painter)
    wait(browser)
    best = pixels(browser)
    # Without an answer to its further requests, the page keeps showing the first picture.
    browser.execute_script("""
      const fetched = window.fetch;
      window.fetch = (what, ...more) => String(what).startsWith("picture") ? new Promise(() => {}) : fetched(what, ...more);
      document.getElementById("f_number").dispatchEvent(new Event("input"));""")
    until(browser, "s.shown.by === 2")
    first, row = pixels(browser), 3 * browser.execute_script("return document.getElementById('picture').width")
    assert first != best
    first, best = numbers(first), numbers(best)

    def difference(shift):
        return numpy.abs(first[4 * row : -4 * row] - best[4 * row + shift : len(best) - 4 * row + shift]).sum()

    # Shifts by two pixels of the screen, about one of the frame.
    assert all(difference(0) < difference(shift) for shift in (-6, 6, -2 * row, 2 * row))


def test_two_pages_both_end_with_the_best_picture(browser, viewer):
    # A request of one page cancels the refinement of the other, which asks again. In windows, not in tabs: only the tab
    # in front is painted.
    windows = [browser.current_window_handle]
    browser.get(viewer.url)
    browser.switch_to.new_window("window")
    windows.append(browser.current_window_handle)
    browser.get(viewer.url)

    def each_page():
        for window in windows:
            browser.switch_to.window(window)
            yield

    for _ in each_page():
        wait(browser)
    for _ in each_page():
        browser.execute_script("""
          const slider = document.getElementById("f_number");
          slider.value = 2 + Number(slider.value);
          slider.dispatchEvent(new Event("input"));
          slider.dispatchEvent(new Event("change"));""")
    for _ in each_page():
        wait(browser)
        options = browser.execute_script("return postlens.state().shown.options")
        assert options["method"] == "auto" or options.get("views") == "256", options


def test_without_webgl_the_same_is_painted(browser, viewer):
    painted = []
    for painter in ("", "?plain"):
        browser.get(viewer.url + painter)
        wait(browser)
        for mode in ("picture", "in_focus", "id"):
            show(browser, mode)
            painted.append(numbers(pixels(browser)))
    for a, b in zip(painted[:3], painted[3:]):
        assert len(a) == len(b)
        assert numpy.abs(a - b).max() <= 2


def test_windows_of_all_sizes(page):
    for size in ((1600, 1000), (1280, 800), (1024, 700), (500, 700), (400, 700)):
        page.set_window_size(*size)
        until(page, "window.innerWidth === value", size[0])
        # The canvas has a pixel for each of the screen's.
        until(page, "((c) => c.width === c.clientWidth && c.height === c.clientHeight)(document.getElementById('picture'))")
        assert page.find_element(By.ID, "picture").size["height"] >= 120
        wide = page.execute_script("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0
    unlabelled = page.execute_script("""return [...document.querySelectorAll("input, select, button, canvas")].filter(
      (e) => !(e.labels?.length || e.textContent.trim() || e.getAttribute("aria-label"))).map((e) => e.id)""")
    assert unlabelled == []


def test_the_causes_of_the_error(browser, tmp_path):
    # Of two flat objects: to find the causes, the scene is traced again with finer cells. For the many objects of SCENE that
    # takes 15 s, whatever size the picture has.
    scene = str(ROOT / "tests" / "stability" / "scenes" / "near_edge.toml")
    made = Viewer(traced(scene, str(tmp_path / "small.exr"), "120x68"), scene)
    browser.get(made.url)
    wait(browser)
    Select(browser.find_element(By.ID, "blades")).select_by_value("polygon:6")
    wait(browser)
    legend = browser.find_element(By.ID, "legend")
    assert not legend.is_displayed()
    # The answers of the search are held back until they are released, so that it is under way however fast it is.
    browser.execute_script("""
        const fetched = window.fetch;
        window.hold = () => { window.held = new Promise((go) => window.release = go); };
        window.fetch = async (what, ...more) => {
            const answer = await fetched(what, ...more);
            if (String(what).startsWith("causes")) await window.held;
            return answer;
        };
        hold();""")
    body = browser.find_element(By.TAG_NAME, "body")
    while browser.execute_script("return document.getElementById('show').value") != "causes":
        body.send_keys("v")
    assert "finding the causes" in legend.text
    grey = pixels(browser)
    browser.execute_script("release()")
    until(browser, "s.causes")
    assert "of the squared error" in legend.text and "rays a pixel" in legend.text
    names = browser.execute_script("return postlens.state().causes.report.causes.filter((c) => c.error_share > 0).map((c) => c.name)")
    assert names and all(name in legend.text for name in names)
    assert len(legend.find_elements(By.TAG_NAME, "i")) == len(names)
    assert pixels(browser) != grey
    # Another lens drops them, and asks anew.
    browser.execute_script("hold()")
    body.send_keys("[")
    until(browser, "!document.getElementById('legend').innerText.includes('of the squared error')")
    wait(browser)
    until(browser, "document.getElementById('legend').innerText.includes('finding the causes')")
    # Another kind of picture cancels the search.
    Select(browser.find_element(By.ID, "show")).select_by_value("picture")
    assert not legend.is_displayed()
    browser.execute_script("release()")
    time.sleep(1)
    assert not browser.execute_script("return Boolean(postlens.state().causes)")
    assert made.close() == 0


def test_another_programs_picture(browser, flat):
    made = Viewer(flat)
    browser.get(made.url)
    wait(browser)
    browser.find_element(By.TAG_NAME, "body").send_keys("[")
    wait(browser)
    assert browser.execute_script("return postlens.state().shown.report.method") == "layers"
    click(browser, 60, 35)
    until(browser, "lens.focus !== 2")
    wait(browser)
    near = lens(browser)["focus"]
    assert near == pytest.approx(5, rel=0.01)  # the chequered board
    click(browser, 15, 60)
    until(browser, "lens.focus !== value", near)
    assert lens(browser)["focus"] > near
    wait(browser)
    ActionChains(browser).move_to_element_with_offset(
        browser.find_element(By.ID, "picture"), *(int(v) for v in at_picture(browser, 75, 42))
    ).perform()  # fmt: skip
    until(browser, "document.getElementById('under').innerText.includes('leaning bar')")
    under = browser.find_element(By.ID, "under").text
    assert "CoC" in under and "undefined" not in under and "%" in under
    seen = []
    for mode in ("picture", "in_focus", "coc", "depth", "id"):
        show(browser, mode)
        seen.append(pixels(browser))
    assert len(set(seen)) == len(seen)
    # What needs records is not reached by keyboard either.
    for _ in range(12):
        browser.find_element(By.TAG_NAME, "body").send_keys("v")
        assert browser.execute_script("return document.getElementById('show').value") != "causes"
    assert made.close() == 0


def test_a_click_beside_what_is_stored(browser):
    made = Viewer(str(ROOT / "tests" / "data" / "exr" / "windows" / "autocrop.exr"))
    browser.get(made.url)
    wait(browser)
    before = lens(browser)["focus"]
    click(browser, *browser.execute_script("const f = postlens.state().frame; return [f.width - 1, f.height - 1];"))
    until(browser, "document.getElementById('status').innerText.includes('nothing is stored there')")
    assert lens(browser)["focus"] == before
    assert made.close() == 0


@pytest.mark.parametrize("kind", ["lightfield", "layers"])
def test_an_exported_page_needs_no_server(browser, frame, flat, kind, tmp_path):
    if kind == "layers":
        frame = flat
    page, small = tmp_path / "page.html", tmp_path / "small.html"
    all, few = (json.loads(subprocess.run([PROGRAM, "view", frame, "--export", *words, "--json"], check=True,
                                          capture_output=True).stdout)
                for words in ([page], [small, "--export-mb", "0.1"]))  # fmt: skip
    assert small.stat().st_size == few["bytes"] < 1e5 and few["pictures"] < all["pictures"]
    assert "it holds" in small.read_text()
    browser.get(page.as_uri())
    shown = lambda: browser.execute_script("return document.getElementById('picture').src")
    value = lambda: int(browser.execute_script("return document.getElementById('focus').value"))
    until(browser, "depths !== null")
    picture = browser.find_element(By.ID, "picture")
    ActionChains(browser).move_to_element(picture).click().perform()
    near, first = value(), shown()
    assert kind in browser.find_element(By.ID, "about").text
    # The wall, far behind what is in the middle.
    browser.execute_script("""
      const p = document.getElementById("picture"), box = p.getBoundingClientRect(), k = Math.min(box.width / data.width, box.height / data.height);
      p.dispatchEvent(new MouseEvent("click", { clientX: box.left + box.width / 2 + (30 - 60) * k, clientY: box.top + box.height / 2 + (10 - 34) * k }));""")
    assert value() > near and shown() != first
    second = shown()
    browser.find_element(By.ID, "f_number").send_keys(Keys.ARROW_RIGHT)
    assert shown() != second
    for words in (["--export", tmp_path / "x.txt"], ["--export", tmp_path / "x.html", "--export-mb", "0.001"]):
        run = subprocess.run([PROGRAM, "view", frame, *words], capture_output=True, text=True)
        assert run.returncode == 2 and run.stderr.count("\n") == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["page.html", "small.html"]
