"""Tables of a study as Parquet: columns declared once with unit and meaning, rows rebuilt from the cases' folders."""

import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from studies.base.atomic_file import write_atomically


@dataclass(frozen=True)
class Column:
    """One column of a table."""

    name: str
    type: pa.DataType
    meaning: str
    """With the unit in square brackets."""


def write_rows(path: Path, columns: Sequence[Column], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows; a column that a row leaves out is empty, one that is not declared is an error."""
    rows = [dict(row) for row in rows]
    schema = pa.schema([pa.field(c.name, c.type, metadata={"meaning": c.meaning}) for c in columns])
    unknown = {name for row in rows for name in row} - set(schema.names)
    if unknown:
        raise ValueError(f"columns {sorted(unknown)} are not declared for {path.name}")
    buffer = io.BytesIO()
    pq.write_table(pa.Table.from_pylist(rows, schema=schema), buffer)
    write_atomically(path, buffer.getvalue())


def read_rows(path: Path) -> list[dict[str, Any]]:
    """The rows in order."""
    return pq.read_table(path).to_pylist()
