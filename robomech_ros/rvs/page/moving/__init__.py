"""What is seen of robots that move over the ground, and has them move on."""
