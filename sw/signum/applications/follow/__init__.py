"""Object following: what is near, or moves against the terrain, is kept in the middle of the view."""
