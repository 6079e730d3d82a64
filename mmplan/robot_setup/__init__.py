"""Setting up robots: what a URDF leaves open is guessed, measured and shown."""
