"""What `bake_bodies.py` is made of: the rig, the clothes on the skin, the pieces beside it."""
