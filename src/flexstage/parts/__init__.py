"""Parts and bodies of a stage: data, ideal degrees of freedom and profiles, without stiffness laws and CAD."""

from flexstage.base.register import Register
from flexstage.parts.amplified import Amplified, SteppingDrive
from flexstage.parts.cartwheel import Cartwheel
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.contact import Contact
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.cruciform import Cruciform
from flexstage.parts.encoder import Encoder
from flexstage.parts.folded_leaf import FoldedLeaf
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.gauge import Gauge, Instrument
from flexstage.parts.leaf import Leaf
from flexstage.parts.membrane import Membrane
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.rotary_coil import RotaryCoil
from flexstage.parts.shape import Elastic
from flexstage.parts.shear_piezo import ShearPiezo
from flexstage.parts.spring import Spring
from flexstage.parts.strain_gauge import StrainGauge
from flexstage.parts.superelement import Superelement
from flexstage.parts.tilt import Tilt
from flexstage.parts.voice_coil import VoiceCoil

_HINGES = (Notch, Neck, Leaf, ReinforcedLeaf, Rod, Cruciform)
_COMPOUNDS = (CrossHinge, Cartwheel, FoldedLeaf)
_ACTUATORS = (Piezo, ShearPiezo, Amplified, SteppingDrive, ForceActuator, VoiceCoil, RotaryCoil)
_GAUGES = (Gauge, Tilt, Encoder, StrainGauge)
PARTS: Register[type[Elastic]] = Register(
    "flexstage.parts",
    {part.kind: part for part in (*_HINGES, Membrane, ComplianceMatrix, Spring, Contact, Superelement, *_COMPOUNDS, *_ACTUATORS)},
)
"""Classes of parts with stiffness, by name of the kind; compound parts are included."""

GAUGES: Register[type[Instrument]] = Register("flexstage.gauges", {gauge.kind: gauge for gauge in _GAUGES})
"""Classes of gauges, by name of the kind (default: `Gauge`)."""
