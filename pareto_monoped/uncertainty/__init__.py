"""What is uncertain in a built robot, by how much, and what that does to its jump."""
