"""Result JSON that somebody or something spoilt: judged or refused, never a crash."""

from __future__ import annotations

import copy
import json
import random
from typing import Any

import jsonschema
import pytest

from addin.diff.compare import compare_files
from addin.diff.files import CannotBeCompared
from addin.diff.wording import as_json as diff_json
from addin.reading.one_file import read_checked
from addin.reference.json_schemas import diff_schema, verify_schema
from addin.verify import json_file
from addin.verify.json_file import read_results_json, verify_results_json
from addin.verify.wording import as_json, lines
from addin.writing.recalculate import recalculate_case

JUNK: tuple[Any, ...] = (
    None, True, -1, 0, 1e308, float("inf"), float("nan"), 10**400, "", "=1+1", "x" * 40_000, [], {}, [[]],
    [None], {"element": []}, [{"mode": {}, "element": [1], "check": {}}], "\u202e", "12,5",
)  # fmt: skip


def spoilt(content: Any, rng: random.Random) -> Any:
    """One to three places of a tree replaced, removed or doubled."""
    content = copy.deepcopy(content)
    for _ in range(rng.randint(1, 3)):
        node = content
        while True:
            keys = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not keys:
                break
            key = rng.choice(keys)
            child = node[key]
            if isinstance(child, dict | list) and child and rng.random() < 0.8:
                node = child
                continue
            act = rng.random()
            if act < 0.7:
                node[key] = copy.deepcopy(rng.choice(JUNK))
            elif act < 0.85:
                del node[key]
            elif isinstance(node, list):
                node.append(copy.deepcopy(child))
            break
    return content


@pytest.fixture(scope="module")
def whole(calculated):
    return json.loads((calculated / "train.results.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def again(calculated):
    read = read_checked(calculated / "case.xlsx")
    return read, recalculate_case(read, {})


@pytest.mark.parametrize("seed", range(25))
def test_spoilt_results_are_judged(seed, whole, again, tmp_path, monkeypatch):
    read, run = again
    monkeypatch.setattr(json_file, "recalculate_case", lambda *_: run)
    target = tmp_path / "spoilt.json"
    content = {"case_sha256": 7} | spoilt(whole, random.Random(seed))
    target.write_text(json.dumps(content), encoding="utf-8")
    found = verify_results_json(target, read_results_json(target), read)
    assert found.outcome in ("follows", "does not follow")
    assert list(lines(found))
    json.dumps(as_json(found), allow_nan=False)
    jsonschema.Draft202012Validator(verify_schema()).validate(as_json(found))


@pytest.mark.parametrize("seed", range(25))
def test_spoilt_results_are_compared_or_refused(seed, whole, calculated, tmp_path):
    target = tmp_path / "spoilt.json"
    target.write_text(json.dumps(spoilt(whole, random.Random(seed))), encoding="utf-8")
    try:
        found = compare_files(calculated / "train.results.json", target)
    except CannotBeCompared:
        return  # with its problems, which the command lists
    json.dumps(diff_json(found), allow_nan=False)
    jsonschema.Draft202012Validator(diff_schema()).validate(diff_json(found))
