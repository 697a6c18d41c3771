"""Pages to test: of calibrations that the program makes now.

Called as a program it makes all of them in the folder SCANCAL_PAGES, where the tests of one run find them; without
that variable every test makes those that it needs, and keeps none.
"""
import concurrent.futures
import functools
import importlib.util
import json
import multiprocessing
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import paths
from paths import SOURCE

PROGRAM = os.environ.get("SCANCAL_PROGRAM", str(SOURCE / "build" / "scancal"))
EVIL = '"><script>window.ran = 1</script><img src=x onerror="window.ran = 1"> Prüfkörper \'€ $a_b$\' {{ 7 * 7 }} жук '
LONG = (EVIL + "very long " * 30)[:300]

PANDA = paths.DATA_SETS / "mukca-panda"
SCENES = ["sample", "robot", "bad", "many_targets", "many_stations", "named", "named_robot"]
if PANDA.exists():
    SCENES.append("flange")
else:
    print(f"NO DATA: {PANDA} is not there; the page of a ball on a flange was not looked at", file=sys.stderr)

PRINTED = ["sample", "named_robot"]  # a PDF takes its time, that of a robot most
LANGUAGES = {"named": ["en"], "named_robot": ["en"], "many_targets": ["en"], "many_stations": ["en"]}  # else both

_folder = tempfile.TemporaryDirectory(prefix="scancal_page_")
_shared = Path(os.environ.get("SCANCAL_PAGES", _folder.name))


@functools.cache
def calibration(scene: str) -> Path:
    """calibration.json of a scene with its figures; on "bad" nobody should rely: its U is larger than the box."""
    out = _shared / scene
    if (out / "calibration.json").exists():
        return out / "calibration.json"
    if scene == "sample":
        _run("refine", SOURCE / "data/sample", f"--out={out}", "--montecarlo=200")
    elif scene == "robot":
        _run("refine", SOURCE / "data/robot-sample", f"--out={out}")
    elif scene == "bad":
        _simulated(out, "--placements=1", "--tilt_x=1", "--sweep=4", "--profiles=12", "--points=9", allowed=2)
    elif scene == "many_targets":
        _simulated(out, "--placements=40", "--profiles=16", "--points=16", "--back", influences="{scale_y: 1e-3}")
    elif scene == "many_stations":
        _simulated(out, "--model=robot-ball", "--declare", "--stations=60", "--poses=5")
    elif scene == "flange":
        _run("refine", _panda(out), f"--out={out}", allowed=2)
    elif scene == "named":
        _rename(calibration("sample"), out)
    elif scene == "named_robot":
        _rename(calibration("robot"), out)
    if not scene.startswith("named"):
        _add_figures(out / "calibration.json")
    return out / "calibration.json"


@functools.cache
def page(scene: str, language: str = "en") -> Path:
    """Of PRINTED the English one also as a PDF beside it."""
    file = _shared / f"{scene}_{language}.html"
    if not file.exists():
        report(*_arguments(scene, language), PYTHONHASHSEED="1", TZ="UTC")
    return file


def pdf(scene: str) -> Path:
    return page(scene).with_suffix(".pdf")


def report(calibration_json: Path, *arguments: str, **environment: str) -> str:
    """Runs the report as `scancal report` does; what it says on stderr."""
    done = subprocess.run([sys.executable, "-B", SOURCE / "report/page", calibration_json, *arguments],
                          capture_output=True, text=True, env=os.environ | environment)
    if done.returncode:
        raise AssertionError(f"report: {done.returncode}: {done.stderr}")
    return done.stderr


def names(scene: str) -> list[str]:
    """Of its targets."""
    return [target["name"] for target in json.loads(calibration(scene).read_text(encoding="utf-8"))["targets"]]


def folder() -> Path:
    """Gone when the tests end."""
    return Path(_folder.name)


def changed(file: Path, change) -> Path:
    """A page after change(html), beside the page."""
    html = file.read_text(encoding="utf-8")
    after = change(html)
    assert after != html, "the change changed nothing"
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=_folder.name, suffix=".html", delete=False) as stream:
        stream.write(after)
    return Path(stream.name)


def without_policy(html: str) -> str:
    """Without its Content-Security-Policy, which would hide what is wrong with the page itself."""
    before, _, rest = html.partition('<meta http-equiv="Content-Security-Policy"')
    return before + rest.partition(">")[2]


def _run(*arguments, allowed: int = 0) -> None:
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    if done.returncode != allowed:
        raise AssertionError(f"{PROGRAM} {arguments[0]}: {done.returncode}: {done.stderr}")


def _simulated(out: Path, *arguments: str, influences: str = "", allowed: int = 0) -> None:
    _run("simulate", f"--out={out / 'data'}", *arguments)
    if influences:
        with open(out / "data" / "dataset.yaml", "a", encoding="utf-8") as declared:
            declared.write(f"influences: {influences}\n")
    _run("refine", out / "data", f"--out={out}", allowed=allowed)


def _add_figures(file: Path) -> None:
    """As files of older versions hold them; the tests of the program see the page of a file without them."""
    figures = file.with_name("figures.json")
    _run("report", file, f"--figures={figures}")
    found, added = json.loads(file.read_text(encoding="utf-8")), json.loads(figures.read_text(encoding="utf-8"))
    found["messages"] += added.pop("messages")
    file.write_text(json.dumps(found | added), encoding="utf-8")


def _panda(out: Path) -> Path:
    """A data set as tests/real has it, with its data beside it."""
    out.mkdir()
    (out / "mukca-panda").symlink_to(PANDA)
    return shutil.copy(SOURCE / "tests/real/mukca-panda/panda_2.yaml", out)


def _rename(file: Path, out: Path) -> None:
    """The same calibration with names that try to break out of the page, each beginning with a number of its own."""
    found = json.loads(file.read_text(encoding="utf-8"))
    found["name"] = LONG
    names = {target["name"]: _long(k) for k, target in enumerate(found["targets"])}
    known = [(each, "name") for where in (found, found["residuals"], found.get("scene") or {})
             for each in where.get("targets") or []] + [(each, "without") for each in found["jackknife"]]
    for each, key in known:
        each[key] = names[each[key]]
    for k, source in enumerate(found["inputs"]):
        source["file"] = _long(k)
    lists = [found.get("check") or {}] + [target[table] for target in found["residuals"]["targets"]
                                          for table in ("poses", "balls") if table in target]
    for each in lists:
        different = {name: _long(k) for k, name in enumerate(dict.fromkeys(each.get("names") or []))}
        each["names"] = [different[name] for name in each.get("names") or []]
    out.mkdir()
    (out / "calibration.json").write_text(json.dumps(found), encoding="utf-8")


def _long(number: int) -> str:
    return f"{number} {LONG}"[:300]


def make_all() -> None:
    shutil.rmtree(_shared, ignore_errors=True)
    _shared.mkdir(parents=True)
    wanted = [(scene, language) for scene in SCENES for language in LANGUAGES.get(scene, ["en", "de"])]
    for scene in SCENES:  # one is made of another
        calibration(scene)
    import fonts  # those of the report: what all pages share is loaded once, and every page is made by a fork
    import page as _
    import pdf as _
    fonts.font_faces()
    os.environ["TZ"] = "UTC"
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("fork")) as pool:
        for code in pool.map(_made_by_fork, *zip(*wanted)):
            if code:
                sys.exit(code)


def _made_by_fork(scene: str, language: str) -> int:
    spec = importlib.util.spec_from_file_location("report_page", SOURCE / "report/page/__main__.py")
    program = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(program)
    return program.main(_arguments(scene, language))


def _arguments(scene: str, language: str) -> list[str]:
    file = _shared / f"{scene}_{language}.html"
    pdf_too = [f"--pdf={file.with_suffix('.pdf')}"] if language == "en" and scene in PRINTED else []
    return [str(calibration(scene)), f"--out={file}", f"--language={language}", *pdf_too]


if __name__ == "__main__":
    make_all()
