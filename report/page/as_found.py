"""As found and as left: this calibration beside an earlier one of the same instrument, as `scancal report` compared
them (solver/uncertainty/difference.h): left["difference"]."""
from dataclasses import dataclass

from calibration import Calibration


@dataclass(frozen=True)
class Change:
    """Of one parameter that both have estimated; mm or rad. None: an uncertainty is not known."""
    found: dict
    left: dict
    change: float | None
    u: float | None    # of the change
    e_n: float | None


def changes(found: Calibration, left: Calibration) -> list[Change]:
    told = [Change(found.parameter(each["name"]), left.parameter(each["name"]), each["change"], each["u"], each["E_n"])
            for each in left["difference"]["changes"]]
    return told if found.is_reliable and left.is_reliable else [_without_U(each) for each in told]


def doubts(left: Calibration, language: str) -> list[str]:
    """What makes the comparison doubtful, worst first."""
    return [each.get(language) or each["en"] for each in left["difference"]["doubts"]]


def shared(left: Calibration) -> list[str]:
    """Influences that are one and the same error in both."""
    return left["difference"]["shared"]


def _without_U(change: Change) -> Change:
    """Where one of the two is unreliable nobody knows how far they may lie apart."""
    found, left = ({key: value for key, value in each.items() if key not in ("u", "U", "k")}
                   for each in (change.found, change.left))
    return Change(found, left, change.change, None, None)
