"""deploy/kubernetes: valid by Kubernetes' own schemas (bundled in a package; no network), and consistent with itself."""

from __future__ import annotations

import re
import shutil
import subprocess
import warnings
from pathlib import Path
from typing import Any

import pytest
import yaml

from api.metrics import Metrics
from store.database import Database
from store.migrations import upgrade
from store.settings import Settings

from .tools import DEPLOY, comments, our_commands, understood

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import kubernetes_validate

FOLDER = DEPLOY / "kubernetes"
PLAIN = ("namespace", "migrate", "api", "workers", "ingress")
VERSIONS = ("1.29", "1.33")
"""Of Kubernetes: those it is checked for."""


def documents() -> list[dict[str, Any]]:
    return [one for name in PLAIN for one in yaml.safe_load_all((FOLDER / f"{name}.yaml").read_text())]


def named(kind: str, name: str) -> dict[str, Any]:
    [found] = [one for one in documents() if (one["kind"], one["metadata"]["name"]) == (kind, name)]
    return found


def pods() -> list[tuple[str, dict[str, Any]]]:
    """Of jobs and deployments: name and what its pods are."""
    kinds = ("Job", "Deployment")
    return [(one["metadata"]["name"], one["spec"]["template"]["spec"]) for one in documents() if one["kind"] in kinds]


KUSTOMIZATION: dict[str, Any] = yaml.safe_load((FOLDER / "kustomization.yaml").read_text())


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("document", documents(), ids=lambda one: f"{one['kind']}-{one['metadata']['name']}")
def test_the_schemas_of_kubernetes_take_it(document: dict[str, Any], version: str) -> None:
    kubernetes_validate.validate(document, version, strict=True)


def test_the_schemas_find_faults() -> None:
    wrong = named("Deployment", "api")
    wrong["spec"]["template"]["spec"]["containers"][0]["livenesProbe"] = {}
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(wrong, VERSIONS[0], strict=True)


def test_kustomize_builds_it(tmp_path: Path) -> None:
    """With the example's secrets filled in, as the file tells people to do; and with the autoscaler."""
    if not shutil.which("kubectl"):
        pytest.skip("no kubectl, which builds kustomizations; the files are checked one by one")
    place = tmp_path / "kubernetes"
    shutil.copytree(FOLDER, place)
    (place / "secrets.env").write_text(
        (FOLDER / "secrets.env.example").read_text().replace("SECRET=", "SECRET=" + "s" * 64)
    )
    for component in ("", "\ncomponents: [autoscaler]\n"):
        (place / "kustomization.yaml").write_text((FOLDER / "kustomization.yaml").read_text() + component)
        done = subprocess.run(["kubectl", "kustomize", str(place)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        made = list(yaml.safe_load_all(done.stdout))
        assert ("ScaledObject" in {one["kind"] for one in made}) == bool(component)
        for one in made:
            if one["kind"] != "ScaledObject":
                kubernetes_validate.validate(one, VERSIONS[-1], strict=True)
            if one["kind"] not in ("Namespace",):
                assert one["metadata"]["namespace"] == "slowdrift", one["kind"]
        images = {image for one in made for image in re.findall(r"image: (\S+)", yaml.safe_dump(one))}
        assert images == {"registry.example.org/slowdrift:0.1.0"}


def test_every_file_is_listed() -> None:
    listed = {*KUSTOMIZATION["resources"], "kustomization.yaml"}
    assert {path.name for path in FOLDER.glob("*.yaml")} == listed
    ignored = (FOLDER / ".gitignore").read_text().split()
    assert ignored == ["secrets.env"]


def test_settings_and_secrets_are_ours() -> None:
    lines = [*(FOLDER / "settings.env").read_text().split(), *(FOLDER / "secrets.env.example").read_text().split()]
    values = dict(line.split("=", 1) for line in lines)
    for name in values:
        assert name.removeprefix("SLOWDRIFT_").lower() in Settings.model_fields, name
    settings = Settings.from_env(values)
    assert settings.accounts == "on"
    assert settings.behind_proxy
    assert values["SLOWDRIFT_SECRET"] == ""
    hosts = [rule["host"] for rule in named("Ingress", "slowdrift")["spec"]["rules"]]
    assert [f"https://{host}" for host in hosts] == [settings.public_url]
    for name, pod in pods():
        [container] = pod["containers"]
        sources = [*container["envFrom"][0]["configMapRef"].values(), *container["envFrom"][1]["secretRef"].values()]
        assert sources == ["settings", "secrets"], name


def test_commands_are_understood(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, pod in pods():
        [container] = pod["containers"]
        assert container["command"][0] == "slowdrift", name
        understood(container["command"][1:], monkeypatch)
        for probe in ("livenessProbe", "readinessProbe", "startupProbe"):
            if "exec" in container.get(probe, {}):
                assert understood(container[probe]["exec"]["command"][1:], monkeypatch).check
    commands = our_commands(comments(FOLDER / "kustomization.yaml"))
    assert len(commands) == 1
    understood(commands[0], monkeypatch)


def test_probes_pods_and_services_fit() -> None:
    api = named("Deployment", "api")["spec"]["template"]["spec"]["containers"][0]
    assert api["livenessProbe"]["httpGet"]["path"] == "/healthz"
    assert api["readinessProbe"]["httpGet"]["path"] == "/readyz"
    assert api["readinessProbe"]["timeoutSeconds"] > 2  # it answers within 2 s
    port = {one["name"]: str(one["containerPort"]) for one in api["ports"]}["http"]
    assert api["command"][api["command"].index("--port") + 1] == port
    labels = named("Deployment", "api")["spec"]["template"]["metadata"]["labels"]
    assert named("Service", "api")["spec"]["selector"].items() <= labels.items()
    for name, pod in pods():
        [container] = pod["containers"]
        assert pod["securityContext"]["runAsNonRoot"], name
        assert container["securityContext"]["capabilities"]["drop"] == ["ALL"], name
        assert container["resources"]["limits"]["memory"], name
        assert {"livenessProbe", "readinessProbe"} & set(container) or name == "migrate", name
        for mount in container["volumeMounts"]:
            assert mount["name"] in {volume["name"] for volume in pod["volumes"]}, name
        limit = int(container["resources"]["limits"]["memory"].removesuffix("Gi")) * 1073
        if "worker" in container["command"]:  # a task's own limit comes before the container's, which kills
            assert limit > Settings().task_memory_mb, name


def test_the_autoscaler_reads_our_metric(tmp_path: Path) -> None:
    """KEDA's own schema is in no package: the fields that its documentation names for a Prometheus trigger."""
    assert yaml.safe_load((FOLDER / "autoscaler" / "kustomization.yaml").read_text())["resources"] == ["worker.yaml"]
    scaled = yaml.safe_load((FOLDER / "autoscaler" / "worker.yaml").read_text())
    assert (scaled["apiVersion"], scaled["kind"]) == ("keda.sh/v1alpha1", "ScaledObject")
    spec = scaled["spec"]
    target = named("Deployment", spec["scaleTargetRef"]["name"])
    assert "replicas" not in target["spec"], "the next apply would undo the autoscaler's number"
    assert 1 <= spec["minReplicaCount"] < spec["maxReplicaCount"]
    [trigger] = spec["triggers"]
    assert trigger["type"] == "prometheus"
    assert set(trigger["metadata"]) == {"serverAddress", "query", "threshold"}
    assert all(isinstance(value, str) for value in trigger["metadata"].values())
    database = Database(f"sqlite:///{tmp_path / 'slowdrift.db'}")
    upgrade(database)
    text = Metrics(database).text().decode()
    database.close()
    for name in re.findall(r"slowdrift_\w+", trigger["metadata"]["query"]):
        assert f"# TYPE {name} gauge" in text, name
    assert "queue" not in target["spec"]["template"]["spec"]["containers"][0]["command"]  # that is queue `runs`
    assert 'queue="runs"' in trigger["metadata"]["query"]
