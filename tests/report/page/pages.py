"""Pages to test: of calibrations that the program makes now, none of them kept."""
import functools
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
PROGRAM = os.environ.get("SCANCAL_PROGRAM", str(SOURCE / "build" / "scancal"))
EVIL = '"><script>window.ran = 1</script><img src=x onerror="window.ran = 1"> Prüfkörper \'€ $a_b$\' {{ 7 * 7 }} жук '
LONG = (EVIL + "very long " * 30)[:300]

_folder = tempfile.TemporaryDirectory(prefix="scancal_page_")


@functools.cache
def calibration(scene: str) -> Path:
    """calibration.json of a scene: sample, robot; bad is one on which nobody should rely."""
    out = folder() / scene
    if scene == "sample":
        _run("refine", SOURCE / "data/sample", f"--out={out}", "--montecarlo=200")
    elif scene == "robot":
        _run("refine", SOURCE / "data/robot-sample", f"--out={out}")
    elif scene == "bad":
        _run("simulate", f"--out={out / 'data'}", "--placements=1", "--tilt_x=1", "--sweep=4", "--profiles=12",
             "--points=9")
        _run("refine", out / "data", f"--out={out}", allowed=2)
    elif scene == "named":
        _rename(calibration("sample"), out)
    else:
        _rename(calibration("robot"), out)
    return out / "calibration.json"


@functools.cache
def page(scene: str, language: str = "en") -> Path:
    file = folder() / f"{scene}_{language}.html"
    report(calibration(scene), f"--out={file}", f"--language={language}")
    return file


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


def _rename(file: Path, out: Path) -> None:
    """The same calibration with names that try to break out of the page; targets stay apart by a number."""
    found = json.loads(file.read_text(encoding="utf-8"))
    names = {target["name"]: f"{k} {LONG}"[:300] for k, target in enumerate(found["targets"])}
    names |= {found["name"]: LONG} | {source["file"]: f"{k} {LONG}"[:300] for k, source in enumerate(found["inputs"])}
    out.mkdir()
    (out / "calibration.json").write_text(json.dumps(_with_names(found, names)), encoding="utf-8")


def _with_names(value, names: dict[str, str]):
    if isinstance(value, dict):
        return {names.get(key, key): _with_names(inner, names) for key, inner in value.items()}
    if isinstance(value, list):
        return [_with_names(inner, names) for inner in value]
    return names.get(value, value) if isinstance(value, str) else value
