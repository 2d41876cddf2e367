import shutil
from contextlib import suppress
from pathlib import Path

import netCDF4
import numpy as np
import pytest

pytest.importorskip("ducc0")

from cases import find_case
from cases.williamson import Williamson2
from postprocess.reference.making import MEASURES, REFERENCE_DAYS, Reference, make_reference
from postprocess.reference.reference_file import ROUNDING, read_reference, stored_reference, write_reference
from postprocess.reference.stored_references import FOLDER
from swe.errors import InputError

LONGITUDE, LATITUDE = np.array([0.1, 2.0, 4.7, 6.0]), np.array([-1.2, 0.4, 0.52, 1.5])


@pytest.fixture(scope="module")
def told() -> list[tuple[str, float]]:
    return []


@pytest.fixture(scope="module")
def reference(told: list[tuple[str, float]]) -> Reference:
    case = find_case("williamson5")
    return make_reference(case, (0.25, 0.5), 40, 1.0, "made by a test", lambda what, part: told.append((what, part)))


def test_the_three_truncations_converge_and_tell(reference: Reference, told: list[tuple[str, float]]) -> None:
    assert reference.truncations == (10, 20, 40)
    assert reference.differences.shape == (2, 2, 3)
    assert np.all(reference.differences[1] < 0.6 * reference.differences[0])
    assert [name for name, part in told if part == 1.0] == ["T10", "T20", "T40"]
    assert reference.uncertainty(0.5) == dict(zip(MEASURES, reference.differences[1, 1], strict=True))


def test_of_a_steady_flow_the_reference_is_the_exact_solution() -> None:
    case = Williamson2(angle=0.7)
    steady = make_reference(case, (0.5,), 16, np.inf, "", lambda what, part: None)
    places = LONGITUDE, LATITUDE
    assert steady.thickness(*places, 0.5) == pytest.approx(case.thickness(*places), rel=1e-10)
    for found, exact in zip(steady.velocity(*places, 0.5), case.velocity(*places), strict=True):
        assert found == pytest.approx(exact, abs=1e-8)
    assert steady.vorticity(*places, 0.5) == pytest.approx(case.vorticity(*places), abs=1e-14)


def test_file_keeps_all_but_a_part_of_the_uncertainty(reference: Reference, tmp_path: Path) -> None:
    path = tmp_path / "reference.nc"
    write_reference(reference, path)
    with netCDF4.Dataset(path) as file:
        units = {"vorticity": "s-1", "divergence": "s-1", "surface_height": "m"}
        assert {name: file[name].units for name in units} == units
        assert [file[name].long_name for name in units] == [f"harmonics of {name}" for name in units]
        assert [file[name].units for name in ("day", "truncation", "difference")] == ["d", "1", "1"]
        assert file["day"].long_name == "days since the start"
        assert file["truncation"].long_name == "truncations"
        assert file["difference"].long_name.endswith("of runs of lower truncation against this one")
    read = read_reference(path)
    assert (read.case, read.days, read.truncations) == (reference.case, reference.days, reference.truncations)
    assert (read.history, read.settings) == ("made by a test", reference.settings)
    assert np.array_equal(read.differences, reference.differences)
    generator = np.random.default_rng(0)
    longitude, latitude = generator.uniform(0.0, 6.0, 4000), np.arcsin(generator.uniform(-1.0, 1.0, 4000))
    for day in reference.days:
        for measure, field in (("thickness", "thickness"), ("vorticity", "vorticity")):
            ours, theirs = (getattr(each, field)(longitude, latitude, day) for each in (reference, read))
            change = np.linalg.norm(ours - theirs) / np.linalg.norm(ours)
            assert 0.0 < change < 1.2 * ROUNDING * reference.uncertainty(day)[measure]
    with netCDF4.Dataset(path) as file:
        assert "del^8" in file.source
        assert '"ducc0"' in file.versions


def test_refusals(reference: Reference, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no day 3; choose among 0\.25, 0\.5"):
        reference.thickness(LONGITUDE, LATITUDE, 3.0)
    (tmp_path / "garbage.nc").write_text("garbage")
    with pytest.raises(InputError, match="not a readable reference solution"):
        read_reference(tmp_path / "garbage.nc")
    assert stored_reference("lake-at-rest") is None


@pytest.mark.parametrize(
    ("name", "days", "truncation", "damping", "words"),
    [
        ("williamson5", (1.0,), 8, 1.0, "truncation is 8; give at least 16"),
        ("williamson5", (0.0,), 16, 1.0, "cannot be given on day 0"),
        ("williamson5", (), 16, 1.0, "cannot be given on day 0"),
        ("williamson5", (1.0,), 16, -1.0, "damping time is -1 hours"),
        ("williamson1", (1.0,), 16, 1.0, "prescribes its wind"),
    ],
)
def test_requests_that_make_no_reference(
    name: str, days: tuple[float, ...], truncation: int, damping: float, words: str
) -> None:
    with pytest.raises(InputError, match=words):
        make_reference(find_case(name), days, truncation, damping, "", lambda what, part: None)


@pytest.mark.parametrize("name", REFERENCE_DAYS)
def test_stored_references(name: str) -> None:
    """Those that come with the package: of the paper's case, on the promised days, well below a finite-volume error."""
    stored = stored_reference(name)
    assert stored is not None
    assert stored.case == find_case(name)
    assert stored.days == REFERENCE_DAYS[name]
    assert "trisk reference" in stored.history
    for day in stored.days:
        assert 0.0 < stored.uncertainty(day)["thickness"] < 5e-4
        assert stored.thickness(LONGITUDE, LATITUDE, day).min() > 1000.0


def test_stored_references_are_small() -> None:
    assert 0 < sum(path.stat().st_size for path in FOLDER.glob("*.nc")) < 1_000_000


def test_a_stored_reference_starts_from_the_case(reference: Reference) -> None:
    """The mean depth does not change: that of the surface less that of the mountain."""
    stored = stored_reference("williamson5")
    assert stored is not None
    assert stored.coefficients[:, 2, 0] == pytest.approx(reference.coefficients[0, 2, 0], rel=1e-6)


def test_a_reference_without_uncertainty_is_stored_as_well_as_integers_allow(tmp_path: Path) -> None:
    """Of a steady flow the truncations agree to round-off: the step must not follow them down."""
    case = Williamson2()
    steady = make_reference(case, (0.25,), 16, np.inf, "", lambda what, part: None)
    write_reference(steady, tmp_path / "steady.nc")
    read = read_reference(tmp_path / "steady.nc")
    assert read.thickness(LONGITUDE, LATITUDE, 0.25) == pytest.approx(case.thickness(LONGITUDE, LATITUDE), rel=1e-8)
    assert read.vorticity(LONGITUDE, LATITUDE, 0.25) == pytest.approx(case.vorticity(LONGITUDE, LATITUDE), abs=1e-12)


def test_points_may_have_any_shape(reference: Reference) -> None:
    """As means over cells ask for them."""
    square = LONGITUDE.reshape(2, 2), LATITUDE.reshape(2, 2)
    flat = reference.thickness(LONGITUDE, LATITUDE, 0.5)
    assert np.array_equal(reference.thickness(*square, 0.5), flat.reshape(2, 2))
    assert reference.velocity(*square, 0.5)[1].shape == (2, 2)


@pytest.mark.parametrize(
    ("name", "index", "value", "words"),
    [
        ("day", 0, -1.0, "its days are"),
        ("day", 0, np.nan, "its days are"),
        ("truncation", 0, 1e3, "its truncations are"),
        ("truncation", 0, np.nan, "cannot convert float NaN to integer"),
        ("difference", 0, np.inf, "its differences are not all finite"),
        ("difference", 0, -1.0, "its least difference is -1"),
    ],
)
def test_a_damaged_reference_is_refused(tmp_path: Path, name: str, index: int, value: float, words: str) -> None:
    path = tmp_path / "reference.nc"
    shutil.copy(FOLDER / "williamson5.nc", path)
    with netCDF4.Dataset(path, "a") as file:
        file[name][index] = value
    with pytest.raises(InputError, match=f"is not a readable reference solution .*{words}.*; make one with"):
        read_reference(path)


@pytest.mark.parametrize("seed", range(8))
def test_a_cut_or_mutated_reference_is_read_or_refused(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    whole = bytearray((FOLDER / "williamson5.nc").read_bytes())
    path = tmp_path / "reference.nc"
    path.write_bytes(whole[: random.integers(len(whole))])
    with pytest.raises(InputError, match="is not a readable reference solution"):
        read_reference(path)
    for place in random.integers(8000, size=20):
        whole[place] = random.integers(256)
    path.write_bytes(whole)
    with suppress(InputError):
        assert np.isfinite(read_reference(path).coefficients).all()
