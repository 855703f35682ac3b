"""File formats of test records, for reading and writing: a register that other packages can extend."""

from flexstage.base.register import Register
from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.gcs import GCS
from flexstage.experiment.formats.hdf import HDF5
from flexstage.experiment.formats.mat import MAT
from flexstage.experiment.formats.table import CSV
from flexstage.experiment.formats.uff import UFF

FORMATS: Register[Format] = Register(
    "flexstage.formats",
    {
        "uff": UFF,
        "mat": MAT,
        "hdf5": HDF5,
        "gcs": GCS,
        "csv": CSV,
    },
)
"""Record file formats by name."""
