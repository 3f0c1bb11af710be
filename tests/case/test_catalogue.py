"""The catalogue: published numbers to their digits, and line types that take theirs from it."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import jsonschema_rs
import pytest

from solver import catalogue
from solver.case import Case, load_case, parse_case, to_yaml
from solver.case.catalogue_entries import describe, list_entries
from solver.case.catalogued import catalogue_warnings, taken_values
from solver.catalogue import UNITS, entries, entry
from solver.outcome import CaseError
from store.pointers import replaced
from tests.systems import span

GRADES = ("ORQ", "R3", "R3S", "R4", "R4S", "R5")
BREAKING = {  # kN
    76: (4621.45, 4884.28, 5453.75, 6001.31, 6658.39, 7008.83),
    120: (10452.1, 11046.5, 12334.5, 13572.9, 15058.9, 15851.5),
    147: (14699.8, 15535.8, 17347.2, 19088.9, 21178.9, 22293.6),
}
STIFFNESS = {120: (1112.88, 1164.90, 1267.59), 147: (1633.35, 1725.17, 1871.94)}  # MN: R3, R4, R5 studless


def at(name: str, diameter: float, stiffness: str | None = None) -> dict[str, float]:
    return {key: value.value for key, value in entry(name).at(diameter, stiffness).items()}


def made(kind: dict[str, Any]) -> Case:
    """A hanging line of one type."""
    case = span(100.0, (0, 0, -50), (80, 0, -50))
    case["line_types"] = {"wire": kind}
    return parse_case(case)


@pytest.mark.parametrize("link", ["studless", "studlink"])
@pytest.mark.parametrize("size", BREAKING)
def test_breaking_load_of_chain(size: int, link: str) -> None:
    loads = [at(f"chain-{grade}-{link}", size / 1e3)["breaking_load"] / 1e3 for grade in GRADES]
    assert [float(f"{load:.6g}") for load in loads] == list(BREAKING[size])


@pytest.mark.parametrize("size", STIFFNESS)
def test_stiffness_of_studless_chain(size: int) -> None:
    found = [at(f"chain-{grade}-studless", size / 1e3)["EA"] / 1e6 for grade in ("R3", "R4", "R5")]
    assert [round(value, 2) for value in found] == list(STIFFNESS[size])
    assert at("chain-R4-studless", size / 1e3)["EA"] == at("chain-R4-studless", size / 1e3, "e301")["EA"]


def test_stiffness_by_orcaflex_and_of_studlink_chain() -> None:
    assert at("chain-R4-studless", 0.12, "orcaflex")["EA"] == pytest.approx(1229.76e6, rel=1e-9)
    assert at("chain-R5-studless", 0.147, "orcaflex")["EA"] == pytest.approx(1845.41e6, rel=1e-5)
    assert at("chain-R3-studlink", 0.12)["EA"] == pytest.approx(5.6e10 * math.pi * 0.12**2 / 2, rel=1e-9)
    assert at("chain-R3-studlink", 0.12, "orcaflex")["EA"] == pytest.approx(1.01e11 * 0.0144, rel=1e-9)


ROPES = {  # diameter, kg/m, MN, MN static, MN at a mean load of 20 %
    "polyester": (0.2, 27.16, 12.32, 172.48, 241.47), "nylon": (0.2, 23.4, 10.12, 50.6, 99.99),
    "hmpe": (0.1, 4.96, 6.451, 361.3, 450.3),
}  # fmt: skip


@pytest.mark.parametrize("name", ROPES)
def test_fibre_ropes(name: str) -> None:
    diameter, mass, load, static, dynamic = ROPES[name]
    found = at(name, diameter)
    assert found["mass"] == pytest.approx(mass, rel=1e-9)
    assert found["breaking_load"] / 1e6 == pytest.approx(load, rel=1e-9)
    assert found["EA"] / 1e6 == pytest.approx(static, rel=2e-4)
    fast = found["dynamic_EA.a"] + found["dynamic_EA.b"] * 0.2 * found["breaking_load"]
    assert fast / 1e6 == pytest.approx(dynamic, rel=1e-4)


def test_wire_rope() -> None:
    found = at("wire", 0.1)
    assert (found["mass"], found["breaking_load"], found["EA"]) == pytest.approx((52.93, 10.22e6, 971e6), rel=1e-9)
    assert found["volume"] == pytest.approx(math.pi / 4 * 0.118**2, rel=1e-9)


def test_weight_in_water() -> None:
    """Chain by the density of steel: 0.1 m studless weighs 173.0 kg/m, 200 kg/m of steel 173.9."""
    for name, kilograms in (("chain-R4-studless", 173.016), ("chain-R4-studlink", 190.404)):
        assert describe(name, "100 mm")["weight_in_water"] == pytest.approx(9.80665 * kilograms, rel=1e-5)
    assert describe("polyester", 0.2)["weight_in_water"] == pytest.approx(9.80665 * 27.16 * (1 - 1025 / 1380), rel=1e-9)
    assert describe("hmpe", 0.1)["weight_in_water"] < 0
    assert describe("hmpe", 0.1, None, "900 kg/m3")["weight_in_water"] > 0


@pytest.mark.parametrize("name", entries())
def test_every_number_grows_with_the_diameter_and_has_a_source(name: str) -> None:
    one = entry(name)
    low, high = one.diameter
    for stiffness in one.stiffnesses or (None,):
        sizes = [low + (high - low) * step / 20 for step in range(21)]
        tables = [one.at(size, stiffness) for size in sizes]
        assert {"mass", "volume", "breaking_load", "EA", "drag.normal", "added_mass.normal"} <= set(tables[0])
        assert set(tables[0]) <= set(UNITS)
        for key in ("mass", "volume", "breaking_load", "EA"):
            values = [table[key].value for table in tables]
            assert values == sorted(values), key
            assert values[0] > 0
            assert tables[0][key].formula
        for value in tables[0].values():
            assert value.source
            assert value.status in ("verified", "unverified")


def test_what_is_not_verified_is_listed() -> None:
    doubtful = {item["name"]: item["unverified"] for item in list_entries()}
    assert doubtful["chain-R6-studless"] == ["breaking_load", "EA"]
    assert doubtful["chain-R4S-studless"] == ["EA"]
    assert doubtful["chain-R4-studless"] == doubtful["polyester"] == []


# -- line types


def test_a_line_type_takes_what_is_left_out() -> None:
    kind = made({"catalogue": "chain-R4-studless", "diameter": "120 mm"}).line_types["wire"]
    assert (kind.mass, kind.drag.normal, kind.drag.tangential) == pytest.approx((286.56, 2.4, 1.15))
    assert (kind.EA / 1e6, kind.breaking_load) == pytest.approx((1164.90, 13572.864e3), rel=1e-5)
    assert kind.volume == pytest.approx(286.56 / 7850)
    assert (kind.added_mass.normal, kind.added_mass.tangential) == (1.0, 0.5)


def test_what_is_given_stands_coefficient_by_coefficient() -> None:
    given = {"EA": "900 MN", "drag": {"normal": 2.0}, "submerged_weight": "2.5 kN/m", "breaking_load": "12 MN"}
    kind = made({"catalogue": "chain-R4-studless", "diameter": 0.12, **given}).line_types["wire"]
    assert (kind.EA, kind.breaking_load, kind.submerged_weight, kind.volume) == (900e6, 12e6, 2500.0, None)
    assert (kind.drag.normal, kind.drag.tangential, kind.mass) == pytest.approx((2.0, 1.15, 286.56))
    assert kind.catalogue_values is not None
    assert set(taken_values(kind.catalogue_values)) == {
        "mass", "drag.tangential", "added_mass.normal", "added_mass.tangential",
    }  # fmt: skip


def test_the_stored_case_keeps_what_was_typed_apart_from_what_was_taken() -> None:
    case = made({"catalogue": "chain-R4-studless", "diameter": "120 mm", "drag": {"normal": 2.0}})
    written = json.loads(case.canonical())["line_types"]["wire"]
    record = written.pop("catalogue_values")
    assert written == {
        "catalogue": "chain-R4-studless", "diameter": 0.12,
        "EI": 0.0, "compression": "none", "drag": {"normal": 2.0}, "added_mass": {},
    }  # fmt: skip
    assert (record["mass"], record["drag"]) == (pytest.approx(286.56), {"tangential": 1.15})
    for text in (case.canonical(), to_yaml(case)):
        assert load_case(text) == case
        assert load_case(text).content_hash() == case.content_hash()
    jsonschema_rs.validator_for(Case.model_json_schema()).validate(json.loads(case.canonical()))


def test_the_schema_needs_mass_and_stiffness_or_the_catalogue() -> None:
    schema = jsonschema_rs.validator_for(Case.model_json_schema())
    case = span(100.0, (0, 0, -50), (80, 0, -50))
    for kind, good in (
        ({"diameter": 0.1, "catalogue": "wire"}, True), ({"diameter": 0.1, "mass": 1, "EA": 1}, True),
        ({"diameter": 0.1, "mass": 1}, False), ({"catalogue": "wire"}, False),
        ({"diameter": 0.1, "catalogue": "string"}, False),
    ):  # fmt: skip
        assert schema.is_valid(case | {"line_types": {"wire": kind}}) is good, kind


def test_a_type_without_the_catalogue_is_written_as_before() -> None:
    kind = json.loads(made({"diameter": 0.1, "mass": 50.0, "EA": 5e8}).canonical())["line_types"]["wire"]
    assert not {"catalogue", "stiffness", "catalogue_values", "drag_diameter", "volume", "submerged_weight"} & set(kind)


@pytest.mark.parametrize(
    ("pointer", "value", "mass", "EA"),
    [
        ("/line_types/wire/diameter", "147 mm", 19.9e3 * 0.147**2, 1725.17e6),
        ("/line_types/wire/catalogue", "chain-R5-studless", 286.56, 1267.59e6),
        ("/line_types/wire/stiffness", "orcaflex", 286.56, 1229.76e6),
        ("/line_types/wire/EA", 1e9, 286.56, 1e9),
        ("/line_types/wire/drag/normal", 2.0, 286.56, 1164.90e6),
    ],
)
def test_an_override_of_a_stored_case_takes_the_values_that_belong_to_it(
    pointer: str, value: object, mass: float, EA: float
) -> None:
    base = json.loads(made({"catalogue": "chain-R4-studless", "diameter": "120 mm"}).canonical())
    kind = parse_case(replaced(base, {pointer: value})).line_types["wire"]
    assert (kind.mass, kind.EA) == pytest.approx((mass, EA), rel=1e-5)


def test_a_later_catalogue_changes_no_stored_case(monkeypatch: pytest.MonkeyPatch) -> None:
    case = made({"catalogue": "chain-R4-studless", "diameter": "120 mm"})
    stored, old = case.canonical(), entry("chain-R4-studless")
    laws = old.laws | {"mass": old.laws["mass"] | {"powers": {2: 20.0e3}}}
    later = entries() | {old.name: replace(old, laws=laws)}
    monkeypatch.setattr(catalogue, "entries", lambda: later)
    assert list(catalogue_warnings(case))  # patched
    again = load_case(stored)
    assert again.line_types["wire"].mass == pytest.approx(286.56)
    assert again.content_hash() == case.content_hash()
    told = list(catalogue_warnings(again))
    assert len(told) == 2  # the volume follows the mass
    assert "mass is 286.56 kg/m as stored with the case" in told[0]
    new = made({"catalogue": "chain-R4-studless", "diameter": "120 mm"})
    assert new.line_types["wire"].mass == pytest.approx(288.0)
    assert new.content_hash() != case.content_hash()
    assert list(catalogue_warnings(new)) == []


def test_unverified_values_are_warned_of_and_ones_own_are_not() -> None:
    kind = {"catalogue": "chain-R6-studless", "diameter": "120 mm"}
    told = list(catalogue_warnings(made(kind)))
    assert [text.split()[3] for text in told] == ["breaking_load", "EA"]
    assert list(catalogue_warnings(made(kind | {"breaking_load": "16 MN", "stiffness": "orcaflex"}))) == []


FAULTS = [
    ({"catalogue": "chain-R9-studless", "diameter": "120 mm"}, "catalogue", "there is no 'chain-R9-studless'"),
    ({"catalogue": "chain-R4-studless", "diameter": "230 mm"}, "diameter", "allowed: 20 to 220 mm"),
    ({"catalogue": "chain-R4-studless", "diameter": "12 mm"}, "diameter", "0.012 m is outside the range"),
    ({"catalogue": "chain-R4-studless", "diameter": "120 kg"}, "diameter", "unit 'kg' is not known"),
    ({"catalogue": "chain-R4-studless"}, "diameter", "required"),
    ({"catalogue": "polyester", "diameter": 0.2, "stiffness": "e301"}, "stiffness", "one EA only"),
    ({"diameter": 0.1, "mass": 1.0, "EA": 1.0, "stiffness": "e301"}, "stiffness", "give `catalogue`"),
    ({"catalogue": ["wire"], "diameter": 0.1}, "catalogue", "valid string"),
    ({"diameter": 0.1, "mass": 1.0}, "EA", "required"),
]


@pytest.mark.parametrize(("kind", "field", "words"), FAULTS)
def test_faults_stand_at_their_field(kind: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(CaseError) as caught:
        made(kind)
    [error] = caught.value.errors
    assert error.loc == ("line_types", "wire", field)
    assert words in error.message
