"""Captions of the figures of studies and comparisons: what is seen, the axes and their units."""

from postprocess.figures.compare_maps import MAP_FIELDS, name_of_map
from postprocess.figures.plots import ROUND_OFF_FLOOR
from postprocess.studies.study_maps import CLOSEUP_CELLS, COLOUR_RANGE

GUIDES = "Both axes are logarithmic; grey lines show how errors of first and second order fall."

ABSCISSA = "the mean distance between neighbouring cells, in km"


def mesh_captions(error_day: float, compared: int) -> dict[str, str]:
    """Captions of a study of meshes whose errors are of this day, with so many maps, by the names of its figures."""
    maps = "One map" if compared == 1 else f"{compared} maps, one for each finest mesh"
    panels = "One panel" if compared == 1 else f"{compared} panels, one for each finest mesh"
    return {
        "errors": (
            f"Relative errors on day {error_day:g}, without units, against {ABSCISSA}: lower is better, and a steeper "
            f"line has a higher order. {GUIDES}"
        ),
        "maps": (
            f"{maps}: error of thickness on day {error_day:g}, in m, cell by cell on an equal-area map, red where the "
            f"fluid is too thick and blue where it is too thin. Colours span {COLOUR_RANGE:g} times the root mean "
            "square of each map, so they differ from map to map. A green ring is the worst cell; black dots are "
            "pentagons, magenta ones heptagons."
        ),
        "closeups": (
            f"{panels}: the same error of thickness, in m, within {CLOSEUP_CELLS:g} cells of the worst cell. Numbers "
            "are the sides of cells that are no hexagon."
        ),
        "quality": (
            f"Relative l2 error of thickness on day {error_day:g}, without units and logarithmic, against measures of "
            "the mesh, one in each panel, without units: if a measure told the error, the points of one size would "
            "lie on a line. Larger markers are finer meshes."
        ),
        "truncation": (
            "Relative truncation errors of the discrete operators, without units, on a smooth flow: the l2 norm on the "
            f"left, the largest error l∞ on the right, against {ABSCISSA}. {GUIDES}"
        ),
        "conservation": (
            "Size of the relative change of each invariant since the start, without units and logarithmic, against "
            f"time, in days, on the finest meshes. No change at all is drawn at {ROUND_OFF_FLOOR:g}."
        ),
    }


def time_captions(shortest: float) -> dict[str, str]:
    """Caption of a study of time steps, of which the shortest is so many seconds."""
    return {
        "time_steps": (
            f"Relative change of total energy over the run, and relative l2 differences from the run with {shortest:g} "
            "s, without units, against the time step, in s. Both axes are logarithmic; dashed lines show the slopes "
            "that theory expects."
        )
    }


def comparison_captions(day: float, compared: int) -> dict[str, str]:
    """Captions of the maps of a comparison on this day, of so many runs, by the names of their files."""
    runs = "the run" if compared == 1 else f"the {compared} runs"
    scale = "On an equal-area map" if compared == 1 else "On equal-area maps with one colour scale"
    captions = {}
    for name, field in MAP_FIELDS.items():
        captions[name_of_map(name, day)] = (
            f"On equal-area maps with one colour scale: {field.label} on day {day:g}, of the reference first and then "
            f"of {runs}."
        )
        sign = "" if field.error_colours else ": red where the run has more than the reference, blue where it has less"
        captions[name_of_map(name, day, difference=True)] = (
            f"{scale}: {field.difference_label} from the reference on day {day:g}, of {runs}{sign}."
        )
    return captions
