"""Mesh files damaged at random, and what comes of it: python tests/reliability/mutate_meshes.py COUNT [SEED].

Every mutation must end in a `MeshError` of one sentence, or in a mesh that passes `validate_mesh` and is that of the
undamaged file: the same connectivity, and numbers that differ by less than `NOISE`, what files of others may carry.
Each is read in a process that may die or hang without harm. Prints a table and exits with 1 if any ended otherwise.
"""

import collections
import concurrent.futures
import functools
import multiprocessing
import re
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from mesh import MeshError, VoronoiMesh, mesh_from_points, read_mesh, scvt_mesh
from mesh.conventions import BY_NAME, MESH_VARIABLES
from mesh.discrete.validate import OUTSIDE_TOLERANCE, validate_mesh
from mesh.files.io import write_mesh

NOISE = 10 * OUTSIDE_TOLERANCE
"""Relative to the size of a cell."""

SECONDS = 60.0
"""A reading that takes longer hangs."""

FORMATS = ("NETCDF4", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA")
UNUSED = {"mesh_density"}
"""Arrays that no run depends on."""

File = dict[str, Any]
Random = np.random.Generator


def load(path: Path) -> File:
    """Dimensions, attributes and variables of a file."""
    with netCDF4.Dataset(path) as source:
        source.set_auto_mask(False)
        return {
            "dimensions": {name: len(dimension) for name, dimension in source.dimensions.items()},
            "attributes": {name: source.getncattr(name) for name in source.ncattrs()},
            "variables": {name: (variable.dimensions, variable[:]) for name, variable in source.variables.items()},
        }


def save(file: File, path: Path, file_format: str) -> None:
    """Write a file; values of a variable are cut or repeated where its dimensions were changed."""
    with netCDF4.Dataset(path, "w", format=file_format) as target:
        target.setncatts(file["attributes"])
        for name, size in file["dimensions"].items():
            target.createDimension(name, size)
        for name, (dimensions, values) in file["variables"].items():
            variable = target.createVariable(name, values.dtype, dimensions)
            variable[:] = np.resize(values, variable.shape)


def _entry(file: File, random: Random, integer: bool | None = None, names: list[str] | None = None) -> tuple[str, Any]:
    """A random variable, of integers or not where that is said, and a random place in it."""
    chosen = names or [
        name
        for name, (_, values) in file["variables"].items()
        if integer is None or (values.dtype.kind == "i") == integer
    ]
    name = str(random.choice(chosen))
    values = file["variables"][name][1]
    return name, tuple(int(random.integers(size)) for size in values.shape)


def flip_index(file: File, random: Random) -> str:
    """Another number at one place of an index array, valid or not."""
    name, place = _entry(file, random, names=[v.file_name for v in MESH_VARIABLES if v.integer])
    file["variables"][name][1][place] = random.choice([random.integers(0, 400), -1, 0, 2**31 - 1, -(2**31)])
    return name


def swap_entries(file: File, random: Random) -> str:
    """Two entries of one array, or two rows of it, change places."""
    name, place = _entry(file, random)
    values = file["variables"][name][1]
    _, other = _entry(file, random, names=[name])
    if random.random() < 0.5:
        place, other = place[:1], other[:1]
    values[place], values[other] = np.copy(values[other]), np.copy(values[place])
    return name


def perturb_number(file: File, random: Random) -> str:
    """One coordinate, length, area, angle or weight changes, by little or much."""
    name, place = _entry(file, random, integer=False)
    values = file["variables"][name][1]
    values[place] += (np.abs(values[place]) + 1e-3) * random.normal() * 10.0 ** random.integers(-9, 2)
    return name


def put_special(file: File, random: Random) -> str:
    """One number becomes NaN, infinite, huge, zero or of the other sign."""
    name, place = _entry(file, random, integer=False)
    values = file["variables"][name][1]
    values[place] = random.choice([np.nan, np.inf, -np.inf, 1e300, 0.0, -values[place]])
    return name


def drop_variable(file: File, random: Random) -> str:
    """A variable is missing."""
    name = str(random.choice(list(file["variables"])))
    del file["variables"][name]
    return name


def change_dimension(file: File, random: Random) -> str:
    """A dimension is a little longer or shorter, empty, doubled, or has another name."""
    name = str(random.choice(list(file["dimensions"])))
    size = file["dimensions"][name]
    if random.random() < 0.2:
        file["dimensions"]["other"] = file["dimensions"].pop(name)
        for variable, (dimensions, values) in file["variables"].items():
            renamed = tuple("other" if dimension == name else dimension for dimension in dimensions)
            file["variables"][variable] = (renamed, values)
    else:
        file["dimensions"][name] = int(random.choice([1, max(1, size - 1), size + 1, 2 * size]))
    return name


def change_type(file: File, random: Random) -> str:
    """A variable is of another type."""
    name = str(random.choice(list(file["variables"])))
    dimensions, values = file["variables"][name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file["variables"][name] = (dimensions, values.astype(random.choice(["i2", "f4", "f8", "i4", "S1"])))
    return name


def change_attribute(file: File, random: Random) -> str:
    """An attribute has another value, or is missing."""
    name = str(random.choice(["on_a_sphere", "sphere_radius", "density_name", "mesh_spec"]))
    if random.random() < 0.3:
        file["attributes"].pop(name, None)
    else:
        file["attributes"][name] = [0.0, -1.0, np.nan, "NO", "", 2.0, "YES", 6371220.0][random.integers(8)]
    return name


def truncate(data: bytearray, random: Random) -> bytearray:
    """The file ends early."""
    return data[: int(random.integers(len(data)))]


def garble(data: bytearray, random: Random) -> bytearray:
    """Some bytes are others; one time in two they are among the first, where the file says what it holds."""
    last = len(data) if random.random() < 0.5 else min(len(data), 4096)
    for _ in range(int(random.integers(1, 9))):
        data[int(random.integers(last))] = int(random.integers(256))
    return data


def blank(data: bytearray, random: Random) -> bytearray:
    """A stretch of the file is zero."""
    start = int(random.integers(len(data)))
    stop = min(len(data), start + int(random.integers(1, 2000)))
    data[start:stop] = bytes(stop - start)
    return data


OF_CONTENT: tuple[Callable[[File, Random], str], ...] = (
    *(flip_index, swap_entries, perturb_number, put_special),
    *(drop_variable, change_dimension, change_type, change_attribute),
)
OF_BYTES: tuple[Callable[[bytearray, Random], bytearray], ...] = (truncate, garble, blank)


@functools.cache
def originals() -> tuple[VoronoiMesh, ...]:
    """The meshes that are damaged: regular, of random points with cells of 3 to 10 sides, and of a density."""
    random = np.random.default_rng(5)
    return (
        scvt_mesh(42),
        mesh_from_points(random.normal(size=(60, 3))),
        scvt_mesh(100, density="refined-circle", start="fibonacci", tolerance=1e-3),
    )


def mutate(number: int, seed: int, folder: Path) -> tuple[str, VoronoiMesh, Path]:
    """Write the mutation of this number; give its kind, the mesh that was damaged and the path."""
    random = np.random.default_rng([seed, number])
    original = originals()[int(random.integers(len(originals())))]
    path = folder / f"mutation{number}.nc"
    write_mesh(original, path)
    file, file_format = load(path), str(random.choice(FORMATS))
    kinds = (*OF_CONTENT, *OF_BYTES)
    kind = kinds[number % len(kinds)]
    if kind in OF_CONTENT:
        kind(file, random)  # type: ignore[arg-type]
    save(file, path, file_format)
    if kind in OF_BYTES:
        path.write_bytes(kind(bytearray(path.read_bytes()), random))  # type: ignore[arg-type]
    return kind.__name__, original, path


def outcome(number: int, seed: int, folder: Path) -> tuple[str, str]:
    """Kind of a mutation, and what reading it ended in; words that begin with WRONG are of what must not be."""
    kind, original, path = mutate(number, seed, folder)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = read_mesh(path)
    except MeshError as error:
        message = str(error)
        if "\n" in message or not message.startswith(f"{path}: ") or len(message) > 500:
            return kind, f"WRONG: no sentence: {message!r}"
        return kind, f"refused: {_without_details(message.removeprefix(f'{path}: '))}"
    except Exception as error:
        return kind, f"WRONG: {type(error).__name__}: {error}"
    finally:
        path.unlink()
    validate_mesh(found, OUTSIDE_TOLERANCE)
    difference = _difference(found, original)
    return kind, f"WRONG: accepted with {difference}" if difference else "harmless: the mesh is the same"


def _without_details(message: str) -> str:
    """What kind of error a message tells of, without entities, names and values."""
    message = re.sub(r"^(cells|edges|vertices) .*? \(counted from 0\): ", "", message)
    message = re.split(r"[;(]| instead of | by up to | to \d", message)[0]
    message = re.sub(r"\b[a-z]+(?:[A-Z][A-Za-z]*)+\b(?:, [a-z][A-Za-z]* or [a-z][A-Za-z]*)?", "NAME", message)
    return re.sub(r"-?\b[\d.]+(?:e[+-]?\d+)?\b|'.*?'|\bnan\b|\binf\b", "...", message).strip()


def _difference(found: VoronoiMesh, original: VoronoiMesh) -> str:
    """What differs between two meshes beyond noise, in words; empty where nothing does."""
    if abs(found.sphere_radius - original.sphere_radius) > 0.0:
        return f"sphere_radius {found.sphere_radius}"
    spacing = np.sqrt(original.area_cell.min())
    for name in BY_NAME:
        if name in UNUSED:
            continue
        one, other = getattr(found, name), getattr(original, name)
        if one.shape != other.shape:
            return f"{name} of shape {one.shape}"
        if BY_NAME[name].integer:
            if not np.array_equal(one, other):
                return f"other {name}"
            continue
        difference = np.abs(one - other)
        if name.startswith(("lon", "angle")):
            difference = np.minimum(difference, np.abs(difference - 2.0 * np.pi))
        limit = NOISE * np.maximum(np.abs(other), spacing**2 if "area" in name else spacing)
        if name.startswith("lon"):
            # A meridian is no place near a pole: what counts is the distance that a longitude is off.
            difference = difference * np.cos(getattr(original, name.replace("lon", "lat")))
        if not np.all(difference <= limit):
            return f"{name} off by {difference.max():.1e}"
    return ""


def run(count: int, seed: int) -> dict[str, collections.Counter[str]]:
    """Outcomes of `count` mutations by kind."""
    table: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    context = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as name:
        pending = list(range(count))
        while pending:
            with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
                while pending:
                    number = pending.pop(0)
                    try:
                        kind, words = pool.submit(outcome, number, seed, Path(name)).result(timeout=SECONDS)
                    except concurrent.futures.process.BrokenProcessPool:
                        kind, words = "any", f"WRONG: mutation {number} of seed {seed} ended the process"
                    except TimeoutError:
                        for process in list(pool._processes.values()):
                            process.kill()
                        kind, words = "any", f"WRONG: mutation {number} of seed {seed} hangs"
                    if words.startswith("WRONG") and kind != "any":
                        words = f"{words} (mutation {number} of seed {seed})"
                    table[kind][words] += 1
                    if kind == "any":
                        break
    return table


def main(count: int, seed: int) -> int:
    """Print the table of `count` mutations; give the number of those that ended as they must not."""
    table = run(count, seed)
    wrong = 0
    for kind in sorted(table):
        print(f"{kind}: {sum(table[kind].values())}")
        for words, number in table[kind].most_common():
            print(f"  {number:4d}  {words}")
            wrong += number if words.startswith("WRONG") else 0
    print(f"{count - wrong} of {count} refused in a sentence or harmless")
    return wrong


if __name__ == "__main__":
    sys.exit(1 if main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0) else 0)
