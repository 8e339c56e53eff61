"""Bayesian, model-based tracking of people in video: 3D poses with error bars."""

__version__ = "0.1.0"
