"""Write what torsionbook exports of the trains of `exchanged`, for the other programs to load: run in tests/exchange."""

import json
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2])]
from exchanged import FILES, geared_train, row_of_stations, shaft_of_sections  # noqa: E402  (beside this file)

from addin.exchange.opentorsion import opentorsion_of  # noqa: E402
from addin.exchange.ross import ross_of  # noqa: E402

EXPORTED = {
    "exported_to_ross.json": lambda: ross_of(row_of_stations())[0],
    "exported_sections_to_ross.json": lambda: ross_of(shaft_of_sections())[0],
    "exported_to_opentorsion.json": lambda: opentorsion_of(geared_train(), "geared")[0],
}

if __name__ == "__main__":
    for name, content in EXPORTED.items():
        text = json.dumps(content(), indent=1) + "\n"
        (FILES / name).write_text(text, encoding="utf-8")
