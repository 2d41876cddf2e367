"""The fast path of the forward-backward method: each stage is one pass over the tiles of the mesh."""

import numpy as np

from mesh.arrays import Array
from swe.equations.model import ShallowWaterModel
from swe.tiles import forward_backward_kernels as kernels
from swe.tiles.fused import FusedMethod


class FusedForwardBackward(FusedMethod):
    """Advances a state by FB-RK(3,2), with the same result as `ForwardBackward(model, state)` to round-off."""

    def __init__(self, model: ShallowWaterModel) -> None:
        super().__init__(model, stages=2, plain_twin="ForwardBackward(model, ...)", with_border=True)
        self._spare = np.empty(model.mesh.n_cells)

    @property
    def bytes_per_step(self) -> int:
        """See `FusedMethod`.

        The tiles are read in all three passes. These read and write 2, 3 and 3 arrays of velocity, and 3, 3 and 4 of
        thickness.
        """
        tiles = sum(array.nbytes for array in self.tiles.arrays)
        h, u = self._stages[0]
        return 3 * tiles + (2 + 3 + 3) * u.nbytes + (3 + 3 + 4) * h.nbytes

    def _steps(self, y: tuple[Array, Array], time_step: float, steps: int) -> int:
        tiles, model = self.tiles, self.model
        taken: int = kernels.forward_backward_steps(
            *(tiles.arrays, self._scratch, model.gravity, not model.prescribed_wind, y, *self._stages, self._spare),
            *(time_step, steps, self._unsound),
        )
        return taken

    def _steps_by_stages(self, y: tuple[Array, Array], time_step: float, steps: int, time: float) -> int:
        """The passes of `forward_backward_steps`, with an exchange of values between processes after each."""
        moving, fixed = not self.model.prescribed_wind, (self.tiles.arrays, self._scratch, self.model.gravity)
        (h, u), ((h1, u1), (h2, u2)), following = y, self._stages, self._spare
        if not moving:
            u1 = u2 = u
        c1, c2, c3 = (fraction * time_step for fraction in kernels.FRACTIONS)
        first, second, third = kernels.WEIGHTS
        end = self._unsound
        kernels.one_pass(*fixed, False, True, False, (h, h, h), first, (u, u, u), 0.0, h, c1, h1, end)
        self._exchange((h1, u))
        taken = 0
        while taken < steps:
            taken += 1
            kernels.one_pass(*fixed, moving, True, False, (h1, h, h), first, (u, u, u1), c1, h, c2, h2, end)
            self._exchange((h2, u1))
            kernels.one_pass(*fixed, moving, True, False, (h2, h, h), second, (u, u1, u2), c2, h, c3, h1, end)
            self._exchange((h1, u2))
            more = taken < steps
            kernels.one_pass(*fixed, moving, more, True, (h1, h2, h), third, (u, u2, u1), c3, h1, c1, following, end)
            self._exchange((following if more else h1, u1))
            h, h1, following, u, u1 = h1, following, h, u1, u
            if self._any_unsound(h, u):
                break
        for values, target in ((h, y[0]), (u, y[1])):
            if values is not target:
                target[:] = values
        return taken
