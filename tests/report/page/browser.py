"""A page in a real browser, and what may be wrong with it: every check returns a list of complaints."""
import base64
import json
import shutil
import tempfile
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
         "--disable-background-networking", "--disable-component-update", "--hide-scrollbars"]


class Browser:
    """Offline, with a profile of its own."""

    def __init__(self):
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        self._profile = tempfile.mkdtemp(prefix="scancal_chromium_")
        for flag in [*FLAGS, f"--user-data-dir={self._profile}"]:
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
        options.set_capability("unhandledPromptBehavior", "dismiss")
        self._driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self._do("Network.enable")
        self._do("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)

    def close(self) -> None:
        self._driver.quit()
        shutil.rmtree(self._profile, ignore_errors=True)

    def open(self, page: Path, width: int = 1280) -> None:
        self._driver.get_log("performance"), self._driver.get_log("browser")  # those of the page before
        self._do("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self._address = page.as_uri()
        self._driver.get(self._address)
        self.run("return document.fonts.ready.then(() => 1)")

    def run(self, script: str):
        return self._driver.execute_script(script)

    def pdf(self) -> bytes:
        printed = self._do("Page.printToPDF", preferCSSPageSize=True, printBackground=True)
        return base64.b64decode(printed["data"])

    def requests(self) -> list[str]:
        """Addresses that were asked for beside the page's own and what it holds as data."""
        messages = [json.loads(entry["message"])["message"] for entry in self._driver.get_log("performance")]
        asked = [message["params"]["request"]["url"] for message in messages
                 if message["method"] == "Network.requestWillBeSent"]
        assert self._address in asked, "the log of requests does not work"
        return [url for url in asked if url != self._address and not url.startswith("data:")]

    def errors(self) -> list[str]:
        """Of the console: scripts that fail, what the Content-Security-Policy forbids, what cannot be loaded."""
        return [entry["message"] for entry in self._driver.get_log("browser") if entry["level"] == "SEVERE"]

    def active_content(self) -> list[str]:
        """Scripts, and elements and attributes that could run or load something."""
        return self.run("""
          const found = [...document.querySelectorAll("script, iframe, object, embed, link, base, form, foreignObject")]
            .map(element => element.tagName);
          for (const element of document.querySelectorAll("*")) for (const {name, value} of element.attributes)
            if (name.startsWith("on") || /^\\s*(javascript|https?):/i.test(value) && !name.startsWith("xmlns"))
              found.push(`${element.tagName} ${name}=${value}`);
          if (window.ran) found.push("a name ran");
          return found;""")

    def too_wide(self) -> int:
        """Pixels that one has to scroll to the right."""
        return self.run("const root = document.documentElement; return root.scrollWidth - root.clientWidth")

    def end_of_status(self) -> float:
        """Where the line of the status ends: above it stand who, what, and every result."""
        return self.run("return document.querySelector('p.status').getBoundingClientRect().bottom + window.scrollY")

    def too_wide_for_a_sheet(self) -> int:
        """The same on A4 with its margins of 16 mm: printing would shrink the page by it."""
        self._do("Emulation.setEmulatedMedia", media="print")
        self._do("Emulation.setDeviceMetricsOverride", width=673, height=900, deviceScaleFactor=1, mobile=False)
        found = self.too_wide()
        self._do("Emulation.setEmulatedMedia", media="")
        return found

    def figures(self) -> list[str]:
        """Ids of the figures that are drawn and seen."""
        return self.run("""return [...document.querySelectorAll("figure")].filter(figure => {
            const svg = figure.querySelector("svg"), box = svg && svg.getBoundingClientRect();
            const caption = figure.querySelector("figcaption");
            return box && box.width > 100 && box.height > 40 && caption.innerText.length > 20;
          }).map(figure => figure.id)""")

    def texts_outside(self) -> list[str]:
        """Texts that leave the picture they stand in by more than a pixel."""
        return self.run(_TEXTS + """
          return texts().filter(({box, around}) => box.left < around.left - 1 || box.top < around.top - 1 ||
              box.right > around.right + 1 || box.bottom > around.bottom + 1).map(say)""")

    def texts_on_texts(self) -> list[str]:
        """Pairs of texts of one figure that cover each other, as turned boxes around their letters."""
        return self.run(_TEXTS + """
          const found = [], all = texts();
          for (let i = 0; i < all.length; ++i) for (let j = i + 1; j < all.length && all[j].svg === all[i].svg; ++j)
            if (meet(all[i].corners, all[j].corners)) found.push(say(all[i]) + " | " + say(all[j]));
          return found;""")

    def _do(self, command: str, **arguments):
        return self._driver.execute_cdp_cmd(command, arguments)


# Corners of a text's letters (a box of lines without the leading above and below them), on the screen.
_TEXTS = """
  const say = text => `${text.figure}: ${text.words.slice(0, 60)}`;
  function texts() {
    return [...document.querySelectorAll("svg text")].filter(text => text.textContent.trim()).map(text => {
      const svg = text.ownerSVGElement, {x, y, width, height} = text.getBBox(), to_screen = text.getScreenCTM();
      const top = y + 0.25 * height, bottom = y + 0.82 * height;
      const corners = [[x, top], [x + width, top], [x + width, bottom], [x, bottom]]
        .map(([a, b]) => new DOMPoint(a, b).matrixTransform(to_screen)).map(point => [point.x, point.y]);
      return {svg, corners, box: text.getBoundingClientRect(), around: svg.getBoundingClientRect(),
              words: text.textContent, figure: (svg.closest("figure") || {id: "?"}).id};
    });
  }
  function meet(a, b) {  // no edge of either has the other outside; half a pixel is a touch
    for (const [one, other] of [[a, b], [b, a]]) for (let k = 0; k < 4; ++k) {
      const [p, q] = [one[k], one[(k + 1) % 4]], length = Math.hypot(q[0] - p[0], q[1] - p[1]) || 1;
      const side = point => ((q[0] - p[0]) * (point[1] - p[1]) - (q[1] - p[1]) * (point[0] - p[0])) / length;
      if (Math.max(...other.map(side)) < 0.5) return false;
    }
    return true;
  }
"""
