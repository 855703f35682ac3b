"""Models of hysteresis and their inverse."""
