"""Errors of a robot's links, in units that fit them: lengths in mm, angles in mrad."""
import math
import re
from dataclasses import dataclass, replace

from calibration import LINK_ERROR, Calibration

UNITS = ["mm", "mrad"]


@dataclass(frozen=True)
class LinkError:
    """value (nan: not known), U and prior in its unit; nominal in mm or rad, as the file has it."""
    name: str
    link: int
    unit: str
    kind: str  # of what determines it: data, prior, considered, held
    value: float
    u: float
    U: float  # 0: none is stated; of what was considered 2 u
    k: float | None
    nominal: float | None
    prior: float
    prior_u: float  # 0: no prior

    @property
    def prior_U(self) -> float:
        """With the k of U."""
        return self.prior_u * (self.k or 2.0)


def link_errors(c: Calibration) -> list[LinkError]:
    """In the order of the file: link by link; without uncertainties where the result is unreliable."""
    found = [_link_error(parameter, c.get("determined") or {}) for parameter in c["parameters"]
             if LINK_ERROR.fullmatch(parameter["name"])]
    return found if c.is_reliable else [replace(each, u=0.0, U=0.0, k=None) for each in found]


def _link_error(parameter: dict, determined: dict[str, str]) -> LinkError:
    name, role, k = parameter["name"], parameter["role"], parameter.get("k")
    unit, factor = ("mrad", 1000.0) if parameter["unit"] == "rad" else ("mm", 1.0)
    value = math.nan if parameter.get("value") is None else factor * parameter["value"]
    u, U, prior, prior_u = (factor * (parameter.get(key) or 0.0) for key in ("u", "U", "prior", "prior_u"))
    by_prior = determined.get(name) == "prior"
    kind = {"estimate": "prior" if by_prior else "data", "consider": "considered"}.get(role, "held")
    U = {"estimate": U, "consider": 2 * u}.get(role, 0.0)
    return LinkError(name, int(re.sub(r"\D", "", name)), unit, kind, value, u, U, k, parameter.get("nominal"),
                     prior, prior_u)
