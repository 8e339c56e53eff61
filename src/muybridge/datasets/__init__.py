"""Folders in known layouts -> plain data and a job.

=============  ======================================================================
`bodytrack`    `read_bodytrack`: four cameras, masks, 58 body measures, first pose
`pose2sim`     `pose2sim_recording`: Config.toml, calibration/, videos/
`humaneva`     `humaneva_recording`: videos, calibration, motion capture of a copy of HumanEva
`samples`      `beam`: a real recording that comes as a package
`layouts`      `LAYOUTS`, `read_recording`, `write_job`
=============  ======================================================================
"""

from muybridge.datasets.layouts import LAYOUTS, read_recording, write_job
from muybridge.datasets.recording import CameraFiles, Recording, write_recording_job

__all__ = ["LAYOUTS", "CameraFiles", "Recording", "read_recording", "write_job", "write_recording_job"]
