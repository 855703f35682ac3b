from flexstage.experiment.comparison import (
    compare as compare,
)
from flexstage.experiment.spectral.cross_spectra import (
    Segments as Segments,
    spectra as spectra,
)
from flexstage.experiment.formats.read import (
    read_record as read_record,
)
from flexstage.experiment.formats.write import (
    write_record as write_record,
)
from flexstage.experiment.records.health import (
    RecordRequirements as RecordRequirements,
    examine as examine,
)
from flexstage.experiment.identification.excitation import (
    Excitation as Excitation,
)
from flexstage.experiment.identification.identify import (
    Search as Search,
    identify as identify,
)
from flexstage.experiment.records.options import (
    FaultTolerance as FaultTolerance,
    Arrays as Arrays,
    Kind as Kind,
    Options as Options,
)
from flexstage.experiment.records.record import (
    Channel as Channel,
    Record as Record,
    Role as Role,
    in_memory as in_memory,
)
from flexstage.experiment.spectral.transfer import (
    h1 as h1,
    h2 as h2,
)
from flexstage.experiment.updating.free import (
    Prior as Prior,
)
from flexstage.experiment.updating.update import (
    update as update,
)
from flexstage.experiment.virtual_rig.inputs import (
    InputQuantity as InputQuantity,
    InputSignal as InputSignal,
)
from flexstage.experiment.virtual_rig.rig import (
    rig as rig,
)
from flexstage.experiment.virtual_rig.setup import (
    Amplifier as Amplifier,
    AntiAlias as AntiAlias,
    NoiseDrive as NoiseDrive,
    RigSetup as RigSetup,
    Sensing as Sensing,
)

HOMES: dict[str, str]
