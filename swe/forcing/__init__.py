"""Ready terms that a case declares (`Case.terms`): wind, drag, viscosity, relaxation of thickness."""
