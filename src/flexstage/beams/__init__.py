"""Compliance and mass of parts by beam theory."""

from flexstage.base.register import Register
from flexstage.beams.compliance_matrix import MATRIX
from flexstage.beams.contact import CONTACT
from flexstage.beams.cruciform import CRUCIFORM
from flexstage.beams.law import PartLaw
from flexstage.beams.leaf import LEAF
from flexstage.beams.membrane import MEMBRANE
from flexstage.beams.neck import NECK
from flexstage.beams.notch import NOTCH
from flexstage.beams.piezo import PIEZO
from flexstage.beams.reinforced_leaf import REINFORCED_LEAF
from flexstage.beams.rod import ROD
from flexstage.beams.shear_piezo import SHEAR_PIEZO
from flexstage.parts.amplified import Amplified, SteppingDrive
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.contact import Contact
from flexstage.parts.cruciform import Cruciform
from flexstage.parts.force_actuator import ForceActuator
from flexstage.parts.leaf import Leaf
from flexstage.parts.membrane import Membrane
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.rotary_coil import RotaryCoil
from flexstage.parts.shear_piezo import ShearPiezo
from flexstage.parts.spring import Spring
from flexstage.parts.voice_coil import VoiceCoil

_HINGES = {
    Notch: NOTCH,
    Neck: NECK,
    Leaf: LEAF,
    ReinforcedLeaf: REINFORCED_LEAF,
    Rod: ROD,
    Membrane: MEMBRANE,
    Cruciform: CRUCIFORM,
}
_BY_MATRICES = PartLaw(
    stiffness=lambda part: part.stated().stiffness, damping=lambda part: part.stated().damping, mass=lambda part: part.stated().mass
)
"""Law of springs and actuators with a specified 6x6 stiffness and mass; coils also have a specified damping."""
_STATED = dict.fromkeys((Spring, Amplified, SteppingDrive, ForceActuator, VoiceCoil, RotaryCoil), _BY_MATRICES)
_OWN = {**_HINGES, ComplianceMatrix: MATRIX, Contact: CONTACT, Piezo: PIEZO, ShearPiezo: SHEAR_PIEZO, **_STATED}
LAWS: Register[PartLaw] = Register("flexstage.laws", {part.kind: law for part, law in _OWN.items()})
"""Part laws of beam theory, by kind of part."""
