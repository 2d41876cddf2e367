"""Relaxation of thickness towards a given field, dh/dt = (h* - h) / T."""

from mesh.arrays import Array
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.terms import Forcing
from swe.forcing.places import Field, OncePerMesh, coefficient, require_field, sampled
from swe.state import State


class ThicknessRelaxation(Forcing):
    """A source of thickness that pulls it towards a field: dh/dt = (h* - h) / T. The velocity stays.

    Parameters
    ----------
    thickness
        The field h*, m: a number, or a function of longitude and latitude, radians, taken at the centres of cells.
    time_scale
        T, s: what is alone falls by 1/e of its distance in this time.
    name
        Its name in the diagnostics.

    Raises
    ------
    InputError
        If the time scale is not positive, or the field is neither a finite number nor a function.
    """

    def __init__(self, thickness: Field, time_scale: float, name: str = "relaxation") -> None:
        super().__init__(name, source=self._source)
        require_field("the thickness to relax to", thickness)
        self.thickness = thickness
        self.time_scale = coefficient("the time scale of the relaxation", time_scale, positive=True)
        self._target = OncePerMesh(lambda mesh: sampled(self.thickness, *mesh.coordinates("cell")))

    def _source(self, mesh: VoronoiMesh, state: State, time: float) -> Array:
        return (self._target(mesh) - state.thickness) / self.time_scale
