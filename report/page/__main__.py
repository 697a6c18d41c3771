"""calibration.json -> one page that is filed; started by `scancal report`. It reads that file and standard input."""
import signal
signal.signal(signal.SIGINT, signal.SIG_DFL)  # until main() can say what is missing
import argparse  # noqa: E402
import json
import sys
import traceback
from pathlib import Path

PACKAGES = {"jinja2": "python3-jinja2", "markupsafe": "python3-markupsafe", "matplotlib": "python3-matplotlib",
            "numpy": "python3-numpy", "fontTools": "python3-fonttools", "weasyprint": "weasyprint"}


def missing(error: ModuleNotFoundError) -> str:
    if error.name not in PACKAGES:
        raise error
    return (f"scancal: {error.name} is missing in {sys.executable}: install {PACKAGES[error.name]}, or name a Python "
            "that has it in the environment variable SCANCAL_PYTHON")


try:
    import consistency
    from calibration import Complaint, read_calibration
    from language import LANGUAGES, Language
    from output import check_outputs, write_whole
except ModuleNotFoundError as module:
    sys.exit(missing(module))


def arguments(given: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scancal report")
    parser.add_argument("calibration", type=Path)
    parser.add_argument("--out", type=Path, help="HTML page")
    parser.add_argument("--pdf", type=Path, help="the same page, printed on A4")
    parser.add_argument("--dcc", type=Path, help="Digital Calibration Certificate, XML")
    parser.add_argument("--figures", action="store_true",
                        help="standard input holds what the file leaves out for figures: {} or null if nothing")
    parser.add_argument("--fonts", type=Path, help="file in which the page's fonts are kept from run to run")
    parser.add_argument("--previous", type=Path, help="an earlier calibration.json: as found, as left")
    parser.add_argument("--language", choices=LANGUAGES, default="en")
    return parser.parse_args(given)


def main(given: list[str] | None = None) -> int:
    """given: arguments in place of the command line's."""
    choice = arguments(given)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        check_outputs([choice.out, choice.pdf, choice.dcc], [choice.calibration, choice.previous])
        calibration = read_calibration(choice.calibration)
        if choice.figures:
            calibration.add_figures(json.load(sys.stdin))
        previous = read_calibration(choice.previous) if choice.previous else None
        for each in filter(None, [calibration, previous]):
            consistency.check(each)
        language = Language(choice.language, calibration, previous)
        if choice.out or choice.pdf:
            from page import render_page  # Matplotlib takes half a second, and a certificate needs none
            html = render_page(calibration, previous, language, choice.fonts)
            if choice.out:
                write_whole(choice.out, html.encode())
            if choice.pdf:
                from pdf import foot, print_page
                print_page(html, foot(calibration, language), choice.pdf)
        if choice.dcc:
            from dcc import write_certificate
            write_certificate(calibration, previous, language, choice.dcc)
    except Complaint as complaint:
        print(f"scancal: {complaint}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(missing(error), file=sys.stderr)
        return 1
    except Exception as error:  # whatever an edited file may lead to, in one sentence
        place = traceback.extract_tb(error.__traceback__)[-1]
        print(f"scancal: {choice.calibration}: a damaged or edited file, or a mistake of this program "
              f"({type(error).__name__}: {str(error)[:80]}; {Path(place.filename).name}:{place.lineno}); "
              "refine the data set again", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        unwritten = ", ".join(str(file) for file in (choice.out, choice.pdf, choice.dcc) if file)
        print(f"\nscancal: interrupted: {unwritten}: not all of it was written", file=sys.stderr)
        return 130  # as a shell has it
    return 0


if __name__ == "__main__":
    sys.exit(main())
