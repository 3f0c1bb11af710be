"""Known vulnerabilities of the locked packages: `python .ci/audit.py requirements.lock …`.

Exit status 1: a locked package has one that pyproject.toml does not list, with a reason, under [tool.audit]. Where
no database of vulnerabilities can be reached, it says so and exits with 0: CI does not depend on the network.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SERVICES = ("pypi", "osv")
SECONDS = 120


def accepted() -> dict[str, str]:
    """Ids of findings that we live with, and why."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        listed = tomllib.load(file).get("tool", {}).get("audit", {}).get("accepted", [])
    for each in listed:
        if not each.get("id") or len(each.get("reason", "")) < 10:
            raise SystemExit(f"pyproject.toml, [tool.audit]: {each} needs an id and a reason")
    return {each["id"]: each["reason"] for each in listed}


def asked(lock: str, service: str) -> list[dict[str, object]] | None:
    """The packages with their findings; None where the database did not answer."""
    command = [sys.executable, "-m", "pip_audit", "-r", lock, "--no-deps", "--disable-pip", "-f", "json", "-s", service]
    try:
        done = subprocess.run(
            [*command, "--progress-spinner", "off", "--timeout", "10"],
            capture_output=True, text=True, timeout=SECONDS, check=False,
        )  # fmt: skip
        found: list[dict[str, object]] = json.loads(done.stdout)["dependencies"]
    except (subprocess.TimeoutExpired, ValueError, KeyError):
        return None
    return found


def findings(packages: list[dict[str, object]], known: dict[str, str]) -> list[str]:
    """Those that are not accepted, a sentence each."""
    found = []
    for package in packages:
        for each in package.get("vulns", []):  # type: ignore[attr-defined]
            names = {each["id"], *each.get("aliases", [])}
            if not names & known.keys():
                mended = ", ".join(each.get("fix_versions", [])) or "no version yet"
                found.append(f"{package['name']} {package['version']}: {each['id']}; mended in {mended}")
    return found


def main(locks: list[str]) -> int:
    if importlib.util.find_spec("pip_audit") is None:
        print("not audited: pip-audit is not installed (extra dev)")
        return 0
    known, bad = accepted(), []
    for lock in locks:
        answers = (asked(lock, service) for service in SERVICES)
        packages = next((found for found in answers if found is not None), None)
        if packages is None:
            print(f"{lock}: not audited, since no database of vulnerabilities can be reached from here")
            continue
        print(f"{lock}: {len(packages)} packages audited")
        bad += findings(packages, known)
    for each in sorted(set(bad)):
        print(each)
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
