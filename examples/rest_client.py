"""The FPSO through REST: submit, follow, print. Give the service's address, or start one with `slowdrift serve`."""

import json
import sys
import urllib.request
from pathlib import Path

url = (sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8000") + "/api/v1"


def call(path, body=None):
    request = urllib.request.Request(
        url + path, json.dumps(body).encode() if body else None, {"Content-Type": "application/json"}
    )
    return urllib.request.urlopen(request)


case = Path(__file__).with_name("fpso-2000m.yaml").read_text()
run = json.load(call("/runs", {"yaml": case, "analyses": ["statics", "frequency_domain", "modes"]}))
for line in call(f"/runs/{run['id']}/events"):  # server-sent events, until the run has ended
    if line.startswith(b"data: "):
        run = json.loads(line[6:])
        print(run["state"], f"{run['progress']:.0%}", run["message"])
sigma = json.load(call(f"/runs/{run['id']}/summary"))["frequency_domain"]["vessel_std"]
print(f"surge sigma: {sigma['wf']['surge']:.2f} m at wave frequencies, {sigma['lf']['surge']:.2f} m slow drift")
