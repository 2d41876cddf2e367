"""Runge-Kutta methods, steppers, relaxation and schedules."""
