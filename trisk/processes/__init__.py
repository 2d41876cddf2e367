"""The command under mpiexec: one of several processes that end together."""
