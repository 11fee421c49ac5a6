"""Raw samples as a file: CSV or Parquet, every number with all its digits."""

from __future__ import annotations

import csv
from pathlib import Path

from addin.xlsx.whole_files import write_whole
from engine.studies.tolerances.raw_samples import RawSamples

#: Endings of a file of samples.
SAMPLE_ENDINGS = (".csv", ".parquet")


def samples_refusal(path: Path) -> str:
    """Why samples cannot become this file; empty where they can."""
    if path.suffix.lower() not in SAMPLE_ENDINGS:
        return f"{path} is no name of a file of samples; end it in .csv or .parquet."
    if path.suffix.lower() == ".parquet":
        try:
            import pyarrow.parquet  # noqa: F401  (said in time)
        except ImportError:
            return (
                f"{path} would be Parquet, and pyarrow is not installed. End it in .csv, or run pip "
                "install -r requirements/parquet.txt in the checkout (the wheel has the extra [parquet])."
            )
    return ""


def write_samples(path: Path, samples: RawSamples) -> None:
    """Write samples whole or not at all.

    Parameters
    ----------
    path : Path
        A name that `samples_refusal` has nothing against. [path]
    samples : RawSamples
        Rows; in CSV numbers have as many digits as give them back to the bit, and blank is no answer.

    Raises
    ------
    OSError
        If it cannot be written; a file that was there is as before.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, lambda new: _WRITERS[path.suffix.lower()](new, samples))


def _as_csv(path: Path, samples: RawSamples) -> None:
    with open(path, "w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(samples.columns)
        lines.writerows(samples.rows)


def _as_parquet(path: Path, samples: RawSamples) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = zip(*samples.rows, strict=True) if samples.rows else ([] for _ in samples.columns)
    arrays = [pa.array(list(column)) for column in columns]
    pq.write_table(pa.table(arrays, names=list(samples.columns)), path, compression="zstd")


_WRITERS = {".csv": _as_csv, ".parquet": _as_parquet}
