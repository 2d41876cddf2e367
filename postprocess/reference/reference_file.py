"""NetCDF files of reference solutions: harmonics, rounded to a fraction of their uncertainty, and their origin."""

import json
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import netCDF4
import numpy as np

from cases.finding.registry import find_case
from mesh.arrays import Array
from mesh.safe_files import AnyPath, dataset, written_aside
from postprocess.reference.harmonics import Coefficients, Harmonics, truncation_of
from postprocess.reference.making import MEASURES, Reference
from postprocess.reference.stored_references import stored_path
from swe.errors import InputError
from swe.output.files import package_versions


@dataclass(frozen=True)
class StoredField:
    """A field of the file: its units, and the measure whose uncertainty says how finely it is stored."""

    units: str
    measure: str


STORED_FIELDS = {
    "vorticity": StoredField("s-1", "vorticity"),
    "divergence": StoredField("s-1", "vorticity"),
    "surface_height": StoredField("m", "thickness"),
}
"""Stored fields in the order of a state of the spectral model."""

LARGEST_INTEGER = 2**31 - 1

ROUNDING = 0.1
"""Root-mean-square rounding error as a fraction of the uncertainty."""


def stored_reference(case: str) -> Reference | None:
    """The reference for a case that comes with the package; None if there is none."""
    path = stored_path(case)
    return None if path is None else read_reference(path)


def write_reference(reference: Reference, path: AnyPath) -> None:
    """Write `reference`; coefficients are integers times a scale, which readers of NetCDF apply by themselves."""
    with written_aside(Path(path)) as aside, dataset(aside, "w", format="NETCDF4") as file:
        n_days, _, n_coefficients = reference.coefficients.shape
        sizes = {
            "day": n_days,
            "coefficient": n_coefficients,
            "part": 2,
            "truncation": len(reference.truncations),
            "coarser": len(reference.truncations) - 1,
            "measure": len(MEASURES),
        }
        for name, size in sizes.items():
            file.createDimension(name, size)
        _write_variable(file, "day", ("day",), np.array(reference.days), "d", "days since the start")
        _write_variable(file, "truncation", ("truncation",), np.array(reference.truncations, float), "1", "truncations")
        _write_variable(
            file,
            "difference",
            ("coarser", "day", "measure"),
            reference.differences,
            "1",
            f"relative l2 norms of {', '.join(MEASURES)} of runs of lower truncation against this one",
        )
        for row, name in enumerate(STORED_FIELDS):
            _write_field(file, name, reference.coefficients[:, row], _resolution(reference, row))
        file.setncatts(
            {
                "title": f"Reference solution of {reference.case.title}",
                "case": reference.case.name,
                "parameters": json.dumps(reference.case.parameters()),
                "source": "spectral-transform shallow-water model of trisk; " + reference.settings,
                "references": reference.case.reference,
                "history": reference.history,
                "versions": json.dumps(package_versions() | {"ducc0": version("ducc0")}),
                "comment": "coefficients of orthonormal spherical harmonics with orders m >= 0, all degrees of "
                "order 0, then those of order 1, ...; parts are real and imaginary",
            }
        )


def _resolution(reference: Reference, row: int) -> float:
    """Step of the stored coefficients, at which rounding makes `ROUNDING` of the least uncertainty of the field.

    Where that is tiny, the step is the least at which the largest coefficient still is a 32-bit integer.
    """
    measure = list(STORED_FIELDS.values())[row].measure
    harmonics = Harmonics(truncation_of(reference.coefficients), reference.case.radius)
    yardstick = list(STORED_FIELDS).index("surface_height" if measure == "thickness" else "vorticity")
    magnitude = min(harmonics.root_mean_square(state[[yardstick]]) for state in reference.coefficients)
    uncertainty = magnitude * reference.differences[-1, :, MEASURES.index(measure)].min()
    # Parts of coefficients have errors of variance step^2 / 12, orders above 0 count twice in the mean square.
    wanted = ROUNDING * uncertainty * np.sqrt(4.0 * np.pi * 12.0 / (4.0 * len(harmonics.degree)))
    largest = np.abs(reference.coefficients[:, row]).max()
    return float(max(wanted, largest / LARGEST_INTEGER, np.finfo(np.float64).tiny))


def _write_field(file: netCDF4.Dataset, name: str, coefficients: Coefficients, step: float) -> None:
    variable = file.createVariable(
        name, "i4", ("day", "part", "coefficient"), compression="zlib", complevel=9, shuffle=True
    )
    variable.setncatts({"units": STORED_FIELDS[name].units, "scale_factor": step, "long_name": f"harmonics of {name}"})
    parts = np.stack([coefficients.real, coefficients.imag], axis=1)
    variable.set_auto_scale(False)
    variable[:] = np.round(parts / step).astype(np.int32)


def _write_variable(
    file: netCDF4.Dataset, name: str, dimensions: tuple[str, ...], values: Array, units: str, long_name: str
) -> None:
    variable = file.createVariable(name, "f8", dimensions)
    variable.setncatts({"units": units, "long_name": long_name})
    variable[:] = values


def read_reference(path: AnyPath) -> Reference:
    """Read a reference; raise `InputError` if the file is not one, or is damaged."""
    try:
        with dataset(path) as file:
            file.set_auto_mask(False)
            reference = _reference_of(file)
        _require_sound(reference)
        return reference
    except (OSError, RuntimeError, ValueError, LookupError, AttributeError, TypeError, ArithmeticError) as error:
        raise InputError(
            f"{path} is not a readable reference solution ({error}); make one with 'trisk reference'"
        ) from error
    except MemoryError as error:
        raise InputError(f"{path} claims to be larger than the memory; make it again with 'trisk reference'") from error


def _reference_of(file: netCDF4.Dataset) -> Reference:
    parts = np.stack([np.asarray(file[name][:], dtype=np.float64) for name in STORED_FIELDS], axis=1)
    return Reference(
        case=find_case(file.case, json.loads(file.parameters)),
        days=tuple(np.asarray(file["day"][:], dtype=np.float64).tolist()),
        coefficients=parts[:, :, 0] + 1j * parts[:, :, 1],
        truncations=tuple(int(each) for each in file["truncation"][:]),
        differences=np.asarray(file["difference"][:], dtype=np.float64),
        settings=file.source.split("; ")[-1],
        history=file.history,
    )


def _require_sound(reference: Reference) -> None:
    """Raise `ValueError` if arrays do not fit together or hold impossible values."""
    n_days, n_coarser = len(reference.days), len(reference.truncations) - 1
    n_coefficients = reference.coefficients.shape[-1]
    resolved = truncation_of(reference.coefficients)
    if n_days == 0 or np.any(np.diff(reference.days, prepend=0.0) <= 0.0) or not np.isfinite(reference.days).all():
        raise ValueError(f"its days are {reference.days}, not ascending times after the start")
    if reference.coefficients.shape[0] != n_days or n_coefficients != (resolved + 1) * (resolved + 2) // 2:
        raise ValueError(f"it has {n_coefficients} coefficients, which are no triangle of harmonics")
    if n_coarser < 1 or reference.differences.shape != (n_coarser, n_days, len(MEASURES)):
        raise ValueError(f"its differences have the shape {reference.differences.shape}")
    if min(reference.truncations) < 1 or list(reference.truncations) != sorted(set(reference.truncations)):
        raise ValueError(f"its truncations are {reference.truncations}, not ascending")
    for name, values in (("coefficients", reference.coefficients), ("differences", reference.differences)):
        if not np.isfinite(values).all():
            raise ValueError(f"its {name} are not all finite")
    if np.any(reference.differences < 0.0):
        raise ValueError(f"its least difference is {reference.differences.min():.3g}, but norms are not negative")
