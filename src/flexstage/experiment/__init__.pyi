from flexstage.experiment.comparison import (
    Compared as Compared,
    compare as compare,
)
from flexstage.experiment.cross_spectra import (
    Segments as Segments,
    Spectra as Spectra,
    Window as Window,
    spectra as spectra,
)
from flexstage.experiment.formats.read import (
    read_record as read_record,
)
from flexstage.experiment.formats.write import (
    Form as Form,
    write_record as write_record,
)
from flexstage.experiment.health import (
    Needs as Needs,
    examine as examine,
    usable as usable,
)
from flexstage.experiment.identification.identified import (
    Identified as Identified,
)
from flexstage.experiment.identification.identify import (
    Search as Search,
    identify as identify,
)
from flexstage.experiment.options import (
    Allow as Allow,
    Kind as Kind,
    Options as Options,
)
from flexstage.experiment.record import (
    Channel as Channel,
    InMemory as InMemory,
    Record as Record,
    Responses as Responses,
    Role as Role,
    in_memory as in_memory,
)
from flexstage.experiment.shapes_on_stage import (
    StageShapes as StageShapes,
    stage_shapes as stage_shapes,
)
from flexstage.experiment.transfer import (
    h1 as h1,
    h2 as h2,
    multiple_coherence as multiple_coherence,
    ordinary_coherence as ordinary_coherence,
    spectral_ratio as spectral_ratio,
)
from flexstage.experiment.unit import (
    in_si as in_si,
    responses_in_si as responses_in_si,
)
from flexstage.experiment.updating.free import (
    Known as Known,
)
from flexstage.experiment.updating.text import (
    updated_text as updated_text,
)
from flexstage.experiment.updating.update import (
    Told as Told,
    Updated as Updated,
    update as update,
)
from flexstage.experiment.virtual_rig.rig import (
    rig as rig,
)
from flexstage.experiment.virtual_rig.setup import (
    Amplifier as Amplifier,
    AntiAlias as AntiAlias,
    NoiseDrive as NoiseDrive,
    Recorded as Recorded,
    RigSetup as RigSetup,
    Sensing as Sensing,
    Tap as Tap,
)

HOMES: dict[str, str]
