"""Whatever stands in a file of another program, it is read or refused in a sentence."""

from __future__ import annotations

import copy
import json
import tomllib

import pytest
from exchanged import FILES, stored
from hypothesis import given
from hypothesis import strategies as st
from strategies import example_count

from addin.exchange.foreign import ForeignError
from addin.exchange.read_train import checked_train, read_train

SOURCES = {
    "openTorsion": stored("tors_system.json"),
    "ROSS": tomllib.loads((FILES / "ross_geared.toml").read_text(encoding="utf-8")),
}
ODD = st.one_of(
    st.none(),
    st.booleans(),
    st.text(max_size=5),
    st.sampled_from([0, -1, 1e308, -1e308, 1e-320, 10**400, 2.5, [], {}, [[]], [None], {"a": 1}]),
)


def sentences(text):
    """What is said against a file; nothing else may be raised."""
    try:
        read = checked_train(read_train(text))
    except ForeignError as refused:
        return [str(refused)]
    return [problem.message for problem in read.problems]


def places(thing, path=()):
    """Every place of a JSON object."""
    items = thing.items() if isinstance(thing, dict) else enumerate(thing)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


@pytest.mark.parametrize("name", SOURCES)
@example_count(300)
@given(st.data())
def test_a_spoiled_model_is_refused_in_a_sentence(name, data):
    content = copy.deepcopy(SOURCES[name])
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from(sorted(places(content), key=str)))
        thing = content
        for key in path[:-1]:
            thing = thing[key]
        thing[path[-1]] = copy.deepcopy(data.draw(ODD))
    assert all(sentence.endswith(".") for sentence in sentences(json.dumps(content)))


@example_count(300)
@given(
    st.lists(
        st.lists(
            st.sampled_from(
                ["Name", "No.", "J [kg m2]", "GD2", "K [N m/rad]", "Speed", "From", "To", "OD [mm]", "Kind",
                 "Stations", "Elements", "Meshes", "Mode", "Damping ratio [%]", "Motor", "Fan", "1", "2,5", "1.5",
                 "-3", "1e400", "kg m2", "[mm]", "total", "", "-", "=1+1", "shaft", "gear mesh", '"', "1,234", "NaN"]
            ),
            max_size=6,
        ),
        max_size=8,
    ),
    st.sampled_from(",;\t"),
)  # fmt: skip
def test_a_spoiled_table_is_refused_in_a_sentence(rows, delimiter):
    text = "\n".join(delimiter.join(row) for row in rows)
    assert all(sentence.endswith(".") for sentence in sentences(text))
