"""Lines and cells of text files: delimiters, decimal commas, blank cells, comments."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.records import Array

LONGEST_LINE = 1_000_000  # characters of a text file
MAX_EXTRA_LINES = 1000  # lines of a text file that are no samples
EMPTY_CELLS = {"", "nan", "na", "n/a", "null", "none", "-"}  # cells without a value
COMMENT = ("#", "%", "//")
DELIMITERS = ("\t", ";", ",")  # else blanks


def text_lines(content: bytes, name: str, limits: ImportSettings) -> Iterator[str]:
    """Yield the lines of a text file, with their ends; empty ones count as well.

    Raises:
        UnusableRecording: a line is too long, or there are more than a file within the limits needs.
    """
    text = io.TextIOWrapper(io.BytesIO(content), "utf-8-sig", newline="")
    number = 0
    while line := text.readline(LONGEST_LINE + 1):
        number += 1
        if len(line) > LONGEST_LINE:
            raise UnusableRecording(f"{name}, line {number}: over {LONGEST_LINE} characters, the limit; split the line")
        if number > limits.max_samples + MAX_EXTRA_LINES:
            raise UnusableRecording(
                f"{name}: over {number - 1} lines; the limit is {limits.max_samples} samples (imports.max_samples); "
                "split the file"
            )
        yield line


def numbered_lines(content: bytes, name: str, limits: ImportSettings) -> list[tuple[int, str]]:
    """Return the lines that are not empty, with their numbers from 1.

    Raises:
        UnusableRecording: the file is not text, or over the limits.
    """
    try:
        stripped = ((number, line.strip("\r\n")) for number, line in enumerate(text_lines(content, name, limits), 1))
        found = [(number, line) for number, line in stripped if line.strip()]
    except UnicodeDecodeError as error:
        raise UnusableRecording(f"{name}: not a text file: {error}") from None
    if any("\0" in line for _, line in found[:100]):
        raise UnusableRecording(f"{name}: not a text file: it holds zero bytes")
    return found


def delimiter_of(line: str) -> str:
    """Return what separates the cells of a line; a blank stands for any number of them."""
    return next((mark for mark in DELIMITERS if mark in line), " ")


def cells_of(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line, without blanks around them."""
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def is_comment(line: str) -> bool:
    """Tell whether a line is a comment."""
    return line.lstrip().startswith(COMMENT)


def is_number(cell: str, delimiter: str) -> bool:
    """Tell whether a cell is blank or a number."""
    try:
        number(cell, delimiter)
    except ValueError:
        return False
    return True


def number(cell: str, delimiter: str) -> float:
    """Return the number in a cell, NaN if it is blank; a comma is a decimal one where it does not separate cells.

    Raises:
        ValueError: it is none.
    """
    if cell.lower() in EMPTY_CELLS:
        return float("nan")
    try:
        return float(cell)
    except ValueError:
        if "," in cell and delimiter != ",":
            return float(cell.replace(",", "."))
        raise


def table(
    rows: Iterable[tuple[int, list[str]]], columns: Sequence[int], width: int, name: str, delimiter: str
) -> Array:
    """Return the numbers of some columns (rows, columns).

    Args:
        rows: each with the number of its line.
        width: how many columns the header has; empty cells behind them do not count.

    Raises:
        UnusableRecording: a row is too short or too long, or a cell is no number.
    """
    values = np.empty((0, len(columns)))
    read: list[list[float]] = []
    for line, row in rows:
        if len(row) < width or any(row[width:]):
            raise UnusableRecording(
                f"{name}, line {line}: {len(row)} values, the header has {width} columns; is the file truncated?"
            )
        try:
            read.append([number(row[k], delimiter) for k in columns])
        except ValueError as error:
            raise UnusableRecording(f"{name}, line {line}: {error}") from None
    return np.array(read, dtype=np.float64) if read else values
