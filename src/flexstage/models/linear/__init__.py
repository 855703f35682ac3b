"""The currency of all models: kinematics and linear models, with their static, eigen and frequency solves."""
