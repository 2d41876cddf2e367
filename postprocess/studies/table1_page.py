"""A page in Markdown on Table 1 of Ju, Ringler and Gunzburger (2011) made anew, with a figure for each kind of mesh."""

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from mesh.discrete.quality import Quality
from postprocess.runs.folders import prepared_folder
from postprocess.studies.table1 import PUBLISHED_BISECTION, PUBLISHED_SCVT, QUALITY_LABELS, Measures, Row, measures

PAGE = "README.md"
PAGE_DOTS_PER_INCH = 80

ON_MEASURES = """Measures as in Ju, Ringler and Gunzburger
(2011), section 4: μ is the largest over the smallest distance between neighbours, σ the shortest over the longest
distance of a cell to its neighbours, q the quality of Delaunay triangles. The residual is the largest distance between
a generator and the constrained centroid of its cell, in mean spacings."""

ON_SLIPS = """The published table has slips: row 3 is shifted (its bisection σ and q are those of the SCVT, and its SCVT
ones repeat row 2), the SCVT's μ of row 4 breaks the sequence, and q avg of rows 8 and 9 cannot be. From row 7 on the
published SCVTs are not converged: μ drifts with the residual that is left. On the way to convergence μ, σ avg and q avg
overshoot, so look at the residual before comparing digits."""


def write_table1_page(folder: Path, rows: list[Row]) -> Path:
    """Write the page with the table and its figures to `folder`; return its path."""
    prepared_folder(folder)
    kinds: tuple[tuple[str, Callable[[Row], Quality], dict[int, Measures]], ...] = (
        ("bisection", lambda row: row.bisection, PUBLISHED_BISECTION),
        ("SCVT", lambda row: row.scvt, PUBLISHED_SCVT),
    )
    figures = [
        save(levels_figure(name, {row.level: measures(quality(row)) for row in rows}, published), folder, name.lower())
        for name, quality, published in kinds
    ]
    made = f"Made by `trisk quality --table1 --max-level {rows[-1].level} -o FOLDER`. {ON_MEASURES}"
    parts = ["# Quality of icosahedral meshes", made, *table1_section(rows), *figures]
    (folder / PAGE).write_text("\n\n".join(parts) + "\n")
    return folder / PAGE


def table1_section(rows: list[Row]) -> list[str]:
    """Heading, table and what is wrong with the published one, as paragraphs."""
    return ["## Table 1, ours and published", "\n".join(table1_lines(rows)), ON_SLIPS]


def table1_lines(rows: list[Row]) -> list[str]:
    """Table 1 in Markdown: for each level ours above the published values."""
    lines = [
        "| level | cells | | bisection: "
        + ", ".join(QUALITY_LABELS)
        + " | SCVT: "
        + ", ".join(QUALITY_LABELS)
        + " | residual | iterations | s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        ours, theirs = (
            " | ".join(" ".join(f"{value:.4f}" for value in values) for values in pair)
            for pair in (
                (measures(row.bisection), measures(row.scvt)),
                (PUBLISHED_BISECTION[row.level], PUBLISHED_SCVT[row.level]),
            )
        )
        tail = f"{row.scvt.residual:.1e} | {row.iterations} | {row.seconds:.1f}"
        lines.append(f"| {row.level} | {row.scvt.cells} | ours | {ours} | {tail} |")
        lines.append(f"| | | published | {theirs} | | | |")
    return lines


def levels_figure(name: str, ours: dict[int, Measures], published: dict[int, Measures]) -> Figure:
    """Each measure of one kind of mesh against the level, ours beside the published values."""
    figure = Figure(figsize=(11.0, 3.0), layout="constrained")
    for number, (axes, label) in enumerate(zip(figure.subplots(1, len(QUALITY_LABELS)), QUALITY_LABELS, strict=True)):
        axes.plot(list(ours), [values[number] for values in ours.values()], "o-", label="ours")
        axes.plot(list(ours), [published[level][number] for level in ours], "x--", label="published")
        axes.set_title(label)
        axes.set_xlabel("level")
    figure.axes[0].legend(fontsize=8)
    figure.suptitle(name)
    return figure


def save(figure: Figure, folder: Path, name: str) -> str:
    """Write a figure and give the Markdown that shows it."""
    figure.savefig(folder / f"{name}.png", dpi=PAGE_DOTS_PER_INCH)
    return f"![{name.replace('-', ' ')}]({name}.png)"
