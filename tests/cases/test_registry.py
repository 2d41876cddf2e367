"""Cases by name, by file, and with other parameters."""

import json
import re
from dataclasses import make_dataclass
from pathlib import Path

import numpy as np
import pytest

from cases import CASES, Williamson1, Williamson2, find_case
from cases.parameters import split_settings, units_and_meanings
from mesh import VoronoiMesh
from swe import Simulation
from swe.errors import InputError

PAGE = Path(__file__).parents[2] / "docs" / "cases.md"

HEAD = """
from dataclasses import dataclass
import numpy as np
from cases import Case
"""
METHODS = """
    title = "Mine"
    recommended_days = 1.0
    def thickness(self, longitude, latitude, time=0.0):
        return 1000.0
    def streamfunction(self, longitude, latitude, time=0.0):
        return 0.0
"""


@pytest.fixture
def splash(tmp_path: Path) -> Path:
    """The example of the documentation as a file."""
    example = re.search(r"`splash.py`:\s+```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert example
    path = tmp_path / "splash.py"
    path.write_text(example[1])
    return path


def test_parameters_from_text() -> None:
    assert find_case("williamson2", {"angle": "pi/2-0.05"}).parameters()["angle"] == np.pi / 2 - 0.05
    assert find_case("williamson2", {"angle": "-(1 + 2)*.5e-1"}).parameters()["angle"] == pytest.approx(-0.15)
    assert find_case("galewsky", {"perturbed": "False"}).has_exact_solution
    assert find_case("williamson6", {"wave_number": "5"}).parameters()["wave_number"] == 5
    assert find_case("williamson1", split_settings(["angle = 0.1", "bell_height=2e3"])) == Williamson1(
        angle=0.1, bell_height=2000.0
    )


def test_record_of_a_run_makes_its_case_again() -> None:
    case = Williamson2(angle=np.pi / 3, reference_depth=2345.678)
    record = json.loads(json.dumps({"case": case.name, "parameters": case.parameters()}))
    assert find_case(record["case"], record["parameters"]) == case


@pytest.mark.parametrize(
    ("name", "setting", "words"),
    [
        ("williamson2", "angel=1", "williamson2 has no parameter 'angel'; choose among radius, gravity, .*, angle, "),
        ("williamson2", "angle", "'angle' sets nothing; write NAME=VALUE"),
        ("williamson2", "angle=steep", "angle is 'steep'; it must be a number, such as 0.05 or pi/2-0.05"),
        ("williamson2", "angle=", "angle is ''; it must be a number"),
        ("williamson2", "angle=1/0", "angle is '1/0'; it must be a number"),
        ("williamson2", "angle=nan", "angle is nan; give a finite number"),
        ("williamson2", "angle=__import__('os')", "it must be a number"),
        ("williamson2", "gravity=-1", "gravity is -1; it must be positive"),
        ("williamson6", "wave_number=4.5", "wave_number is '4.5'; it must be a whole number$"),
        ("galewsky", "perturbed=1", "perturbed is '1'; it must be true or false"),
    ],
)
def test_wrong_parameters_are_refused(name: str, setting: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        find_case(name, split_settings([setting]))


def test_truth_is_no_number() -> None:
    with pytest.raises(InputError, match="angle is True; it must be a number"):
        find_case("williamson2", {"angle": True})


def test_unknown_case_is_refused_with_the_choices() -> None:
    with pytest.raises(InputError, match=r"no case named 'tc5'; choose one of williamson1, .*, or FILE.py:CLASS"):
        find_case("tc5")


def test_example_of_the_documentation(splash: Path, icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    case = find_case(f"{splash}:Splash", {"height": "50"})
    assert units_and_meanings(case)["height"] == ("m", "Height of the bump")
    simulation = Simulation(icosahedral_mesh, case, tmp_path / "run")
    assert simulation.state.thickness.max() == pytest.approx(4050.0, abs=10.0)
    simulation.run(days=0.5, progress=False)
    assert np.abs(simulation.state.normal_velocity).max() > 0.01
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["case"] == f"{splash}:Splash"
    again = find_case(record["case"], record["parameters"])
    assert again.parameters() == case.parameters()
    assert again.parameters()["height"] == 50.0


def test_case_of_an_earlier_file_has_parameters_without_meaning(tmp_path: Path) -> None:
    """Parameters were plain fields with a string below them."""
    path = tmp_path / "earlier.py"
    field = '    depth: float = 3.0\n    """Depth of the ocean, m."""\n'
    path.write_text(HEAD + "@dataclass(frozen=True)\nclass Mine(Case):\n" + field + METHODS)
    case = find_case(f"{path}:Mine", {"depth": "4"})
    assert case.parameters()["depth"] == 4.0
    described = units_and_meanings(case)
    assert described["depth"] == ("", "")
    assert described["radius"] == ("m", "Radius of the sphere")


def test_relative_path_becomes_absolute(splash: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(splash.parent)
    assert find_case("splash.py:Splash").name == f"{splash}:Splash"


def test_object_of_a_file_is_a_case_too(splash: Path) -> None:
    splash.write_text(splash.read_text() + "\nhigh = Splash(height=99.0)\n")
    case = find_case(f"{splash}:high")
    assert case.parameters()["height"] == 99.0
    assert case.name == f"{splash}:high"
    changed = find_case(f"{splash}:high", {"width": 0.2})
    assert (changed.parameters()["height"], changed.parameters()["width"]) == (99.0, 0.2)
    assert changed.name == f"{splash}:high"


def test_parameter_that_is_no_number_is_kept(splash: Path) -> None:
    splash.write_text(splash.read_text() + '\n@dataclass(frozen=True)\nclass Named(Splash):\n    label: str = "x"\n')
    case = find_case(f"{splash}:Named", {"label": "x", "height": 5.0})
    assert case.parameters()["label"] == "x"
    with pytest.raises(InputError, match=r"label of .* is neither a number nor true or false"):
        find_case(f"{splash}:Named", {"label": "y"})


def test_parameters_that_a_case_of_a_user_cannot_take(splash: Path) -> None:
    splash.write_text(
        splash.read_text()
        + "    def __post_init__(self):\n        if self.height > 99:\n            raise KeyError('high')\n"
    )
    line = len(splash.read_text().splitlines())
    words = rf"splash.py:Splash cannot be made with height = 100\.0, line {line}: KeyError\('high'\)"
    with pytest.raises(InputError, match=words):
        find_case(f"{splash}:Splash", {"height": "100"})


def test_case_of_this_package_keeps_its_name(tmp_path: Path) -> None:
    path = tmp_path / "turned.py"
    path.write_text("from cases import Williamson2\nturned = Williamson2(angle=0.3)\n")
    assert find_case(f"{path}:turned").name == f"{path}:turned"
    assert Williamson2.name == "williamson2"
    assert find_case("williamson2", {"angle": 0.3}).name == "williamson2"


def test_names_of_a_file_leave_its_own_objects_as_they_are(splash: Path) -> None:
    """One object of a file under two names: each case has its own, and the class is the one of the file."""
    splash.write_text(splash.read_text() + "\nhigh = low = Splash(height=99.0)\nSplash.name = 'splash'\n")
    cases = [find_case(f"{splash}:{name}", {"width": 0.2}) for name in ("high", "low")]
    assert [case.name for case in cases] == [f"{splash}:high", f"{splash}:low"]
    assert [type(case).name for case in cases] == ["splash", "splash"]
    assert type(cases[0]).__name__ == "Splash"


def test_case_that_cannot_be_named_is_refused(splash: Path) -> None:
    splash.write_text(splash.read_text() + "\n    @property\n    def name(self):\n        return 'splash'\n")
    with pytest.raises(
        InputError, match=r"splash.py:Splash cannot be used \(.*\); derive a class from cases.Case whose"
    ):
        find_case(f"{splash}:Splash")


def test_cases_show_title_parameters_and_what_is_not_the_default(splash: Path) -> None:
    lines = repr(Williamson2(angle=np.float32(0.5))).splitlines()
    assert lines[:2] == ["<Case williamson2", "  title: Williamson test case 2: steady geostrophic flow"]
    assert "  sphere: radius 6371220 m, gravity 9.80616 m/s2, rotation rate 7.292e-05 1/s" in lines
    assert "  angle: 0.5 rad (default 0)" in lines
    assert "  angle: 0 rad" in repr(Williamson2())
    case = find_case(f"{splash}:Splash", {"height": 50.0, "gravity": 9})
    lines = repr(case).splitlines()
    assert lines[0] == f"<Case {splash}:Splash"
    assert "gravity 9 m/s2 (default 9.80616)" in repr(case)
    assert any(line.startswith("  height: 50") and "(default " in line for line in lines)


@pytest.mark.parametrize("name", CASES)
def test_each_case_shows_all_its_parameters_in_a_few_lines(name: str) -> None:
    case = CASES[name]()
    assert len(repr(case).splitlines()) <= 13
    assert len(repr(case)) <= 900
    for parameter in case.parameters():
        assert f"{parameter.replace('_', ' ')}" in repr(case)
    assert "see parameters()" not in repr(case)


def test_a_case_of_many_parameters_shows_how_many_more_it_has() -> None:
    many = make_dataclass(
        "Many", [(f"p{number}", float, 1.0) for number in range(10)], bases=(Williamson2,), frozen=True
    )
    assert "  p4: 1\n" in repr(many())
    assert "p5: 1" not in repr(many())
    assert "more parameters: 5; see parameters()" in repr(many())


@pytest.mark.parametrize(
    ("content", "address", "words"),
    [
        (None, "absent.py:Mine", "absent.py: no such file"),
        (HEAD, "mine.py", r"mine.py is a file; name the class in it as well: .*mine.py:MyCase"),
        (HEAD, "mine.py:Mine", "holds no 'Mine'; it holds no class derived from cases.Case"),
        (HEAD + "class Other(Case):" + METHODS, "mine.py:Mine", "holds no 'Mine'; it holds Other$"),
        (HEAD + "class Mine:" + METHODS, "mine.py:Mine", "is not a case; derive the class from cases.Case"),
        (HEAD + "class Mine(Case):\n    title = 'x'", "mine.py:Mine", "lacks streamfunction and thickness"),
        (
            HEAD + "class Mine(Case):" + METHODS.replace('    title = "Mine"\n', ""),
            "mine.py:Mine",
            "lacks title; derive",
        ),
        (
            HEAD + "@dataclass(frozen=True, kw_only=True)\nclass Mine(Case):\n    depth: float" + METHODS,
            "mine.py:Mine",
            r"cannot be made \(.*'depth'\); give every parameter a default",
        ),
        ("import numpy as np\n\nx = np.zeros(3)[7]\n", "mine.py:Mine", "cannot be imported, line 3: IndexError"),
        ("x = 1\ndef f(:\n", "mine.py:Mine", "cannot be imported, line 2: SyntaxError"),
        ("import nothing_of_the_kind\n", "mine.py:Mine", "line 1: ModuleNotFoundError"),
        ("import sys\nsys.exit(3)\n", "mine.py:Mine", "line 2: SystemExit"),
        (HEAD + "mine = 3\n", "mine.py:mine", "lacks background_depth, convergence_order, coriolis"),
        (
            HEAD + "class Mine(Case):\n    def __post_init__(self):\n        raise ValueError('no luck')" + METHODS,
            "mine.py:Mine",
            r"mine.py:Mine cannot be made with its own parameters, line 7: ValueError\('no luck'\)",
        ),
        (
            HEAD + "class Mine(Case):\n    def __post_init__(self):\n        None + 1" + METHODS,
            "mine.py:Mine",
            "cannot be made with its own parameters, line 7: TypeError",
        ),
        (
            HEAD + "class Mine(Case):\n    @property\n    def background_depth(self):\n        return 1 / 0" + METHODS,
            "mine.py:Mine",
            "a property of .*mine.py:Mine fails, line 8: ZeroDivisionError",
        ),
        *(
            (
                HEAD + "class Mine(Case):" + METHODS.replace("recommended_days = 1.0", f"recommended_days = {days}"),
                "mine.py:Mine",
                "recommended_days of .*mine.py:Mine is .*; give a number above 0",
            )
            for days in ("'five'", "float('nan')", "-1.0", "True")
        ),
        (
            HEAD + "class Mine(Case):\n    convergence_order = 'two'" + METHODS,
            "mine.py:Mine",
            "convergence_order of .*mine.py:Mine is 'two'; give a number or None",
        ),
        *(
            (
                HEAD + "class Mine(Case):" + METHODS + f"    title, reference = {texts}\n",
                "mine.py:Mine",
                f"title and reference of .*mine.py:Mine are {re.escape(words)}; give texts",
            )
            for texts, words in (("3, 'a paper'", "3 and 'a paper'"), ("'Mine', None", "'Mine' and None"))
        ),
    ],
)
def test_file_without_a_case_is_refused(content: str | None, address: str, words: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "mine.py").write_text(content)
    with pytest.raises(InputError, match=words):
        find_case(str(tmp_path / address))


def test_object_that_does_what_a_case_does(tmp_path: Path, icosahedral_mesh: VoronoiMesh) -> None:
    """It need not be derived from `Case`; its parameters are its own matter."""
    path = tmp_path / "mine.py"
    path.write_text(
        HEAD
        + "class Inner(Case):"
        + METHODS
        + """
class Wrapper:
    inner = Inner()
    def __getattr__(self, attribute):
        return getattr(Wrapper.inner, attribute)
    def parameters(self):
        return {"radius": 6371220.0, "depth": 3.0}
mine = Wrapper()
"""
    )
    case = find_case(f"{path}:mine", {"depth": 3.0})
    assert case.name == f"{path}:mine"
    Simulation(icosahedral_mesh, case).run(days=0.1, progress=False)
    with pytest.raises(InputError, match="its parameters cannot be changed; change its file"):
        find_case(f"{path}:mine", {"depth": 4.0})
