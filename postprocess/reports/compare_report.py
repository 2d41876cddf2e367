"""The report of a comparison: its verdict, its maps and its tables."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from mesh.safe_files import name_in_text
from postprocess.compare.comparison import SHOWN_DIAGNOSTICS, Comparison, Entry, fields_of, fields_on
from postprocess.compare.shares import error_shares, shares_as_columns
from postprocess.compare.solutions import RunSolution, case_of
from postprocess.figures.plots import DOTS_PER_INCH
from postprocess.reports.captions import comparison_captions
from postprocess.reports.compare_verdict import comparison_verdict
from postprocess.reports.ranking import DIFFERENCE, ERROR, FIELD_WORDS, Wording
from postprocess.reports.sentences import Verdict
from postprocess.reports.share_columns import share_columns
from postprocess.studies.page import at_page_size, table_of, write_pictures
from postprocess.studies.study_folder import StudyRow
from swe.output.description import ABSENT_CONFIGURATION

KEYS = {"run": "run", "cells": "cells", "day": "day"}
NORM_COLUMNS = {
    **KEYS,
    **{
        f"{field}_{norm}": f"{words}, {norm.replace('linf', 'l∞')}"
        for field, words in FIELD_WORDS.items()
        for norm in ("l1", "l2", "linf")
    },
    **{f"uncertainty_{field}": f"uncertainty of {words}, l2" for field, words in FIELD_WORDS.items()},
}
CONSERVATION_COLUMNS = KEYS | {name: name.replace("_", " ") for name in SHOWN_DIAGNOSTICS[:-1]}
CONSERVATION_COLUMNS |= {"max_speed": "largest speed (m/s)"}


def comparison_rows(comparison: Comparison) -> list[StudyRow]:
    """A row for each run and day: norms where they exist, conservation, and on the last day where the error lies."""
    names = names_of([entry.run.directory for entry in comparison.entries])
    return [_row(comparison, entry) | {"run": name} for entry, name in zip(comparison.entries, names, strict=True)]


def names_of(directories: Sequence[Path]) -> list[str]:
    """What runs are called: their folders without the path, if that tells them apart."""
    whole = [directory.resolve() for directory in directories]
    told_apart = len({path.name for path in whole}) == len(set(whole))
    return [
        name_in_text(path.name if told_apart else directory) for path, directory in zip(whole, directories, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class ComparisonReport:
    """What is told of a comparison: its rows, made once, and the verdict and the page made of them."""

    comparison: Comparison

    @cached_property
    def rows(self) -> list[StudyRow]:
        """See `comparison_rows`."""
        return comparison_rows(self.comparison)

    @cached_property
    def verdict(self) -> Verdict:
        """What was found, by question."""
        return comparison_verdict(self._with_norms(), _reference(self.comparison), _wording(self.comparison))

    def write(self, maps: Sequence[Path], folder: Path, arguments: Sequence[str]) -> Path:
        """Write the report, with the `maps` drawn of the comparison, to `folder`; return its path."""
        comparison, compared = self.comparison, self._with_norms()
        day, word = comparison.days[-1], _wording(comparison)
        sections = {
            f"Norms of the {word.noun}": table_of(compared, NORM_COLUMNS),
            f"Where the {word.one} thickness lies on day {day:g}: shares of its square and of the area": table_of(
                [row for row in compared if row["day"] == day], KEYS | share_columns(word.noun)
            ),
            "Changes since the start": table_of(self.rows, CONSERVATION_COLUMNS),
        }
        case = case_of(comparison.entries[0].run)
        title = comparison.case if case is None else case.title
        days = "day" if len(comparison.days) == 1 else "days"
        text = (
            f"{title}, {days} {', '.join(f'{each:g}' for each in comparison.days)}, against: "
            f"{comparison.solution.name}. Norms are those of Williamson et al. (1992)."
        )
        return write_pictures(
            folder,
            f"Comparison: {title}, day {day:g}",
            text,
            arguments,
            sections,
            {path.stem: at_page_size(path.read_bytes(), DOTS_PER_INCH) for path in maps},
            self.verdict,
            comparison_captions(day, len(comparison.compared)),
        )

    def _with_norms(self) -> list[StudyRow]:
        return [row for row in self.rows if any(f"{field}_l2" in row for field in FIELD_WORDS)]


def _wording(comparison: Comparison) -> Wording:
    return DIFFERENCE if isinstance(comparison.solution, RunSolution) else ERROR


def _reference(comparison: Comparison) -> str:
    name = comparison.solution.name
    return f"the {name}" if name == "exact solution" else name


def _row(comparison: Comparison, entry: Entry) -> StudyRow:
    """The row of a run and day but for what the run is called."""
    configuration = ABSENT_CONFIGURATION | entry.run.record.get("configuration", {})
    row: StudyRow = {"cells": entry.run.mesh.n_cells, "day": entry.day, "scheme": configuration["scheme"]}
    for field, norms in entry.norms.items():
        row |= {f"{field}_{name}": value for name, value in asdict(norms).items() if np.isfinite(value)}
    if entry.norms:
        uncertainty = comparison.solution.uncertainty(entry.day)
        row |= {f"uncertainty_{field}": value for field, value in uncertainty.items()}
    if entry.norms and entry.day == comparison.days[-1]:
        run = entry.run
        error = fields_of(run, entry.day).thickness - fields_on(run, comparison.solution, entry.day).thickness
        row |= shares_as_columns(error_shares(run.mesh, error))
    return row | entry.conservation
