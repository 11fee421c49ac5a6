"""Tables of text: those of makers are read with their units, and what is exported comes back as it was."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from command_line import command, environment, torsionbook
from exchanged import geared_train, imported
from hypothesis import given
from hypothesis import strategies as st
from strategies import cases, example_count

from addin.contract.units import parse_unit
from addin.exchange.read_train import checked_train, read_train
from addin.exchange.text_tables import TRAIN_TABLES, table_text
from addin.reading.case_json import case_to_json, read_case_json
from addin.template.examples import EXAMPLES
from addin.template.filled import example_of
from engine.case.case import Case
from engine.case.data import (
    TABLES,
    CaseData,
    MaterialRow,
    MeshRow,
    SectionMaterialRow,
    SectionRow,
    SNPointRow,
)

#: lb ft² and lbf in, by definition of pound, inch and g. [kg m², N m]
LB_FT2, LBF_IN = 0.45359237 * 0.3048**2, 4.4482216152605 * 0.0254


def told(text):
    """Sentences of what is wrong."""
    return [problem.message for problem in checked_train(read_train(text)).problems]


def test_a_makers_table_of_masses_and_shafts():
    """Semicolons, decimal commas, WR², pounds for pounds-force, a gear where the speed changes, a sum below."""
    text = (
        "MASS ELASTIC DATA;;;;;\n"
        "No.;Name;WR2 (lb-ft2);Stiffness (10^6 in-lb/rad);Speed (rpm);Weight (lb)\n"
        "1;Motor;10934,1;2212,7;1800;9000\n"
        "2;Bull gear;3983;;1800;4000\n"
        "3;Pinion;16,2;106,2;10080;300\n"
        "4;Compressor;442,1;;10080;900\n"
        "Total;;15375;;;\n"
    )
    train = read_train(text)
    case = checked_train(train).case()
    assert [s.station for s in case.stations] == ["Motor", "Bull gear", "Pinion", "Compressor"]
    assert case.stations[0].inertia == pytest.approx(10934.1 * LB_FT2, rel=1e-12)
    assert [s.speed_ratio for s in case.stations] == [1.0, 1.0, 5.6, 5.6]
    shaft, mesh, quill = case.elements
    assert (shaft.from_, shaft.to) == ("Motor", "Bull gear")
    assert shaft.stiffness == pytest.approx(2212.7e6 * LBF_IN, rel=1e-12)
    assert (mesh.kind, mesh.stiffness) == ("gear mesh", None)
    assert quill.stiffness == pytest.approx(106.2e6 * LBF_IN, rel=1e-12)
    notes = " ".join(train.notes)
    for words in (
        "decimal commas",
        "'Weight (lb)'",
        "sums: line 7",
        "Gear mesh 'Bull gear - Pinion'",
        "to the next row",
        "refer to the first row, 'Motor'",
    ):
        assert words in notes


@pytest.mark.parametrize(
    ("header", "unit", "inertia"),
    [
        ("GD2", "kgf m2", 3.0),  # J = GD²/4
        ("GD²", "kg·m²", 3.0),
        ("WR2", "lb-ft2", 12.0 * LB_FT2),
        ("J", "kg.m^2", 12.0),
        ("Inertia", "t*m^2", 12000.0),
    ],
)
def test_inertia_by_the_choice_of_the_header(header, unit, inertia):
    clipboard = f"Name\t{header}\tK\n\t[{unit}]\t[MNm/rad]\nMotor\t12\t\nquill\t\t3.5\nFan\t12\t\n"
    case = imported(clipboard)
    assert [s.inertia for s in case.stations] == pytest.approx([inertia, inertia], rel=1e-12)
    assert [(e.from_, e.to, e.stiffness) for e in case.elements] == [("Motor", "Fan", 3.5e6)]


def test_two_tables_one_of_masses_and_one_of_shafts():
    case = imported(
        "No.,Name,J [kg m2]\n1,Motor,30\n2,Hub,2\n3,Fan,80\n\n"
        "Shaft,From,To,k [N m/rad],OD [mm]\nquill,1,2,2e6,110\ntail,Hub,3,1e6,\n"
    )
    assert [(e.element, e.from_, e.to) for e in case.elements] == [
        ("quill", "Motor", "Hub"),
        ("tail", "Hub", "Fan"),
    ]
    assert case.elements[0].od == pytest.approx(0.11)
    by_order = imported("Name,J [kg m2]\nA,3\nB,2\nC,8\n\nNo.,K [N m/rad]\n1,2e6\n2,1e6\n")
    assert [(e.from_, e.to, e.stiffness) for e in by_order.elements] == [
        ("A", "B", 2e6),
        ("B", "C", 1e6),
    ]


def test_kilograms_in_the_place_of_a_force_are_said():
    train = read_train("Name,J [kg m2],K [kg m/rad]\nA,3,\nB,2,2e5\n")
    assert checked_train(train).case().elements[0].stiffness == pytest.approx(2e5 * 9.80665)
    assert "Unit 'kg m/rad' of Stiffness is read as kgf m/rad." in train.notes


def test_a_stiffness_beside_the_mass_behind_it():
    case = imported("Name,J [kg m2],K [N m/rad]\nA,3,\nB,2,2e6\nC,8,1e6\n")
    assert [e.stiffness for e in case.elements] == [2e6, 1e6]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Name,Inertia\nA,1\nB,2\n", "Column 'Inertia': it has no unit"),
        ("Name,Inertia [lbf ft]\nA,1\n", "Column 'Inertia [lbf ft]'"),
        ("Name,J [kg m2],K [N m/rad]\nA,3,1\nB,2,2\n", "Line 3: every mass has a stiffness"),
        ("Name,J [kg m2],K [N m/rad]\nA,3,\n,,1\n,,2\nB,2,\n", "2 masses and 2 lines"),
        ("Name,J [kg m2],K [N m/rad]\nA,3,1e6\nB,abc,\n", "Line 3 (Stations, Inertia): found 'abc'"),
        ("Name,J [kg m2],K [N m/rad]\nA,3,-1e6\nB,5,\n", "Line 2 (Elements, Stiffness): found -1e+06"),
        ("Name,J [kg m2]\nA,3\nB,5\n\nNo.,K [N m/rad]\n1,1\n2,2\n", "2 shafts for 2 stations"),
        ('Name,J [kg m2]\n"A' + 200_000 * "x" + ",3\n", "field larger"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_by_line_and_column(text, words):
    try:
        messages = told(text)
    except Exception as error:  # a text that is none at all
        messages = [str(error)]
    assert any(words in message for message in messages), messages


def test_thousands_and_decimal_commas():
    assert imported('Name,J [kg m2]\nA,"12,345.5"\n').stations[0].inertia == 12345.5
    assert imported("Name;J [kg m2]\nA;12.345,5\n").stations[0].inertia == 12345.5
    assert imported("Name\tJ [kg m2]\nA\t1,5\n").stations[0].inertia == 1.5
    # in a text of tabs three digits behind a comma may be thousands: it is asked, not guessed
    assert "found '12,345" in told("Name\tJ [kg m2]\nA\t12,345\n")[0]


# --- what is exported comes back ------------------------------------------------------------------


def there_and_back(case: Case, delimiter: str) -> Case:
    """Typed as a case JSON, exported as text, imported."""
    read = read_case_json(case_to_json(case))
    example = example_of(read, "si")
    return checked_train(read_train(table_text(example.tables, example.units, delimiter))).data


def rows_of_train(case):
    return {name: getattr(case, TABLES[name][0]) for name in TRAIN_TABLES}


@example_count(60)
@given(
    cases(stations=(2, 30), dampers=True, loss_factors=True, grounded=None),
    st.sampled_from(",\t;"),
)
def test_any_train_comes_back(case, delimiter):
    assert rows_of_train(there_and_back(case, delimiter)) == rows_of_train(case)


@example_count(60)
@given(
    st.lists(
        st.text(st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp")), min_size=1).map(str.strip),
        min_size=4, max_size=4, unique_by=str.casefold,
    ).filter(all),
    st.sampled_from(",\t;"),
)  # fmt: skip
def test_names_come_back(names, delimiter):
    """Quotes, delimiters, words of headers and numbers as names of stations."""
    train = geared_train()
    old = [s.station for s in train.stations]
    new = dict(zip(old, [*names, *old[4:]], strict=True))
    renamed = read_case_json(
        case_to_json(
            CaseData(
                stations=tuple(replace(s, station=new[s.station]) for s in train.stations),
                elements=tuple(
                    replace(e, from_=new[e.from_], to=new[e.to]) for e in train.elements
                ),
                meshes=train.meshes,
            )
        )
    )
    example = example_of(renamed, "si")
    back = checked_train(read_train(table_text(example.tables, example.units, delimiter)))
    assert rows_of_train(back.data) == rows_of_train(renamed.data)


def test_sections_meshes_and_materials_come_back():
    train = geared_train()
    elements = tuple(
        replace(e, stress_diameter=0.08, material="shaft steel") if e.element == "Quill" else e
        for e in train.elements
        if e.element != "Coupling F"
    )
    stepped = replace(train.elements[2], stiffness=None, kind="shaft")
    case = Case(
        **vars(train)
        | {
            "elements": (*elements, stepped),
            "sections": (
                SectionRow("Coupling F", "1", 0.3, 0.1, fillet=0.004, material="cast iron"),
                SectionRow("Coupling F", "2", 0.4, 0.12, id=0.02, penetration=1 / 3),
            ),
            "section_materials": (SectionMaterialRow("cast iron", 45e9, 7200.0, "own"),),
            "meshes": (
                MeshRow("Gear", "external", 0.1, 0.1 * 29 / 143, teeth_drive=143, teeth_driven=29),
            ),
            "materials": (MaterialRow("shaft steel", 700e6, 400e6, 200e6, "torsion"),),
            "sn_points": (SNPointRow("shaft steel", 1e3, 300e6), SNPointRow("shaft steel", 1e6, 200e6)),
        }
    )  # fmt: skip
    assert rows_of_train(there_and_back(case, ",")) == rows_of_train(case)


@pytest.mark.parametrize("name", ["proposed", "backlash"])
def test_the_commands_bring_an_example_back_in_its_own_units(tmp_path: Path, name: str):
    steps = (
        ("new", "one.xlsx", "--example", name),
        ("export", "one.xlsx", "one.csv"),
        ("import", "one.csv", "--out", "two.xlsx"),
        ("export", "two.xlsx", "two.csv"),
        ("check", "two.xlsx"),
    )
    for step in steps:
        done = torsionbook(*step, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    one, two = ((tmp_path / f"{n}.csv").read_text(encoding="utf-8") for n in ("one", "two"))
    assert one == two
    typed = EXAMPLES[name].tables["Elements"][0]["Stiffness"]
    assert f"Motor shaft,shaft,Motor,LS hub M,{typed}" in one
    assert parse_unit("lbf*in/rad", "torsional stiffness").factor == pytest.approx(LBF_IN)


def test_import_from_a_pipe_and_files_that_are_none(tmp_path: Path):
    done = subprocess.run(
        command("import", "-", "--out", "a.json"),
        cwd=tmp_path, env=environment(), input="Name\tJ [kg·m²]\nA\t3\n".encode(), capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert read_case_json(tmp_path / "a.json").data.stations[0].inertia == 3.0
    wrong = torsionbook("import", "a.json", "--out", "b.xlsx", cwd=tmp_path)
    assert wrong.returncode == 1
    assert "this is a case JSON" in wrong.stderr
    book = torsionbook("import", "none.csv", "--out", "b.xlsx", cwd=tmp_path)
    assert book.returncode == 1
    assert "not found" in book.stderr
    assert not (tmp_path / "b.xlsx").exists()


def test_a_train_longer_than_the_template_makes_a_workbook(tmp_path: Path):
    rows = "".join(f"S{i},{1 + i},1e6\n" for i in range(60))
    text = f"Name,J [kg m2],K [N m/rad]\n{rows}End,5,\n"
    (tmp_path / "long.csv").write_text(text, encoding="utf-8")
    done = torsionbook("import", "long.csv", "--out", "long.xlsx", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = torsionbook("export", "long.xlsx", "back.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    back = read_case_json(tmp_path / "back.json").data
    assert back.stations == imported(text).stations
    assert back.elements == imported(text).elements
