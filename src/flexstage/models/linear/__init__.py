"""Linear models and kinematics, the common result of all models, with static, eigenvalue and frequency-response solutions."""
