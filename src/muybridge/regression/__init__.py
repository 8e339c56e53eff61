"""Silhouette -> pose mixture (Sedai 2013, section III): table of contents.

==================  ==========================================================================================
file                one line
==================  ==========================================================================================
descriptor          mask -> numbers: the lowest frequencies of the cropped silhouette (1)
outputs             a body's poses <-> what is regressed; the heading is relative to the camera
components          what the numbers of a pose vector are: names, which wrap, which is the heading
clusters            the pose space in clusters, so that poses of one silhouette fall into different ones
gaussian_process    exact Gaussian process regression (2) to (9)
shared_scale        the same for many outputs of one length scale: one eigendecomposition
cluster_regression  one cluster's regression: descriptor -> every component with its variance
gate                which cluster a silhouette belongs to (11)
mixture             p(y | x) (10); alpha (19); turned, and combined over cameras
regressor           all of it: `fit_regressor`, `SilhouetteRegressor.predict`, `PRINTED`, `WORKING`
calibration         lambda of (19) from held-out frames, and whether variances are true
model_file          a regressor saved and loaded
==================  ==========================================================================================

A mask to a mixture in the world, of one camera::

    seen = describe(mask, regressor.config.descriptor)
    guess = turned(regressor.predict(seen.values), bearing(camera, seen.centre))
    poses = PoseOutputs(body).to_poses(guess.sample(rng, 300), place)

with `camera` that of the mask's picture, reduced as the mask is.
"""

from muybridge.regression.calibration import Calibration, calibrate_lambda
from muybridge.regression.cluster_regression import RegressionConfig
from muybridge.regression.clusters import ClusterConfig, cluster_poses
from muybridge.regression.components import PoseComponents
from muybridge.regression.descriptor import Descriptor, DescriptorConfig, describe
from muybridge.regression.gate import GateConfig
from muybridge.regression.mixture import PRINTED_TRUSTED_VARIANCE, PoseMixture, combined, turned
from muybridge.regression.model_file import load_regressor, save_regressor
from muybridge.regression.outputs import PoseOutputs, bearing
from muybridge.regression.regressor import PRINTED, WORKING, Config, SilhouetteRegressor, fit_regressor

__all__ = [
    "PRINTED",
    "PRINTED_TRUSTED_VARIANCE",
    "WORKING",
    "Calibration",
    "ClusterConfig",
    "Config",
    "Descriptor",
    "DescriptorConfig",
    "GateConfig",
    "PoseComponents",
    "PoseMixture",
    "PoseOutputs",
    "RegressionConfig",
    "SilhouetteRegressor",
    "bearing",
    "calibrate_lambda",
    "cluster_poses",
    "combined",
    "describe",
    "fit_regressor",
    "load_regressor",
    "save_regressor",
    "turned",
]
