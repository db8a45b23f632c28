"""Page parts for robots that move over the ground."""
