"""The currency of all readings: kinematics and linear models, with their static, eigen and frequency solves."""
