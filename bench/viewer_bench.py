"""How long the viewer takes from a change to the painted picture, in headless Chromium, and the server's share of it.

    python3 bench/viewer_bench.py BUILD FRAME.exr [SCENE]
"""

import os
import statistics
import subprocess
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

build, *words = sys.argv[1:]
process = subprocess.Popen([os.path.join(build, "apps", "postlens"), "view", *words], stdout=subprocess.PIPE, text=True)
options = webdriver.ChromeOptions()
for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--window-size=1280,900"):  # fmt: skip
    options.add_argument(word)
driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
driver.get(process.stdout.readline().strip())


def wait():
    while not driver.execute_script("const s = postlens.state(); return Boolean(s.shown) && !s.working"):
        time.sleep(0.05)


wait()
driver.execute_script("postlens.timings.length = 0")
for key in ("]", "]", "[", ",", ".", "]", "["):
    driver.find_element("tag name", "body").send_keys(key)
    wait()
timings = driver.execute_script("return postlens.timings")
for views in dict.fromkeys(t["views"] for t in timings):
    of = [t for t in timings if t["views"] == views]
    painted = statistics.median(t["painted"] - t["input"] for t in of)
    server = statistics.median(1000 * t["server"] for t in of)
    answered = statistics.median(t["answered"] - t["input"] for t in of)
    print(f"{views:>7}: answered {answered:.0f}, painted {painted:.0f} ms after the change, the server's work {server:.0f} ms")
driver.execute_script("postlens.timings.length = 0")
driver.set_script_timeout(60)
driver.execute_async_script("""
  const done = arguments[0], slider = document.getElementById("f_number"), start = performance.now();
  let step = 0;
  const timer = setInterval(() => {
    slider.value = 3 + step++ % 12;
    slider.dispatchEvent(new Event("input"));
    if (performance.now() - start < 3000) return;
    clearInterval(timer);
    done();
  }, 16);""")
print(f"{driver.execute_script('return postlens.timings.length') / 3:.1f} pictures a second while a slider is dragged")
driver.quit()
process.terminate()
