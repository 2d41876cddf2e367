"""The exception that everything in this package raises for bad input."""


class MeshError(ValueError):
    """A mesh, its file or a request for one is wrong; the message says what, where and what to do."""


class HemisphereError(MeshError):
    """All points lie in one hemisphere, so that no triangulation of the sphere joins them."""


class MeshWarning(UserWarning):
    """A mesh is usable, but less exact than this package's own meshes; the message gives the residual."""
