"""Test records, identification of modes, and comparison with models."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "records.record": "Channel Record Role in_memory",
    "records.options": "Arrays FaultTolerance Kind Options",
    "formats.read": "read_record",
    "formats.write": "write_record",
    "records.health": "RecordRequirements examine",
    "spectral.cross_spectra": "Segments spectra",
    "spectral.transfer": "h1 h2",
    "identification.excitation": "Excitation",
    "identification.identify": "Search identify",
    "comparison": "compare",
    "updating.update": "update",
    "updating.free": "Prior",
    "virtual_rig.rig": "rig",
    "virtual_rig.inputs": "InputQuantity InputSignal",
    "virtual_rig.setup": "Amplifier AntiAlias NoiseDrive RigSetup Sensing",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
