"""The experiment wing: records of tests, the modes found in them, theory beside them."""

from flexstage.base.lazy import lazily

HOMES = {
    "record": "Channel InMemory Record Responses Role in_memory",
    "options": "Allow Kind Options",
    "unit": "in_si responses_in_si",
    "formats.read": "read_record",
    "formats.write": "Form write_record",
    "health": "Needs examine usable",
    "cross_spectra": "Segments Spectra Window spectra",
    "transfer": "h1 h2 multiple_coherence ordinary_coherence spectral_ratio",
    "identification.identify": "Search identify",
    "identification.identified": "Identified",
    "comparison": "Compared compare",
    "updating.update": "Told Updated update",
    "updating.free": "Known",
    "updating.text": "updated_text",
    "shapes_on_stage": "StageShapes stage_shapes",
    "virtual_rig.rig": "rig",
    "virtual_rig.setup": "Amplifier AntiAlias NoiseDrive Recorded RigSetup Sensing Tap",
}
__getattr__, __dir__ = lazily(__name__, HOMES)
