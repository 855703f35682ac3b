"""Virtual test rig: a stage excited by noise and measured, as a record."""
