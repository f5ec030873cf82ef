"""Search algorithms behind one ask-and-tell interface, and the space that they search."""
