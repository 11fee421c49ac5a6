"""The `model` of a case file as a `Case`.

Nodes, shafts and gears as the files have them: `k_ground`, `c_ground`, `eta_ground` of a node are a
spring, a damper and a loss factor to ground; a gear says theta_child = ratio · theta_parent, so the
child's Speed ratio is |ratio| times its parent's, a negative ratio is an external mesh and a
positive one an internal mesh. Per-unit and translational models keep their numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from engine.case.case import Case
from engine.case.data import ElementRow, MeshRow, StationRow


def speed_ratios(model: Mapping[str, Any]) -> dict[str, float]:
    """Speed of each node over the speed of the first one."""
    near: dict[str, list[tuple[str, float]]] = {node["id"]: [] for node in model["nodes"]}
    for shaft in model["shafts"]:
        near[shaft["i"]].append((shaft["j"], 1.0))
        near[shaft["j"]].append((shaft["i"], 1.0))
    for gear in model.get("gears", []):
        near[gear["parent"]].append((gear["child"], abs(gear["ratio"])))
        near[gear["child"]].append((gear["parent"], 1.0 / abs(gear["ratio"])))
    first = model["nodes"][0]["id"]
    ratio, stack = {first: 1.0}, [first]
    while stack:
        node = stack.pop()
        for other, factor in near[node]:
            if other not in ratio:
                ratio[other] = ratio[node] * factor
                stack.append(other)
    return ratio


def case_of(model: Mapping[str, Any], **scalars: Any) -> Case:
    """A checked case of a file's lumped model; `scalars` are further fields of `Case`."""
    ratio = speed_ratios(model)
    stations = tuple(
        StationRow(n["id"], None, n["J"], ratio[n["id"]], damping=n.get("c_ground"))
        for n in model["nodes"]
    )
    elements = [
        ElementRow(f"{s['i']}-{s['j']}", "shaft", s["i"], s["j"], s["k"], damping=s.get("c"))
        for s in model["shafts"]
    ]
    meshes = []
    for gear in model.get("gears", []):
        name = f"{gear['parent']}:{gear['child']}"
        elements.append(ElementRow(name, "gear mesh", gear["parent"], gear["child"]))
        meshes.append(MeshRow(name, "external" if gear["ratio"] < 0 else "internal"))
    for n in model["nodes"]:
        if n.get("k_ground"):
            elements.append(
                ElementRow(
                    f"{n['id']} to ground", "spring to ground", n["id"], "ground", n["k_ground"],
                    loss_factor=n.get("eta_ground"),
                )
            )  # fmt: skip
    return Case(stations=stations, elements=tuple(elements), meshes=tuple(meshes), **scalars)


def largest_is_one(shape: np.ndarray) -> np.ndarray:
    """Columns scaled so that the entry of largest magnitude is +1, as files and sheets print them."""
    rows = np.argmax(np.abs(shape), axis=0)
    return shape / shape[rows, np.arange(shape.shape[1])]
