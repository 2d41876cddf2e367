"""Cost of a step against size, for a quiet machine: python tests/benchmarks/solver_speed.py OUTPUT [CELLS ...].

Runs `trisk bench` in a process of its own for each size, prints a row when it is measured, and writes the measurements
to OUTPUT.json and their figure to OUTPUT.png. Sizes measured before are kept unless they are named.
"""

import json
import subprocess
import sys
from pathlib import Path

from matplotlib.figure import Figure

SIZES = (2562, 10242, 40962, 163842, 655362, 2621442)

SERIES = {
    "ns_per_cell_step": ("fused over tiles", "o-"),
    "plain_ns_per_cell_step": ("plain loops, stored weights", "s-"),
}


def main(output: Path, sizes: list[int]) -> None:
    """Measure `sizes`, merge them into the measurements of `output` and draw all."""
    record = output.with_suffix(".json")
    timings = {timing["cells"]: timing for timing in json.loads(record.read_text())} if record.exists() else {}
    for cells in sizes:
        command = [sys.executable, "-m", "trisk", "bench", "--json", "--quiet", "--cells", str(cells)]
        timings.update({cells: json.loads(subprocess.run(command, check=True, capture_output=True).stdout)[0]})
        print(json.dumps(timings[cells]), flush=True)
        record.write_text(json.dumps([timings[size] for size in sorted(timings)], indent=1) + "\n")
    draw([timings[size] for size in sorted(timings)], output.with_suffix(".png"))


def draw(timings: list[dict[str, float]], path: Path) -> None:
    """Cost per cell and step against the number of cells, with what the triad would take for the same bytes."""
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    cells = [timing["cells"] for timing in timings]
    for name, (label, style) in SERIES.items():
        axes.plot(cells, [timing[name] for timing in timings], style, label=label)
    limit = [timing["bytes_per_cell_step"] / timing["triad_gb_per_s"] for timing in timings]
    axes.plot(cells, limit, "k:", label="the bytes that must move, at the rate of the triad")
    for timing in timings:
        place = (timing["cells"], timing["ns_per_cell_step"])
        axes.annotate(
            f"{timing['plain_twin_ratio']:.1f}x", place, (0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set(xscale="log", yscale="log", xlabel="cells", ylabel="ns per cell and RK4 step")
    axes.set_yticks([50, 100, 200, 500, 1000], labels=["50", "100", "200", "500", "1000"])
    axes.set_title("Test case 5: cost of a step, and how many times cheaper than plain loops", fontsize=10)
    axes.grid(True, which="major", alpha=0.4)
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [int(word) for word in sys.argv[2:]] or list(SIZES))
