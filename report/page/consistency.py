"""Whether a calibration.json is as a program wrote it: what was edited or damaged is not filed."""
import math

import numpy as np

from calibration import Calibration, Complaint

MODELS = ["turntable", "robot-ball", "robot-tracker", "robot-profiler", "flange-ball"]
ROUNDING = 1e-6  # of a number: files are written to 17 digits


def check(c: Calibration) -> None:
    """Raises Complaint for what contradicts itself. What is absent, as in older files, is no contradiction."""
    for complaint in (_of_status(c), *map(_of_parameter, c["parameters"]), _of_covariance(c)):
        if complaint:
            raise Complaint(f"{c.file}: {complaint}; the file was edited or damaged: refine the data set again")


def _of_status(c: Calibration) -> str | None:
    if c["model"] not in MODELS:
        return f"model: found {c['model']!r}, expected {', '.join(MODELS)}"
    if c["status"] not in ("ok", "unreliable"):
        return f"status: found {c['status']!r}, expected 'ok' or 'unreliable'"
    if c["status"] == "ok" and c.get("unreliable"):
        return "status: found 'ok' beside reasons not to rely on the result"
    return None


def _of_parameter(p: object) -> str | None:
    if not isinstance(p, dict) or not isinstance(p.get("name"), str):
        return "parameters: expected a name for each"
    for key in ("value", "u", "U", "k", "dof", "u_naive", "u_clustered", "u_jackknife", "u_bootstrap"):
        if p.get(key) is not None and not _is_number(p[key]):
            return f"parameters: {p['name']}: {key}: found {p[key]!r}, expected a number"
        if key != "value" and _is_number(p.get(key)) and p[key] < 0:
            return f"parameters: {p['name']}: {key}: found {p[key]!r}, expected none below 0"
    u, k, U = p.get("u"), p.get("k"), p.get("U")
    if None not in (u, k, U) and not math.isclose(U, k * u, rel_tol=ROUNDING):
        return f"parameters: {p['name']}: U = {U:.6g} is not k u = {k * u:.6g}"
    return None


def _of_covariance(c: Calibration) -> str | None:
    u, rows = [p.get("u") for p in c.estimated], c.get("covariance")
    if not rows or None in u:
        return None
    if not isinstance(rows, list) or [isinstance(row, list) and len(row) for row in rows] != [len(u)] * len(u):
        return f"covariance: expected {len(u)} x {len(u)} numbers"
    covariance = c.covariance
    if not np.isfinite(covariance).all():
        return None
    scale = np.sqrt(np.abs(np.diag(covariance)))
    if not np.allclose(scale, u, rtol=ROUNDING, atol=0):
        return "covariance: its diagonal is not u squared"
    outer = np.outer(scale, scale)
    correlation = np.divide(covariance, outer, out=np.zeros_like(covariance), where=outer > 0)
    if not np.allclose(correlation, correlation.T, atol=ROUNDING):
        return "covariance: it is not symmetric"
    if np.linalg.eigvalsh(correlation).min() < -ROUNDING:
        return "covariance: it is not positive definite"
    return None


def _is_number(found: object) -> bool:
    return isinstance(found, (int, float)) and not isinstance(found, bool) and math.isfinite(found)
